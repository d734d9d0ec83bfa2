"""Noise with heavy tails: what they explain counts less.

A white row x of a bin of n frames is t-distributed with ν n degrees of freedom and variance 1, ν
being what quiet windows show: the mean of many frames is all but normal. For every weight w

    log t(x) ≥ log N(x; 0, 1/w) + g(w),   with equality where w = (ν n + 1) / (ν n − 2 + x²)

so normal noise of those weights gives a lower bound of the evidence, tight at the model whose
residual gave them. No weight is above 1: what lies close counts as under normal noise.

References
----------
Jaakkola, Jordan (2000), Stat. Comput. 10, 25, doi:10.1023/A:1008932416310.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm
from scipy.stats import t as student

from softfinger.inference.problem import Candidate, Problem
from softfinger.inference.reduce import whiten_residual

Array = NDArray[np.float64]


def weigh_tails(problem: Problem, candidate: Candidate, softer: Problem) -> Problem:
    """Weigh a problem's white rows as heavy tails require.

    As it is where quiet windows show none.

    Parameters
    ----------
    softer
        The same problem with the disturbances that the candidate's residual shows: what they
        explain is no tail.
    """
    freedom = list_freedom(problem)
    if not freedom:
        return problem
    fit, trials = candidate.fit, problem.trials
    angle = problem.simulate(candidate.model, fit.own, fit.shared, np.zeros(0, np.int64))[0]
    trust, tails = np.ones_like(trials.trust), np.zeros_like(trials.tails)
    for i, rows in enumerate(freedom):
        left = whiten_residual(softer.trials, angle, i)[:, trials.present[i]]
        weight, gain = weigh_rows_array(left.ravel(), rows)
        trust[i, : weight.size] = np.sqrt(weight)
        tails[i] = gain.sum()
    return replace(problem, trials=trials._replace(trust=trust, tails=tails))


def list_freedom(problem: Problem) -> list[Array]:
    """Degrees of freedom (row,) of each trial's white rows.

    Empty where quiet windows show no heavy tails.
    """
    known, trials = problem.noise["component_size"], problem.trials
    if "heavy_tails" not in known["component"].values:
        return []
    freedom = float(known.sel(component="heavy_tails"))
    joints = trials.present.sum(axis=1)
    return [
        freedom * np.repeat(np.diff(starts), count)
        for starts, count in zip(trials.starts, joints, strict=True)
    ]


def weigh_rows_array(row: Array, freedom: Array) -> tuple[Array, Array]:
    """Weights (n,) of white rows (n,), and what the bound adds.

    The second is g(w) + ½ log w [nats]; `freedom` is (n,).

    >>> weight, gain = weigh_rows_array(np.array([0.0, 1.7, 6.0]), np.full(3, 4.0))
    >>> weight.round(3).tolist()
    [1.0, 1.0, 0.132]
    >>> tight = student.logpdf(6.0, 4.0, scale=np.sqrt(0.5)) + 0.5 * np.log(2 * np.pi)
    >>> round(float(gain[2] - 0.5 * weight[2] * 36.0 - tight), 9)
    0.0
    """
    weight = np.minimum((freedom + 1.0) / (freedom - 2.0 + row**2), 1.0)
    equal = np.sqrt(np.maximum((freedom + 1.0) / weight - freedom + 2.0, 0.0))  # where it is tight
    tail = student.logpdf(equal, freedom, scale=np.sqrt((freedom - 2.0) / freedom))
    return weight, tail - norm.logpdf(equal) - 0.5 * (1.0 - weight) * equal**2
