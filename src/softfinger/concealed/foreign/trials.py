"""Foreign laws between trials, or within one."""

from collections.abc import Callable

import numpy as np

from softfinger.concealed.effects import (
    fatigue_softening,
    load_gain,
    preload_memory,
    session_jump,
    softening_within_trial,
    temperature,
)
from softfinger.concealed.effects.effect import Array, Circumstances, Dose, Move
from softfinger.concealed.effects.load_gain import scale_load
from softfinger.concealed.effects.softening_within_trial import soften
from softfinger.concealed.foreign.law import build_law
from softfinger.concealed.physics import Physics

Size = Callable[[float], float]


def _scale(physics: Physics, stiffness: Array | float, viscosity: Array | float) -> Physics:
    return physics._replace(
        k_v=physics.k_v * stiffness, c_v=physics.c_v * viscosity, c_p=physics.c_p * viscosity
    )


def _tire(progress: Size) -> dict[str, object]:
    """Build a softening by 1 − s · progress.

    progress depends on the share of the campaign that is done.
    """

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        done = progress(trial.number / trial.count) - progress(0.0)
        left = 1.0 - dose.spread(physics.k_v.size) * done
        return _scale(physics, left, left if dose.shape["viscosities_too"] else 1.0)

    def curve(x: Array, trials: int) -> Array:
        return -(progress(x / trials) - progress(0.0))

    return {"move": move, "argument": "trial_number", "curve": curve}


def _drift(progress: Size) -> dict[str, object]:
    """Build a drift of a load cell's gain.

    The gain is 1 + s · progress, and progress depends on the share of the campaign that is done.
    """

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        gained = progress(trial.number / trial.count) - progress(0.0)
        return scale_load(physics, 1.0 + dose.strength * gained)

    def curve(x: Array, trials: int) -> Array:
        return progress(x / trials) - progress(0.0)

    return {"move": move, "argument": "trial_number", "curve": curve}


def _jump(inside: Size, viscosity: float) -> Move:
    """Build a jump from one trial on.

    It acts where inside(trials since it, share of the campaign) is not zero.
    """

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        since = trial.number / trial.count - dose.shape["first_share"]
        sign = 1.0 if dose.shape["stiffer"] else -1.0
        ratio = sign * dose.spread(physics.k_v.size) * inside(since)
        return _scale(physics, 1.0 + ratio, 1.0 + viscosity * ratio)

    return move


def _warm(shift: Size) -> Move:
    """Build a factor exp(−s · shift(warmth)).

    Warmth is in K; the factor acts on the viscosities or the stiffness.
    """

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        factor = np.exp(-dose.spread(physics.k_v.size) * shift(trial.warmth))
        return (
            _scale(physics, factor, 1.0)
            if dose.shape["stiffness"]
            else _scale(physics, 1.0, factor)
        )

    return move


def _leave(fade: Size) -> Move:
    """Build a start strain that fades with rest."""

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        elastic = physics.load_tension.max() * physics.wire_offset / physics.k_v
        left = dose.spread(physics.k_v.size) * fade(trial.rest)
        return physics._replace(residual=physics.residual + left * elastic)

    return move


def _worked(heat: float) -> Move:
    """Build a softening by motion, undone by rest."""

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        cooling = 1.0 / dose.shape["softening_time_s"]
        return soften(physics, dose, (0.0, 1.0, heat, cooling))

    return move


def _hyperbola(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    return soften(physics, dose, (1.0 / dose.shape["softening_time_s"], 3.0, 0.0, 0.0))


LAWS = (
    build_law(
        fatigue_softening.EFFECT,
        "s_shaped",
        "nothing at first, then fast, then nothing: no linear, exponential or logarithmic drift",
        **_tire(lambda x: 1.0 / (1.0 + np.exp(-(x - 0.5) / 0.1))),
    ),
    build_law(
        fatigue_softening.EFFECT,
        "square_root",
        "a drift by the root of the number of trials",
        **_tire(np.sqrt),
    ),
    build_law(
        fatigue_softening.EFFECT,
        "accelerating",
        "a drift by the cube of the number of trials, as before a break",
        **_tire(lambda x: x**3),
    ),
    build_law(
        load_gain.EFFECT,
        "s_shaped",
        "a gain that settles at two values: no constant gain per trial",
        **_drift(lambda x: 1.0 / (1.0 + np.exp(-(x - 0.4) / 0.08))),
    ),
    build_law(
        load_gain.EFFECT,
        "warm_up",
        "a gain that settles after some trials",
        **_drift(lambda x: -np.expm1(-x / 0.15)),
    ),
    build_law(
        load_gain.EFFECT,
        "day",
        "a gain that comes and goes within a day",
        **_drift(lambda x: np.sin(2.0 * np.pi * x)),
    ),
    build_law(
        session_jump.EFFECT,
        "other_ratios",
        "stiffness and viscosities jump the opposite way",
        tell=session_jump.EFFECT.tell,
        move=_jump(lambda since: since >= 0.0, -0.6),
    ),
    build_law(
        session_jump.EFFECT,
        "and_back",
        "a jump that the next session undoes",
        move=_jump(lambda since: 0.0 <= since < 0.3, 1.0),
    ),
    build_law(
        session_jump.EFFECT,
        "and_fading",
        "a jump that fades while the session lasts",
        move=_jump(lambda since: np.exp(-since / 0.4) if since >= 0.0 else 0.0, 0.0),
    ),
    build_law(
        temperature.EFFECT,
        "glass",
        "a knee at a temperature: nothing below it, and beyond it in proportion",
        move=_warm(lambda t: 2.0 * np.logaddexp(0.0, (t - 0.5) / 0.4) * 0.4),
    ),
    build_law(
        temperature.EFFECT,
        "saturating",
        "a dependence that saturates on both sides",
        move=_warm(lambda t: 2.0 * np.tanh(t / 1.5)),
    ),
    build_law(
        temperature.EFFECT,
        "bent",
        "a dependence with a square beside the linear part",
        move=_warm(lambda t: t + t**2 / 3.0),
    ),
    build_law(
        preload_memory.EFFECT,
        "power_of_rest",
        "a memory that fades by a power of the rest, not as an exponential",
        move=_leave(lambda rest: (1.0 + rest / 8.0) ** -0.8),
    ),
    build_law(
        preload_memory.EFFECT,
        "stretched",
        "a memory that fades as a stretched exponential",
        move=_leave(lambda rest: np.exp(-np.sqrt(rest / 25.0))),
    ),
    build_law(
        preload_memory.EFFECT,
        "forgotten_at_once",
        "a memory that is whole up to half a minute of rest and then gone",
        move=_leave(lambda rest: 1.0 / (1.0 + (rest / 30.0) ** 6)),
    ),
    build_law(
        softening_within_trial.EFFECT,
        "by_work",
        "softening that a joint's own motion drives and rest undoes",
        typical=0.2,
        move=_worked(4.0),
    ),
    build_law(
        softening_within_trial.EFFECT,
        "by_much_work",
        "the same with a stronger drive, so that it saturates within a step",
        typical=0.2,
        move=_worked(15.0),
    ),
    build_law(
        softening_within_trial.EFFECT,
        "hyperbola",
        "a softening that never ends: an inverse root of time, not an exponential",
        move=_hyperbola,
    ),
)
