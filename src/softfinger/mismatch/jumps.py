"""Jumps in single trials: angles that are off by a constant from some moment on, as after a slip.

A trial's residual is weighed against a step of normal size in one joint, at any time, its own
parameters free to adapt; the evidence is averaged over joints, times and sizes. So is that of the
rival, an outlier at any time, which noise with heavy tails brings and which parameters that adapt
make look like a step where bins are narrow; a jump has to beat it. Trials jump with an unknown
probability, over which it is averaged as well.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.mismatch.problem import Candidate, Problem
from softfinger.mismatch.reduce import whiten_trial

SIZES_RAD = (0.003, 0.01, 0.03)
SHARES = (0.02, 0.1, 0.3, 0.6, 0.95)  # of the trials that jump
MOST_TIMES = 60
MOST_TRIALS = 200
SURE = 5.0  # nats of a trial from which it is listed


class Jumps(NamedTuple):
    """Evidence for jumps [nats], the trials that jump, and the joints (from 1) that do."""

    gain: float
    trials: list[str]
    joints: list[int]


def find_jumps(problem: Problem, candidate: Candidate) -> Jumps:
    """Weigh jumps in single trials on top of a fitted model."""
    angle, slope = problem.simulate(candidate.model, candidate.fit.own, candidate.fit.shared)
    inverse = np.linalg.inv(candidate.fit.omega)
    count = min(len(angle), MOST_TRIALS)
    evidence, outlier = np.zeros((2, count, problem.trials.joints))
    shapes: dict[int, tuple[NDArray, NDArray]] = {}
    for i in range(count):
        kind = int(problem.trials.protocol[i])
        if kind not in shapes:
            shapes = {kind: _whiten_shapes(problem, i)}
        white = whiten_trial(problem.trials, angle[i], slope[i], i)
        evidence[i], outlier[i] = (_weigh_shapes(white, shape, inverse) for shape in shapes[kind])
    rival = np.logaddexp.reduce(outlier, axis=1) - np.log(outlier.shape[1])
    trial = np.logaddexp.reduce(evidence, axis=1) - np.log(evidence.shape[1])
    trial -= np.maximum(rival, 0.0)
    mixed = [np.logaddexp(np.log1p(-p), np.log(p) + trial).sum() for p in SHARES]
    jumping = np.flatnonzero(trial > SURE)
    joints = sorted({int(evidence[i].argmax()) + 1 for i in jumping})
    gain = float(np.logaddexp.reduce(mixed) - np.log(len(mixed)))
    return Jumps(gain, [problem.trials.name[i] for i in jumping], joints)


def _weigh_shapes(white: NDArray, shape: NDArray, inverse: NDArray) -> NDArray[np.float64]:
    """Evidence [nats] of each joint (joint,) for a shape (row, joint, time) at any time."""
    d = len(inverse)
    own, left = white[:, :d], white[:, -1]
    cross = np.einsum("rd,rjs->djs", own, shape)
    kept = np.einsum("djs,de,ejs->js", cross, np.linalg.inv(inverse + own.T @ own), cross)
    size = np.maximum((shape**2).sum(axis=0) - kept, 0.0)
    pull = np.einsum("r,rjs->js", left, shape)
    each = [0.5 * (pull**2 / (size + s**-2.0) - np.log1p(size * s**2)) for s in SIZES_RAD]
    return np.logaddexp.reduce(np.stack(each), axis=(0, 2)) - np.log(len(each) * len(size[0]))


def _whiten_shapes(problem: Problem, trial: int) -> tuple[NDArray, NDArray]:
    """Whitened steps and outliers (row, joint, time) of a trial; a joint not seen has none."""
    bins = int(problem.trials.bins[trial])
    begin = np.unique(np.linspace(1, bins - 1, MOST_TIMES).astype(int))
    bin_ = np.arange(bins)
    steps = bin_[:, None] >= begin
    outliers = bin_[:, None] == bin_
    return tuple(_whiten_columns(problem, trial, shape) for shape in (steps, outliers))


def _whiten_columns(problem: Problem, trial: int, shape: NDArray) -> NDArray[np.float64]:
    """Whiten shapes (bin, time) of each joint of one trial: (row, joint, time)."""
    trials, number = problem.trials, shape.shape[1]
    slope = np.zeros((trials.joints, 2 * trials.node.shape[1], trials.joints * number))
    nodes = np.repeat(shape.astype(float), 2, axis=0)
    for j in np.flatnonzero(trials.present[trial]):
        slope[j, : len(nodes), j * number : (j + 1) * number] = nodes
    white = whiten_trial(trials, np.zeros(slope.shape[:2]), slope, trial)[:, :-1]
    return white.reshape(len(white), trials.joints, number)
