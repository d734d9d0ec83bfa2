"""Add an effect of known size to real recordings.

The recordings keep whatever they have: noise, faults and physics that nobody knows. Added is what
the effect does to a body that is fitted to each trial, by the proof's own equations of motion,

    q'(t) = q(t) + [q_effect(t; η) − q_plain(t; η)],

η the three elements and the ladder of others that follow the trial. Where the effect is a shift of
the clock, the time stamps are shifted and the angles stay as they are.
"""

import hashlib
import shutil
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from softfinger.concealed.added.body import RIG, Body, Scale, describe
from softfinger.concealed.arrays import Array
from softfinger.concealed.effects import Circumstances, Dose
from softfinger.concealed.forward import simulate_trial
from softfinger.concealed.registry import EFFECTS

REFERENCE_C, SPREAD_K = 22.0, 6.0
ADDED = (
    *("second_retardation", "fractional_creep", "strain_stiffening", "actuator_lag"),
    *("fatigue_softening", "temperature", "contact_stop", "yield_threshold"),
    *("stress_nonlinear_flow", "camera_delay", "session_jump", "load_limit", "load_gain"),
    *("joint_play", "thinning_damper", "softening_within_trial", "inertia"),
)
"""Effects that act on one joint, with a drive of which the log alone is known."""


@dataclass(frozen=True)
class Addition:
    """An effect to add to a campaign; `seed` draws its luck."""

    effect: str
    dose: Dose
    seed: int


def draw_additions(campaign: str, trials: int) -> list[Addition]:
    """Every effect that so many trials can show.

    Their shapes are drawn, the same ones whenever the campaign has this name.
    """
    drawn = []
    for name in ADDED:
        effect = EFFECTS[name]
        if trials < effect.trials:
            continue
        digest = hashlib.sha256(f"{campaign}/{name}".encode()).hexdigest()
        seed = int(digest[:8], 16)
        rng = np.random.default_rng(seed)
        shape = {key: one.draw(rng) for key, one in effect.shape.items()}
        drawn.append(Addition(name, Dose(effect.typical, shape, (0,)), seed))
    return drawn


def strengthen(addition: Addition, strength: float) -> Addition:
    """The same effect of another size, at most the largest."""
    strength = min(strength, EFFECTS[addition.effect].largest)
    return replace(addition, dose=replace(addition.dose, strength=strength))


def write_added(
    source: Path, target: Path, bodies: list[Body], scale: Scale, addition: Addition
) -> None:
    """Write a campaign with an effect added.

    Parameters
    ----------
    source, target
        The campaign folder, and the one that is made; `raw` stays behind.
    bodies, scale
        As `read_bodies` gives them.
    """
    shutil.copytree(source, target, ignore=shutil.ignore_patterns("raw", "*.md", "expected.yaml"))
    luck = draw_circumstances(bodies, addition)
    for body, trial in zip(bodies, luck, strict=True):
        time, motion = add(body, trial, addition)
        table = pd.read_csv(target / body.path, skipinitialspace=True, dtype=str)
        table["time_s"] = [f"{value:.10g}" for value in time * scale.time]
        table[body.column] = [
            f"{value:.10g}" if np.isfinite(value) else ""
            for value in motion * scale.motion + scale.rest
        ]
        table.to_csv(target / body.path, index=False)
    if EFFECTS[addition.effect].covariate == "temperature_c":
        trials = pd.read_csv(target / "trials.csv", dtype=str)
        warmth = {body.name: trial.warmth for body, trial in zip(bodies, luck, strict=True)}
        known = trials["trial"].str.strip().map(warmth)
        trials["temperature_c"] = [f"{REFERENCE_C + value:.2f}" for value in known.fillna(0.0)]
        trials.to_csv(target / "trials.csv", index=False)


def draw_circumstances(bodies: list[Body], addition: Addition) -> list[Circumstances]:
    """Draw what is special about every trial."""
    rng = np.random.default_rng([addition.seed, 1])
    return [
        replace(
            describe(number, len(bodies), body.load, float(np.nanmax(body.time))),
            warmth=float(rng.normal(0.0, SPREAD_K)),
            luck=tuple(rng.uniform(size=3)),
        )
        for number, body in enumerate(bodies)
    ]


def add(body: Body, trial: Circumstances, addition: Addition) -> tuple[Array, Array]:
    """Time and motion of a trial with the effect.

    A frame that repeats the one before still does.
    """
    doses = {addition.effect: addition.dose}
    clock = EFFECTS[addition.effect].clock
    if clock is not None:
        return 2.0 * body.time - clock(body.time, addition.dose, trial), body.motion
    taken = body.time[find_first(body.motion)]
    order = np.argsort(taken, kind="stable")
    moved, plain = (
        simulate_trial(body.individual, some, trial, RIG, taken[order], beside=tuple(body.ladder))[
            :, 0
        ]
        for some in (doses, {})
    )
    motion = body.motion.copy()
    motion[order] += moved - plain
    return body.time, motion


def find_first(motion: Array) -> Array:
    """Row of the first of the equal values in a row.

    >>> find_first(np.array([0.1, 0.1, np.nan, 0.2, 0.2]))
    array([0, 0, 2, 3, 3])
    """
    rows = np.arange(motion.size)
    changed = np.append(True, motion[1:] != motion[:-1])
    return np.maximum.accumulate(np.where(changed, rows, 0))
