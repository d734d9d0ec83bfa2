"""What a law of the rate does to joints.

Their resistance is not in proportion to the motion.

A Voigt element whose damper resists by c_v (θ̇ − s(θ̇)/τ), τ = c_v/k_v, moves as the linear one but
for δ, where to first order τ δ̇ + δ = s(θ̇): a spline of the rate that the element follows late.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics import OWN

APART = 0.02  # frame intervals between two angles whose difference is a rate

Array = NDArray[np.float64]


def compute_rate_array(problem: Problem, candidate: Candidate) -> Array:
    """A fitted model's joint rates (trial, joint, node) [rad/s]."""
    apart = APART * problem.trials.interval
    later = replace(problem, trials=problem.trials._replace(node=problem.trials.node + apart))
    fit, nothing = candidate.fit, np.zeros(0, np.int64)
    now, then = (
        p.simulate(candidate.model, fit.own, fit.shared, only=nothing)[0] for p in (problem, later)
    )
    return np.nan_to_num((then - now) / apart)


def follow_late_array(problem: Problem, candidate: Candidate, basis: Array) -> Array:
    """Let Voigt elements follow functions of time.

    The elements are the trials'; the functions are (trial, joint, node, function).

    Between nodes the functions are straight lines, for which the response is exact.
    """
    trials, own = problem.trials, candidate.fit.own
    own = own.reshape(len(own), trials.joints, OWN)
    retardation = np.exp(own[:, :, 1] - own[:, :, 0])
    step = np.diff(trials.node.reshape(len(own), -1), axis=1)[:, None] / retardation[:, :, None]
    stays = np.exp(-step)[..., None]  # of what was there; `mean` is its mean over the step
    mean = np.where(step > 1e-6, -np.expm1(-step) / np.maximum(step, 1e-6), 1.0)[..., None]
    followed = np.zeros_like(basis)
    for k in range(step.shape[2]):
        before, after = basis[:, :, k], basis[:, :, k + 1]
        followed[:, :, k + 1] = (
            stays[:, :, k] * followed[:, :, k]
            + (mean[:, :, k] - stays[:, :, k]) * before
            + (1.0 - mean[:, :, k]) * after
        )
    return followed
