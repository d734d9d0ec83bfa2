"""Foreign laws of the load and the clock."""

from collections.abc import Callable

import numpy as np
from scipy.special import ndtri

from softfinger.concealed.effects import actuator_lag, camera_delay, load_limit
from softfinger.concealed.effects.effect import Array, Circumstances, Dose, Effect, Move
from softfinger.concealed.effects.load_limit import act, limit_rate, saturate
from softfinger.concealed.foreign.law import build_law
from softfinger.concealed.physics import Physics
from softfinger.concealed.protocols import Load, refine_load


def _lag(stages: Array, mix: Array, transport: float = 0.0) -> Move:
    """Build lags in a row after a delay."""

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        if dose.strength == 0.0:
            return physics
        later = physics.load_time + transport * dose.strength
        time = np.append(0.0, later) if transport else later
        tension = np.append(0.0, physics.load_tension) if transport else physics.load_tension
        return physics._replace(
            load_time=time,
            load_tension=tension,
            lag_times=dose.strength * stages,
            lag_mix=mix,
        )

    return move


def _late(size: Callable[[Circumstances], float]) -> dict[str, Callable]:
    """Build a delay of strength times size(trial)."""

    def clock(time: Array, dose: Dose, trial: Circumstances) -> Array:
        return time - dose.strength * size(trial)

    def tell(dose: Dose, trials: list[Circumstances]) -> dict[str, float]:
        return {"delay_s": float(np.mean([dose.strength * size(trial) for trial in trials]))}

    return {"clock": clock, "tell": tell}


def _slew(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """The strength is the inverse of the rate [s/N]."""
    if dose.strength == 0.0:
        return physics
    load = Load(physics.load_time, physics.load_tension)
    return act(physics, limit_rate(load, 1.0 / dose.strength))


def _soft(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    if dose.strength == 0.0:
        return physics
    load = Load(physics.load_time, physics.load_tension)
    return act(physics, saturate(load, 1.0 / dose.strength, 2.5))


def _sag(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Tension T (1 − s T t/T₀) that sags.

    The harder and the longer it pulls, the less it reaches.
    """
    fine = _fill(Load(physics.load_time, physics.load_tension), trial.duration)
    lost = dose.strength * fine.tension * fine.time / trial.duration
    return act(physics, Load(fine.time, fine.tension * np.clip(1.0 - lost, 0.1, None)))


def _fill(load: Load, duration: float) -> Load:
    """Give a load knots at every second."""
    held = Load(np.append(load.time, duration), np.append(load.tension, load.tension[-1]))
    nudged = Load(held.time, held.tension + 1e-12 * np.arange(held.time.size))
    return refine_load(nudged, 1.0)


def _limit(law: str, why: str, **changes: object) -> Effect:
    return build_law(load_limit.EFFECT, law, why, **changes)


LAWS = (
    build_law(
        actuator_lag.EFFECT,
        "erlang",
        "three equal stages in a row: the textbook has one or two",
        move=_lag(np.full(3, 1.0 / 3.0), np.array([0.0, 0.0, 1.0])),
    ),
    build_law(
        actuator_lag.EFFECT,
        "two_paths",
        "most of the tension comes soon and a rest much later: stages in a row have no such tail",
        move=_lag(np.array([0.25, 2.5]), np.array([0.7, 0.3])),
    ),
    build_law(
        actuator_lag.EFFECT,
        "transport",
        "a pure delay along a tube and a lag at its end",
        move=_lag(np.array([0.5]), np.array([1.0]), transport=0.5),
    ),
    build_law(
        camera_delay.EFFECT,
        "scattered",
        "a delay that differs from trial to trial by a quarter of itself",
        **_late(lambda trial: np.exp(0.25 * ndtri(0.01 + 0.98 * trial.luck[0]))),
    ),
    build_law(
        camera_delay.EFFECT,
        "buffer",
        "a delay of one or of two frames of a buffer, as it happens",
        **_late(lambda trial: 2.0 if trial.luck[0] < 0.4 else 1.0),
    ),
    build_law(
        camera_delay.EFFECT,
        "growing",
        "a delay that grows from trial to trial, as two clocks drift apart",
        **_late(lambda trial: 0.4 + 1.2 * trial.number / trial.count),
    ),
    _limit(
        "slew",
        "a drive that follows no faster than at a rate, through ramps and steps alike",
        typical=0.02,
        largest=0.3,
        move=_slew,
        tell=lambda dose, trials: {"rate_per_s": 1.0 / max(dose.strength, 1e-9)},
    ),
    _limit(
        "soft",
        "a drive that lags behind ever more the harder it pulls, with no hard limit",
        typical=0.06,
        largest=0.2,
        move=_soft,
    ),
    _limit(
        "sagging",
        "a drive that gets weaker as it warms: no limit is constant",
        typical=0.01,
        largest=0.06,
        move=_sag,
    ),
)
