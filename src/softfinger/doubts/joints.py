"""Doubtful joints: against load, dead, exchanged, absolute."""

from collections.abc import Iterator, Sequence
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from softfinger.doubts.doubt import Doubt, name_trials
from softfinger.doubts.features import TrialFeatures

Array = NDArray[np.float64]
AGAINST = 0.2  # of the chain's largest motion
DEAD = 0.03
OWN_NOISE = 4.0  # times as much as a unit that makes the motion so small would leave
ABOVE_NOISE = 12.0
MOST_JOINTS = 6  # of which every order is tried
# Relative angles of neighbours share a link's error: their noise goes against each other.
NEIGHBOURS = -0.2
TOGETHER = 0.2
CLOSER = 0.35  # by which another order's noise must fit better, rms of the correlations


def doubt_joints(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    """Doubt joints by comparing them along the chain."""
    yield from _doubt_sign(trials)
    if trials[0].angle.shape[0] > 1:
        yield from _doubt_dead(trials)
        yield from _doubt_absolute(trials)
    if 2 < trials[0].angle.shape[0] <= MOST_JOINTS:
        yield from _doubt_order(trials)


def _doubt_sign(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    against: dict[tuple[int, ...], list[str]] = {}
    for trial in trials:
        clear = np.abs(trial.moved) > ABOVE_NOISE * np.nan_to_num(trial.noise)
        large = np.abs(trial.gain) > AGAINST * np.abs(trial.gain).max()
        wrong = (trial.gain < 0) & clear & large & (trial.unexplained < 0.5)
        if wrong.any():
            against.setdefault(tuple((np.flatnonzero(wrong) + 1).tolist()), []).append(trial.name)
    for joints, names in against.items():
        whole = len(joints) == trials[0].angle.shape[0]
        which = "" if whole else f"joint {', '.join(map(str, joints))} of "
        yield Doubt(
            "against_the_load",
            f"{which}{name_trials(names, len(trials))} moved against the load; likely a wrong "
            "sign, a mirrored video or exchanged wires; a positive load must bend the "
            "finger positively",
            tuple(names),
            () if whole else joints,
        )


def _doubt_dead(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    moved = np.abs([trial.moved for trial in trials])
    share = np.median(moved / np.maximum(moved.max(axis=1, keepdims=True), 1e-300), axis=0)
    noise = np.nan_to_num(np.median([trial.noise for trial in trials], axis=0))
    own = (noise == 0.0) | (noise > OWN_NOISE * share * noise.max())  # else it is another unit
    dead = (share < DEAD) & own & (np.median(moved.max(axis=1)) > ABOVE_NOISE * noise.max())
    for joint in np.flatnonzero(dead) + 1:
        yield Doubt(
            "joint_hardly_moves",
            f"joint {joint} moved {share[joint - 1]:.1%} of what the joint beside it did, in all "
            f"trials; likely a dead sensor or a wrong column; check q{joint}_rad",
            (),
            (int(joint),),
        )


def _doubt_absolute(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    """Doubt angles that seem measured against the base.

    They add the base's error to every joint, so the noise of the joints goes together.
    """
    together = np.array([_goes_together(trial) for trial in trials])
    others = [_pairs(t.correlation).mean() for t, a in zip(trials, together, strict=True) if not a]
    usual = np.nanmedian(others) if np.isfinite(others).any() else 0.0
    growing = np.array([bool((np.diff(np.abs(trial.moved)) > 0).all()) for trial in trials])
    # Between trials the noise alone is evidence; in all of them the motion must grow as well.
    suspects = together & (usual < NEIGHBOURS if others else growing)
    if not suspects.any() or (not others and suspects.mean() < 0.8):
        return
    names = [trial.name for trial, s in zip(trials, suspects, strict=True) if s]
    yield Doubt(
        "absolute_angles",
        f"in {name_trials(names, len(trials))} the noise of neighbouring joints has a "
        "positive correlation; that of relative angles is negative; likely angles against the "
        "base: "
        "subtract the joint before",
        tuple(names),
    )


def _goes_together(trial: TrialFeatures) -> bool:
    pairs = _pairs(trial.correlation)
    return bool(np.isfinite(pairs).all() and (pairs > TOGETHER).all())


def _pairs(correlation: Array) -> Array:
    return correlation[np.triu_indices(len(correlation), 1)]


def _doubt_order(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    """Doubt the order of the joints.

    The noise of neighbours has opposite signs, which shows who is beside whom.
    """
    count = trials[0].angle.shape[0]
    found: dict[tuple[int, ...], list[str]] = {}
    for trial in trials:
        order = _find_order(trial.correlation)
        if order is not None:
            found.setdefault(order, []).append(trial.name)
    for order, names in found.items():
        moved = [k + 1 for k in range(count) if order[k] != k]
        yield Doubt(
            "joints_exchanged",
            f"in {name_trials(names, len(trials))} the noise shows the joints in the order "
            f"{', '.join(str(k + 1) for k in order)}: neighbours that share a link have opposite "
            "errors; likely exchanged columns or markers; check the order",
            tuple(names),
            tuple(moved),
        )


def _find_order(correlation: Array) -> tuple[int, ...] | None:
    """Order by opposite errors; None where as declared."""
    if not np.isfinite(correlation).all():
        return None
    count = len(correlation)
    expected = np.eye(count) - 0.5 * (np.eye(count, k=1) + np.eye(count, k=-1))
    misfit = {}
    for order in permutations(range(count)):
        if order <= order[::-1]:  # a chain read from the tip is the same chain
            index = np.array(order)
            turned = correlation[np.ix_(index, index)]
            misfit[order] = float(np.sqrt(np.mean(_pairs(turned - expected) ** 2)))
    best = min(misfit, key=lambda order: misfit[order])
    declared = misfit[tuple(range(count))]
    clear = misfit[best] < 0.15 and declared - misfit[best] > CLOSER * 0.5
    return best if clear else None
