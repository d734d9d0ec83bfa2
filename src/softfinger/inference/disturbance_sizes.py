"""Which disturbances a fitted model shows, and how large."""

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.budget import BUDGET
from softfinger.inference.disturbances import (
    IN_GAPS,
    IN_NOISE,
    SIZES,
    find_kind,
    list_disturbances,
)
from softfinger.inference.mixed_effects import Prior
from softfinger.inference.mixed_effects_linearised import (
    SharedBounds,
    measure_linearised,
    solve_linearised,
)
from softfinger.inference.priors import PRIORS
from softfinger.inference.problem import Candidate, Problem
from softfinger.inference.reduce import reduce_trials
from softfinger.inference.soften import Softening, admit, measure_excess, soften_gram
from softfinger.inference.spreads import list_spreads
from softfinger.measurement.components import Climb, choose_components, is_at_bound
from softfinger.measurement.decisions import DECISIONS as MEASURING

Array = NDArray[np.float64]


class Moves(NamedTuple):
    """How a fitted model moves, and how disturbances move it.

    Attributes
    ----------
    angle, slope
        As of `Problem.simulate`.
    directions
        Id → (trial, joint, bin · 2, column) [rad] of `list_disturbances`, and of `list_spreads` of
        the effects' parameters.
    """

    angle: Array
    slope: Array
    directions: dict[str, Array]


def list_moves(problem: Problem, candidate: Candidate) -> Moves:
    """Simulate a fitted model, and what disturbances do to it."""
    angle, slope = problem.simulate(candidate.model, candidate.fit.own, candidate.fit.shared)
    directions = list_disturbances(problem, candidate) | list_spreads(candidate, slope)
    return Moves(angle, slope, directions)


def fit_disturbances(
    problem: Problem,
    candidate: Candidate,
    least: float = MEASURING.present_nats,
    moves: Moves | None = None,
    **limits: int,
) -> tuple[dict[str, float], dict[str, float], dict[str, Array]]:
    """Find which disturbances a fitted model's residual shows.

    Those with `least` nats of evidence; `limits` as of `choose_components`; `moves` where the model
    was simulated before, whatever the noise was.

    What would have to move the angles by a large share of their motion is physics that the model
    lacks, and no disturbance. So is an error of log, clock or gain that asks for more than any rig
    has. What is known in units of the noise, or of an effect, has no such size.

    Returns
    -------
    size, evidence, directions
        Id → size and evidence [nats] of those that are present; all of `Moves`.
    """
    fit = candidate.fit
    angle, slope, directions = moves or list_moves(problem, candidate)
    known = slope.shape[3]
    gram = reduce_trials(
        problem.trials, angle, np.concatenate([slope, *directions.values()], axis=3)
    )
    ends = np.cumsum([known, *(g.shape[3] for g in directions.values())])
    places = {n: np.arange(a, b) for n, a, b in zip(directions, ends, ends[1:], strict=False)}
    soft = Softening(gram, np.append(np.arange(known), gram.shape[1] - 1), places)
    model = problem.build_prior(candidate.model), problem.build_bounds(candidate.model)
    evaluate, climb = _build_evidence(soft, model, (fit.own, fit.shared), fit.omega)
    seen = [name for name, g in directions.items() if np.any(g) and np.isfinite(g).all()]
    spread = np.array(PRIORS.effect_spreads)
    sizes = {n: SIZES[kind] if (kind := find_kind(n)) else spread for n in seen}
    largest = PRIORS.largest_share * float(np.abs(angle - angle[:, :, :1]).max())

    def is_plausible(name: str, size: float) -> bool:
        kind = find_kind(name)
        if kind and kind not in IN_GAPS and size * measure_sd_array(directions[name]) > largest:
            return False
        return kind is None or kind in IN_NOISE or not is_at_bound(size, sizes[name])

    size, evidence = choose_components(evaluate, sizes, least, is_plausible, climb=climb, **limits)
    return size, evidence, directions


def _build_evidence(
    soft: Softening,
    model: tuple[Prior, SharedBounds],
    place: tuple[Array, Array],
    omega: Array,
) -> tuple[Callable[[Mapping[str, float]], float], Climb]:
    """Build the log evidence [nats] by disturbances' sizes.

    Also that without bounds, which has slopes.
    """
    rounds = BUDGET.disturbance_rounds

    @lru_cache(maxsize=1)  # one after the other is weighed beside the same ones
    def keep(size: tuple[tuple[str, float], ...]) -> tuple[Softening, float]:
        return admit(soft, dict(size))

    def evaluate(size: Mapping[str, float]) -> float:
        items = tuple(size.items())
        left, logdet = keep(items[:-1])
        gram, gained = soften_gram(left, dict(items[-1:]))
        value = measure_linearised(gram, *model, place, omega, rounds)
        return value - 0.5 * (logdet + gained)

    def climb(size: Mapping[str, float]) -> tuple[float, dict[str, float]]:
        gram, logdet = soften_gram(soft, size)
        try:
            linear, _ = solve_linearised(gram, *model, place, omega, rounds=rounds)
        except np.linalg.LinAlgError:
            return -np.inf, dict.fromkeys(size, 0.0)
        slope = measure_excess(soft, size, gram, linear, place)
        return linear.log_evidence - 0.5 * logdet, slope

    return evaluate, climb


def measure_sd_array(columns: Array) -> float:
    """Sd [rad] of what a disturbance of unit size adds.

    It is that of the joint which it moves most. Columns are (trial, joint, bin · 2, column).

    >>> round(measure_sd_array(np.ones((1, 2, 6, 4))), 6)
    2.0
    """
    return float(np.sqrt((columns**2).sum(axis=3).mean(axis=(0, 2)).max()))
