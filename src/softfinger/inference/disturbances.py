"""What a wrong log or clock does to angles.

It makes the noise larger in some directions.

To first order an error of the load log, of a clock, or a drift of the picture adds G z, z normal
of sd s, with G what the error moves the angles by: the sensitivity of the model to the log, or
the speed of the finger. Its covariance s² G Gᵀ is of low rank, so with white rows (Σ = 1)

    (1 + s² G Gᵀ)⁻¹ = 1 − s G (1 + s² GᵀG)⁻¹ Gᵀ s

and all else follows from the Gram matrix of [∂F/∂η | ∂F/∂φ | residual | G].
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.inference.budget import BUDGET
from softfinger.inference.disturbance_directions import list_disturbances
from softfinger.inference.mixed_effects_laplace import Fit
from softfinger.inference.mixed_effects_linearised import solve_linearised
from softfinger.inference.priors import PRIORS
from softfinger.inference.problem import Candidate, Problem
from softfinger.inference.reduce import reduce_trials, whiten_residual, whiten_slope
from softfinger.measurement.components import choose_components

Array = NDArray[np.float64]

SIZES: Mapping[str, Array] = {
    "noisy_load": np.array(PRIORS.load_sizes),
    "load_drift": np.array(PRIORS.load_drift_sizes),
    "timing_jitter": np.array(PRIORS.jitter_sizes_s),
    "clock_offset": np.array(PRIORS.offset_sizes_s),
    "clock_rate": np.array(PRIORS.rate_sizes),
    "drift": np.array(PRIORS.drift_sizes),
    "gain_drift": np.array(PRIORS.gain_drift_sizes),
}
SLIGHT = 1e-6  # of the noise's variance, that a direction adds


def fit_disturbances(
    problem: Problem, candidate: Candidate
) -> tuple[dict[str, float], dict[str, float], dict[str, Array]]:
    """Find which disturbances a fitted model's residual shows.

    Returns
    -------
    size, evidence, directions
        Id → size and evidence [nats] of those that are present; `list_disturbances`.
    """
    directions = list_disturbances(problem, candidate)
    fit = candidate.fit
    angle, slope = problem.simulate(candidate.model, fit.own, fit.shared)
    known = slope.shape[3]
    whole = reduce_trials(
        problem.trials, angle, np.concatenate([slope, *directions.values()], axis=3)
    )
    ends = np.cumsum([known, *(g.shape[3] for g in directions.values())])
    places = {n: np.arange(a, b) for n, a, b in zip(directions, ends, ends[1:], strict=False)}
    prior, bounds = problem.build_prior(candidate.model), problem.build_bounds(candidate.model)
    model = np.append(np.arange(known), whole.shape[1] - 1)

    def evaluate(size: Mapping[str, float]) -> float:
        gram, logdet = soften_gram_array(whole, model, {n: (places[n], s) for n, s in size.items()})
        place = fit.own, fit.shared
        rounds = BUDGET.disturbance_rounds
        value = solve_linearised(gram, prior, bounds, place, fit.omega, rounds=rounds)[1]
        return value - 0.5 * float(logdet)

    sizes = {name: SIZES[name] for name in directions if np.any(directions[name])}
    return *choose_components(evaluate, sizes), directions


def soften_gram_array(
    whole: Array, model: NDArray[np.int64], soft: Mapping[str, tuple[NDArray[np.int64], float]]
) -> tuple[Array, float]:
    """Gram matrices (trial, …) under larger noise.

    They are of some columns; also what log|Σ| gains.

    Parameters
    ----------
    whole
        (trial, …) Gram matrices of all columns, white.
    model
        Places of the columns that are kept.
    soft
        Places of directions and the sd along each.

    Examples
    --------
    One number with one direction along it: its variance is 1 + 3.

    >>> gram, logdet = soften_gram_array(np.ones((1, 2, 2)), np.zeros(1, int),
    ...                                  {"drift": (np.ones(1, int), np.sqrt(3.0))})
    >>> gram.round(6).tolist(), round(logdet, 6)
    ([[[0.25]]], 1.386294)
    """
    gram = whole[:, model[:, None], model]
    if not soft:
        return gram, 0.0
    place = np.concatenate([places for places, _ in soft.values()])
    sd = np.concatenate([np.full(len(places), size) for places, size in soft.values()])
    inner = np.eye(len(place)) + whole[:, place[:, None], place] * np.outer(sd, sd)
    cross = whole[:, place[:, None], model] * sd[:, None]
    gram = gram - cross.transpose(0, 2, 1) @ np.linalg.solve(inner, cross)
    return gram, float(np.linalg.slogdet(inner)[1].sum())


def admit_disturbances(
    problem: Problem, size: Mapping[str, float], directions: Mapping[str, Array]
) -> Problem:
    """Enlarge the noise along some directions by their sizes."""
    trials = problem.trials
    scaled = np.concatenate([size[name] * directions[name] for name in size], axis=3)
    parts, gained = [], []
    for i in range(len(trials.name)):
        vectors, sd, _ = np.linalg.svd(whiten_slope(trials, scaled, i), full_matrices=False)
        gained.append(np.log1p(sd**2).sum())
        kept = sd**2 > SLIGHT
        shrink = 1.0 - 1.0 / np.sqrt(1.0 + sd[kept] ** 2)
        parts.append(vectors[:, kept] * np.sqrt(shrink))
    soft = np.zeros((len(parts), trials.size.max(), max(part.shape[1] for part in parts)))
    for whole, part in zip(soft, parts, strict=True):
        whole[: len(part), : part.shape[1]] = part
    softer = trials._replace(soft=soft, logdet=trials.logdet + np.array(gained))
    return replace(problem, trials=softer, directions=scaled, disturbed=dict(size))


def admit_known(problem: Problem, fit: Fit, size: Mapping[str, float]) -> tuple[Problem, Fit]:
    """Admit disturbances of known sizes, and fit the base again."""
    directions = list_disturbances(problem, Candidate(problem.base, fit, fit.log_evidence))
    size = {name: sd for name, sd in size.items() if name in directions}
    if not size:
        return problem, fit
    softer = admit_disturbances(problem, size, directions)
    again = softer.fit(problem.base, (fit.own, fit.shared, fit.omega))
    if again is None:
        raise Fault(
            f"the model cannot be fitted with the disturbances {', '.join(size)} of the model "
            "file's measurement; remove them there"
        )
    return softer, again._replace(first=again.log_evidence)


def spread_disturbances(problem: Problem, like: NDArray[np.int64], time: Array) -> Array:
    """Interpolate trials' directions to times.

    The times are (trial, moment) [s] of trials `like`, their places; the result is
    (trial, joint, moment, k) [rad], each column times a standard normal number.
    """
    trials, directions = problem.trials, problem.directions
    if directions is None:
        return np.zeros((len(like), trials.joints, time.shape[1], 0))
    found = np.zeros((len(like), trials.joints, time.shape[1], directions.shape[3]))
    for row, trial in enumerate(like):
        node = trials.node[trial].ravel()
        for joint, column in np.ndindex(trials.joints, directions.shape[3]):
            moved = np.interp(time[row], node, directions[trial, joint, :, column])
            found[row, joint, :, column] = moved
    return found


def locate_disturbances(problem: Problem, candidate: Candidate, time: Array) -> Array:
    """Most probable disturbance (trial, joint, frame) [rad] at times.

    The times are (trial, frame) [s].

    The modes of η and φ are given; between the bins' nodes it follows straight lines.
    """
    trials, fit, moved = problem.trials, candidate.fit, problem.directions
    found = np.zeros((len(trials.name), trials.joints, time.shape[1]))
    if moved is None:
        return found
    angle = problem.simulate(candidate.model, fit.own, fit.shared, np.zeros(0, np.int64))[0]
    stiff = trials._replace(soft=trials.soft[:, :, :0])
    for i in range(len(trials.name)):
        white, left = whiten_slope(trials, moved, i), whiten_residual(stiff, angle, i)
        left = left[:, trials.present[i]].ravel()
        inner = np.eye(white.shape[1]) + white.T @ white
        shift = moved[i] @ np.linalg.solve(inner, white.T @ left)
        for j in range(trials.joints):
            found[i, j] = np.interp(time[i], trials.node[i].ravel(), shift[j])
    return found
