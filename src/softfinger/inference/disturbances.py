"""What a wrong log or clock does to angles.

It makes the noise larger in some directions.

To first order an error of the load log, of a clock, or a drift of the picture adds G z, z normal
of sd s, with G what the error moves the angles by: the sensitivity of the model to the log, or
the speed of the finger. Its covariance s² G Gᵀ is of low rank, so with white rows (Σ = 1)

    (1 + s² G Gᵀ)⁻¹ = 1 − s G (1 + s² GᵀG)⁻¹ Gᵀ s

and all else follows from the Gram matrix of [∂F/∂η | ∂F/∂φ | residual | G]
(`disturbance_sizes`).
"""

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.budget import BUDGET
from softfinger.inference.decisions import DECISIONS
from softfinger.inference.priors import PRIORS
from softfinger.inference.problem import Candidate, Problem
from softfinger.inference.walks import (
    list_flicker,
    list_walks,
    list_waves,
    share_trial,
    turn_link,
    walk_array,
)
from softfinger.measurement.open_gaps import bridge_gaps_array, find_open_gaps_array
from softfinger.measurement.steady import stack_logs
from softfinger.mechanics.effects.measurement_file import LINK_TURN

Array = NDArray[np.float64]

SIZES: Mapping[str, Array] = {
    "noisy_load": np.array(PRIORS.load_sizes),
    "load_drift": np.array(PRIORS.load_drift_sizes),
    "timing_jitter": np.array(PRIORS.jitter_sizes_s),
    "clock_offset": np.array(PRIORS.offset_sizes_s),
    "clock_rate": np.array(PRIORS.rate_sizes),
    "step_scatter": np.array(PRIORS.step_sizes),
    "drift": np.array(PRIORS.drift_sizes),
    "picture_turn": np.array(PRIORS.drift_sizes),
    LINK_TURN: np.array(PRIORS.drift_sizes),
    "gain_drift": np.array(PRIORS.gain_drift_sizes),
    "lasting_noise": np.array(PRIORS.lasting_sizes),
    "flicker_noise": np.array(PRIORS.flicker_sizes),
}
CLOCKS = frozenset({"clock_offset", "clock_rate"})
IN_NOISE = (  # in units of the noise
    "drift",
    "picture_turn",
    LINK_TURN,
    "lasting_noise",
    "flicker_noise",
)
DRIFTS = (*IN_NOISE, "gain_drift")  # wander slowly
IN_GAPS = frozenset({"step_scatter"})  # as large as the log leaves open
STEP_SHARE = 0.01  # of a row's load by which the model is moved
STEP_S = 0.002


def list_disturbances(
    problem: Problem, candidate: Candidate, only: Collection[str] | None = None
) -> dict[str, Array]:
    """What errors of unit size move the angles by.

    Id → (trial, joint, bin · 2, column) [rad].

    A load that was only assumed has no log that errs. Left out is what has no number.
    """
    speed = _measure_speed(problem, candidate)
    time = problem.trials.node.reshape(len(speed), 1, -1)
    made: dict[str, Callable[[], Array]] = {
        "timing_jitter": lambda: _spread_jitter(problem, candidate, speed),
        "drift": lambda: list_walks(problem),
        "gain_drift": lambda: _drift_gain(problem, candidate),
        "lasting_noise": lambda: list_waves(problem),
        "flicker_noise": lambda: list_flicker(problem),
    }
    if problem.trials.joints > 1:  # with one joint it is no other than its drift
        made["picture_turn"] = lambda: turn_link(problem, 0)
        for link in range(1, problem.trials.joints + 1):
            made[f"{LINK_TURN}{link}"] = partial(turn_link, problem, link)
    if problem.setting.load_known:
        made["clock_offset"] = lambda: speed[..., None]
        made["clock_rate"] = lambda: (speed * time)[..., None]
        made["noisy_load"] = lambda: _move_rows(problem, candidate)
        made["load_drift"] = lambda: _drift_load(problem, candidate)
        gaps = _find_gaps(problem)
        if 0 < max(map(len, gaps)) <= BUDGET.step_hats:  # a load that moves in more is a wave
            made["step_scatter"] = lambda: _bridge_gaps(problem, candidate, gaps)
    listed = {name: make() for name, make in made.items() if only is None or name in only}
    # at the edge of what it can be simulated with, a model has no motion under a log that errs
    return {name: columns for name, columns in listed.items() if np.isfinite(columns).all()}


def find_kind(name: str) -> str | None:
    """The kind of disturbance in `SIZES`; None for what is none.

    >>> find_kind("drift"), find_kind("link_turn_2"), find_kind("spread_of_k1")
    ('drift', 'link_turn_', None)
    """
    kind = LINK_TURN if name.startswith(LINK_TURN) else name
    return kind if kind in SIZES else None


def _simulate(problem: Problem, candidate: Candidate, **changes: Array) -> Array:
    moved = replace(problem, trials=problem.trials._replace(**changes))
    nothing = np.zeros(0, np.int64)
    return moved.simulate(candidate.model, candidate.fit.own, candidate.fit.shared, nothing)[0]


def _measure_speed(problem: Problem, candidate: Candidate) -> Array:
    """Speed (trial, joint, bin · 2) [rad/s] over milliseconds."""
    node = problem.trials.node
    after, before = (_simulate(problem, candidate, node=node + s) for s in (STEP_S, -STEP_S))
    return (after - before) / (2 * STEP_S)


def _spread_jitter(problem: Problem, candidate: Candidate, speed: Array) -> Array:
    """One column for each bin with fast motion.

    The frames of such a bin err alone.
    """
    trials, soon = problem.trials, problem.trials.node + PRIORS.before_kick_s
    still, later = (_simulate(problem, candidate, node=node) for node in (trials.node, soon))
    # a frame just before a kick may have been taken after it
    after = (later - still) / PRIORS.before_kick_s
    speed = np.where(np.abs(after) > 2.0 * np.abs(speed), after, speed)
    count, joints, nodes = speed.shape
    mean = speed.reshape(count, joints, -1, 2).mean(axis=3)
    frames = np.ones((count, nodes // 2))
    for i, starts in enumerate(trials.starts):
        frames[i, : len(starts) - 1] = np.diff(starts)
        mean[i, :, len(starts) - 1 :] = 0.0
    mean = mean / np.sqrt(frames)[:, None]
    order = np.argsort(-np.abs(mean).max(axis=1), axis=1)[:, : BUDGET.jitter_bins]
    columns = np.zeros((count, joints, nodes // 2, order.shape[1]))
    for k in range(order.shape[1]):
        at = order[:, k]
        columns[np.arange(count), :, at, k] = mean[np.arange(count), :, at]
    return np.repeat(columns, 2, axis=2)


def _drift_gain(problem: Problem, candidate: Candidate) -> Array:
    """How a walking gain of the angles' own sensor moves them.

    Each joint's deflection from where its trial began, times a random walk of its own.
    """
    still = _simulate(problem, candidate)
    share = share_trial(problem.trials)
    away = still - still[:, :, :1]
    columns = np.einsum(
        "tjn,tns,jk->tjnks", away, walk_array(share, BUDGET.gain_shapes), np.eye(still.shape[1])
    )
    return columns.reshape(*still.shape, -1)


def _move_rows(problem: Problem, candidate: Candidate) -> Array:
    """Effect on the angles of load log errors.

    Every row of the log has a relative error.
    """
    trials = problem.trials
    rows = [_group_rows(torque) for torque in trials.load_torque]
    count = max(int(row.max(initial=-1)) + 1 for row, _ in rows)
    label, sd = (np.stack(part) for part in zip(*rows, strict=True))
    still = _simulate(problem, candidate)
    columns = np.zeros((*still.shape, count))
    for k in range(count):
        error = np.where(label == k, STEP_SHARE * sd, 0.0)
        torque = trials.load_torque * (1.0 + error)
        columns[..., k] = (_simulate(problem, candidate, load_torque=torque) - still) / STEP_SHARE
    return columns


def _drift_load(problem: Problem, candidate: Candidate) -> Array:
    """How a walking load cell gain moves the angles.

    It walks within a trial.
    """
    trials = problem.trials
    start, end = trials.node[:, 0, 0, None], trials.node[:, -1, -1, None]
    share = np.clip((trials.load_time - start) / (end - start), 0.0, 1.0)
    walk = walk_array(share, BUDGET.gain_shapes)
    still = _simulate(problem, candidate)
    moved = [
        _simulate(problem, candidate, load_torque=trials.load_torque * (1.0 + STEP_SHARE * shape))
        for shape in np.moveaxis(walk, -1, 0)
    ]
    return np.stack([(angle - still) / STEP_SHARE for angle in moved], axis=-1)


def _find_gaps(problem: Problem) -> list[NDArray[np.int64]]:
    """Gaps of each trial's log in which a step came."""
    trials = problem.trials
    logs = zip(trials.load_time, trials.load_torque, strict=True)
    return [find_open_gaps_array(*log, trials.interval) for log in logs]


def _bridge_gaps(problem: Problem, candidate: Candidate, gaps: list[NDArray[np.int64]]) -> Array:
    """How steps at any moment of their gaps move the angles."""
    trials, most = problem.trials, max(map(len, gaps))
    logs = list(zip(trials.load_time, trials.load_torque, gaps, strict=True))
    widest = max(float(np.diff(time)[gap].max(initial=0.0)) for time, _, gap in logs)
    fine = int(np.ceil(np.log2(widest / trials.interval)))
    levels = max(1, min(fine, int(np.log2(BUDGET.step_hats / most + 1))))
    opened = [bridge_gaps_array(*log, levels) for log in logs]
    time, torque = (stack_logs([log[k] for log in opened]) for k in (0, 1))
    bridge = np.zeros((len(logs), most * (2**levels - 1), time.shape[1]))
    for trial, (_, _, hats) in zip(bridge, opened, strict=True):
        trial[: len(hats), : hats.shape[1]] = hats
    still = _simulate(problem, candidate)
    moved = [
        _simulate(problem, candidate, load_time=time, load_torque=torque + STEP_SHARE * hats)
        for hats in np.moveaxis(bridge, 1, 0)
    ]
    return np.stack([(angle - still) / STEP_SHARE for angle in moved], axis=-1)


def _group_rows(torque: Array) -> tuple[NDArray[np.int64], Array]:
    """Which knots err together (knot,), with which sd.

    −1 where there is no load.

    A plateau is one reading: what rests does not scatter from row to row.

    >>> _group_rows(np.array([2.0, 2.0, 1.0, 1.0, 1.5]))[0]
    array([0, 0, 1, 1, 2])
    """
    same = np.append(False, torque[1:] == torque[:-1])
    row = np.cumsum(~same) - 1
    loaded = torque != 0.0
    _, row[loaded] = np.unique(row[loaded], return_inverse=True)
    number = int(row[loaded].max(initial=-1)) + 1
    together = max(1, -(-number // DECISIONS.load_rows))
    return np.where(loaded, row // together, -1), np.full(len(torque), together**-0.5)
