"""Jumps in single trials: angles that are off by a constant from some moment on, as after a slip.

A trial's residual is weighed against a step of normal size in one joint, at any time, its own
parameters free to adapt; the evidence is averaged over joints, times and sizes. Trials jump with an
unknown probability, over which it is averaged as well.
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
    d = len(inverse)
    count = min(len(angle), MOST_TRIALS)
    evidence = np.zeros((count, problem.trials.joints))
    steps: dict[int, NDArray] = {}
    for i in range(count):
        kind = int(problem.trials.protocol[i])
        if kind not in steps:
            steps = {kind: _whiten_steps(problem, i)}
        white = whiten_trial(problem.trials, angle[i], slope[i], i)
        own, left = white[:, :d], white[:, -1]
        cross = np.einsum("rd,rjs->djs", own, steps[kind])
        kept = np.einsum("djs,de,ejs->js", cross, np.linalg.inv(inverse + own.T @ own), cross)
        size = np.maximum((steps[kind] ** 2).sum(axis=0) - kept, 0.0)
        pull = np.einsum("r,rjs->js", left, steps[kind])
        each = [0.5 * (pull**2 / (size + s**-2.0) - np.log1p(size * s**2)) for s in SIZES_RAD]
        evidence[i] = np.logaddexp.reduce(np.stack(each), axis=(0, 2)) - np.log(
            len(each) * len(size[0])
        )
    trial = np.logaddexp.reduce(evidence, axis=1) - np.log(evidence.shape[1])
    mixed = [np.logaddexp(np.log1p(-p), np.log(p) + trial).sum() for p in SHARES]
    jumping = np.flatnonzero(trial > SURE)
    joints = sorted({int(evidence[i].argmax()) + 1 for i in jumping})
    gain = float(np.logaddexp.reduce(mixed) - np.log(len(mixed)))
    return Jumps(gain, [problem.trials.name[i] for i in jumping], joints)


def _whiten_steps(problem: Problem, trial: int) -> NDArray[np.float64]:
    """Whitened steps (row, joint, time) of one trial; a joint that was not seen has none."""
    trials = problem.trials
    bins, present = int(trials.bins[trial]), trials.present[trial]
    begin = np.unique(np.linspace(1, bins - 1, MOST_TIMES).astype(int))
    slope = np.zeros((trials.joints, 2 * trials.node.shape[1], trials.joints * len(begin)))
    for j in np.flatnonzero(present):
        for k, first in enumerate(begin):
            slope[j, 2 * first :, j * len(begin) + k] = 1.0
    white = whiten_trial(trials, np.zeros(slope.shape[:2]), slope, trial)[:, :-1]
    return white.reshape(len(white), trials.joints, len(begin))
