"""Foreign spectra: creep compliance over time."""

import numpy as np

from softfinger.concealed.effects import fractional_creep, second_retardation
from softfinger.concealed.effects.effect import Array, Circumstances, Dose, Move
from softfinger.concealed.foreign.law import build_law
from softfinger.concealed.physics import Physics


def _add_spectrum(physics: Physics, dose: Dose, times: Array, weights: Array) -> Physics:
    """Add Voigt elements to a trial.

    Their compliances are shares of the trial's own elastic one.
    """
    compliance = dose.spread(physics.k_v.size) / physics.k_v
    return physics._replace(
        compliance=np.vstack([physics.compliance, np.outer(weights, compliance)]),
        retardation_time=np.concatenate([physics.retardation_time, times]),
    )


def _retard(shares: Array, weights: Array) -> Move:
    """Build a spectrum at shares of the retardation time."""

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        times = dose.shape["retardation_time_s"] * shares
        return _add_spectrum(physics, dose, times, weights / weights.sum())

    return move


def _ladder(times: Array, weights: Array) -> Move:
    """Build a spectrum of given retardation times.

    It has crept by the strength after one second.
    """
    at_one_second = (weights * -np.expm1(-1.0 / times)).sum()

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        return _add_spectrum(physics, dose, times, weights / at_one_second)

    return move


_NARROW, _WIDE = np.geomspace(0.2, 5.0, 7), np.geomspace(1e-3, 1e3, 9)
_CUT = np.geomspace(0.05, 30.0, 6)
_TIME = {"retardation_time_s": second_retardation.EFFECT.shape["retardation_time_s"]}

LAWS = (
    build_law(
        second_retardation.EFFECT,
        "log_normal",
        "a log-normal spectrum: the textbook's has one line",
        shape=_TIME,
        move=_retard(_NARROW, np.exp(-0.5 * (np.log(_NARROW) / 0.8) ** 2)),
    ),
    build_law(
        second_retardation.EFFECT,
        "box",
        "a spectrum that is even over a decade and a half",
        shape=_TIME,
        move=_retard(_NARROW, np.ones(7)),
    ),
    build_law(
        second_retardation.EFFECT,
        "two_lines",
        "two lines, one ten times as slow as the other",
        shape=_TIME,
        move=_retard(np.array([0.35, 3.5]), np.array([0.5, 0.5])),
    ),
    build_law(
        fractional_creep.EFFECT,
        "logarithmic",
        "creep by the logarithm of time: an even spectrum, whose exponent would be 0",
        typical=0.2,
        largest=0.6,
        shape={},
        move=_ladder(_WIDE, np.ones(9)),
    ),
    build_law(
        fractional_creep.EFFECT,
        "two_powers",
        "one power of time below a second and another above it",
        shape={},
        move=_ladder(_WIDE, np.where(_WIDE < 1.0, _WIDE**0.55, _WIDE**0.2)),
    ),
    build_law(
        fractional_creep.EFFECT,
        "cut_off",
        "a power of time that ends after half a minute",
        shape={},
        move=_ladder(_CUT, _CUT**0.4),
    ),
)
