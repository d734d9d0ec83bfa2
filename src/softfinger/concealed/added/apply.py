"""Add an effect of known size to real recordings.

The recordings keep whatever they have: noise, faults and physics that nobody knows. Added is what
the effect does to a body that is fitted to each trial, by the proof's own equations of motion,

    q'(t) = q(t) + [q_effect(t; η) − q_plain(t; η)],

η the three elements and the ladder of others that follow the trial. Where the effect is a shift of
the clock, the time stamps are shifted and the angles stay as they are. Readings that were rounded
to a step are rounded to it again.
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
BLOCK = 100  # readings in which a step is sought: an instrument may change its range
OFF_STEP = 1e-3  # of a step, by which its multiples err that a table has with few decimals
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


def draw_additions(campaign: str, trials: int, scale: Scale) -> list[Addition]:
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
        strength = min(effect.typical, limit_strength(name, scale))
        drawn.append(Addition(name, Dose(strength, shape, (0,)), seed))
    return drawn


def limit_strength(effect: str, scale: Scale) -> float:
    """Largest strength of an effect in a body's units.

    A clock starts late by so many seconds, however long the trials are.
    """
    most = EFFECTS[effect].largest
    return most if EFFECTS[effect].clock is None else most / max(scale.time, 1.0)


def strengthen(addition: Addition, strength: float, scale: Scale) -> Addition:
    """The same effect of another size, at most the largest."""
    strength = min(strength, limit_strength(addition.effect, scale))
    return replace(addition, dose=replace(addition.dose, strength=strength))


def write_added(
    source: Path,
    target: Path,
    bodies: list[Body],
    scale: Scale,
    addition: Addition,
    times: float = 1.0,
) -> None:
    """Write a campaign with an effect added.

    Parameters
    ----------
    source, target
        The campaign folder, and the one that is made; `raw` stays behind.
    bodies, scale
        As `read_bodies` gives them.
    times
        How often the change is added; −1 takes it off recordings that never had it.
    """
    shutil.copytree(source, target, ignore=shutil.ignore_patterns("raw", "*.md", "expected.yaml"))
    luck = draw_circumstances(bodies, addition)
    for body, trial in zip(bodies, luck, strict=True):
        time, motion = add(body, trial, addition, times)
        table = pd.read_csv(target / body.path, skipinitialspace=True, dtype=str)
        table["time_s"] = [f"{value:.10g}" for value in time * scale.time]
        before = table[body.column].to_numpy(float)
        after = round_alike(motion * scale.motion + scale.rest, before)
        table[body.column] = [f"{value:.10g}" if np.isfinite(value) else "" for value in after]
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


def add(
    body: Body, trial: Circumstances, addition: Addition, times: float = 1.0
) -> tuple[Array, Array]:
    """Time and motion of a trial with the effect.

    A frame that repeats the one before still does.
    """
    doses = {addition.effect: addition.dose}
    clock = EFFECTS[addition.effect].clock
    if clock is not None:
        shift = body.time - clock(body.time, addition.dose, trial)
        return body.time + times * shift, body.motion
    taken = body.time[find_first(body.motion)]
    order = np.argsort(taken, kind="stable")
    moved, plain = (
        simulate_trial(body.individual, some, trial, RIG, taken[order], beside=tuple(body.ladder))[
            :, 0
        ]
        for some in (doses, {})
    )
    motion = body.motion.copy()
    motion[order] += times * (moved - plain)
    return body.time, motion


def round_alike(value: Array, reading: Array) -> Array:
    """Round values (row,) to the steps of readings (row,).

    >>> round_alike(np.array([0.12, 0.68, 1.1]), np.array([0.0, 0.5, 1.5]))
    array([0. , 0.5, 1. ])
    >>> round_alike(np.array([0.12, 0.68, 1.1]), np.array([0.0, 0.5, 1.7]))
    array([0.12, 0.68, 1.1 ])
    """
    blocks = [slice(start, start + BLOCK) for start in range(0, value.size, BLOCK)]
    steps = [find_step(reading[block]) for block in blocks]
    known = [step for step in steps if step is not None]
    rounded = value.copy()
    for block, step in zip(blocks, steps, strict=True):
        step = np.median(known) if step is None and known else step
        if step:
            rounded[block] = np.round(value[block] / step) * step
    return rounded


def find_step(reading: Array) -> float | None:
    """Step to which readings are rounded.

    0 where there is none, None where all are equal.

    >>> find_step(np.array([0.5, 2.0, 2.0, 1.0])), find_step(np.array([0.5, 2.0, 2.2, 1.0]))
    (0.5, 0.0)
    """
    seen = reading[np.isfinite(reading)]
    gap = np.diff(np.unique(seen))
    gap = gap[gap > 1e-9 * np.abs(seen).max(initial=0.0)]
    if gap.size == 0:
        return None
    off = np.abs(seen / gap.min() - np.round(seen / gap.min()))
    return float(gap.min()) if off.max() < OFF_STEP else 0.0


def find_first(motion: Array) -> Array:
    """Row of the first of the equal values in a row.

    >>> find_first(np.array([0.1, 0.1, np.nan, 0.2, 0.2]))
    array([0, 0, 2, 3, 3])
    """
    rows = np.arange(motion.size)
    changed = np.append(True, motion[1:] != motion[:-1])
    return np.maximum.accumulate(np.where(changed, rows, 0))
