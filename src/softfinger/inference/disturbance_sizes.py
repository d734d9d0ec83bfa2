"""Which disturbances a fitted model shows, and how large."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.budget import BUDGET
from softfinger.inference.disturbances import IN_NOISE, SIZES, find_kind, list_disturbances
from softfinger.inference.mixed_effects_linearised import measure_linearised
from softfinger.inference.priors import PRIORS
from softfinger.inference.problem import Candidate, Problem
from softfinger.inference.reduce import reduce_trials
from softfinger.inference.spreads import list_spreads
from softfinger.measurement.components import choose_components, is_at_bound
from softfinger.measurement.decisions import DECISIONS as MEASURING

Array = NDArray[np.float64]


def fit_disturbances(
    problem: Problem, candidate: Candidate, least: float = MEASURING.present_nats, **limits: int
) -> tuple[dict[str, float], dict[str, float], dict[str, Array]]:
    """Find which disturbances a fitted model's residual shows.

    Those with `least` nats of evidence; `limits` as of `choose_components`.

    What would have to move the angles by a large share of their motion is physics that the model
    lacks, and no disturbance. So is an error of log, clock or gain that asks for more than any rig
    has. What is known in units of the noise, or of an effect, has no such size.

    Returns
    -------
    size, evidence, directions
        Id → size and evidence [nats] of those that are present; `list_disturbances`, and
        `list_spreads` of the effects' parameters.
    """
    fit = candidate.fit
    angle, slope = problem.simulate(candidate.model, fit.own, fit.shared)
    directions = list_disturbances(problem, candidate) | list_spreads(candidate, slope)
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
        value = measure_linearised(gram, prior, bounds, place, fit.omega, rounds)
        return value - 0.5 * float(logdet)

    seen = [name for name in directions if np.any(directions[name])]
    spread = np.array(PRIORS.effect_spreads)
    sizes = {n: SIZES[kind] if (kind := find_kind(n)) else spread for n in seen}
    largest = PRIORS.largest_share * float(np.abs(angle - angle[:, :, :1]).max())

    def is_plausible(name: str, size: float) -> bool:
        kind = find_kind(name)
        if kind and size * measure_sd_array(directions[name]) > largest:
            return False
        return kind is None or kind in IN_NOISE or not is_at_bound(size, sizes[name])

    size, evidence = choose_components(evaluate, sizes, least, is_plausible, **limits)
    return size, evidence, directions


def measure_sd_array(columns: Array) -> float:
    """Sd [rad] of what a disturbance of unit size adds.

    It is that of the joint which it moves most. Columns are (trial, joint, bin · 2, column).

    >>> round(measure_sd_array(np.ones((1, 2, 6, 4))), 6)
    2.0
    """
    return float(np.sqrt((columns**2).sum(axis=3).mean(axis=(0, 2)).max()))


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
