"""Draws of an expanded model, weighed by the model.

The sampler's target differs from the posterior by Δ = Σ_i [log p(y_i | η_i, φ) − its expansion].
Draws with weights exp Δ, Pareto-smoothed, are draws of the posterior; within each chain they are
drawn anew by these weights, in their order.

References
----------
Vehtari, Simpson, Gelman, Yao, Gabry (2024), JMLR 25(72): Pareto smoothed importance sampling.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from arviz_stats.accessors import AzStatsDaAccessor
from numpy.typing import NDArray

from softfinger.inference.budget import BUDGET
from softfinger.inference.decisions import DECISIONS
from softfinger.inference.expansion import Expansion, fill_squares
from softfinger.inference.motion import measure_draws
from softfinger.inference.problem import Candidate, Problem
from softfinger.progress import track_progress


class Correction(NamedTuple):
    """How far an expansion's draws are from the model's.

    Attributes
    ----------
    kept
        (chain, draw) places of the draws that weighing keeps, in their order.
    pareto_k
        Of the weights; NaN where draws were only sampled, not weighed.
    error
        Sd over draws and trials of one trial's Δ [nats].
    """

    kept: NDArray[np.int64]
    pareto_k: float
    error: float


def correct_draws(
    problem: Problem,
    candidate: Candidate,
    expansion: Expansion,
    draws: dict[str, NDArray[np.float64]],
    rng: np.random.Generator,
) -> Correction:
    """Weigh draws by the full model.

    Parameters
    ----------
    draws
        eta (chain, draw, trial, d), effect (chain, draw, p), noise_scale (chain, draw).

    Returns
    -------
    Correction
        With so many trials that weighing all draws would take long, every few draws are weighed
        and kept; where too few would be left, all are kept as they are, and `error` is measured.
    """
    chains, count, trials, _ = draws["eta"].shape
    total = chains * count
    every = -(-total * trials // BUDGET.simulated)
    weighs = total // every >= min(DECISIONS.least_kept, total)
    every = every if weighs else -(-total * trials // BUDGET.measured)
    whole = np.tile(np.arange(count), (chains, 1))
    change = np.stack(
        [_measure_change(problem, candidate, expansion, draws, c, every) for c in range(chains)]
    )
    error = float(np.nanstd(np.where(np.isfinite(change), change, np.nan)))
    log_weight = xr.DataArray(change.sum(axis=2), dims=("chain", "draw")).fillna(-np.inf)
    if not weighs or log_weight.size < DECISIONS.least_weighed:
        return Correction(whole, float("nan"), error)
    log_ratio = -log_weight  # ArviZ smooths the weights of a likelihood that is left out
    # of a tail that k then finds beyond all limits
    with np.errstate(over="ignore", invalid="ignore"):
        smoothed, k = AzStatsDaAccessor(log_ratio).psislw(dim=["chain", "draw"])
    if not float(k) <= DECISIONS.largest_k:
        return Correction(whole, float(k), error)
    weight = np.exp(smoothed.values - smoothed.values.max())
    if not weight.sum(axis=1).all():  # a chain that the model itself rules out has not converged
        return Correction(whole, float("inf"), error)
    kept = every * np.stack([resample_in_order(w, rng) for w in weight])
    return Correction(kept, float(k), error)


def resample_in_order(weight: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.int64]:
    """Draw places (n,) by their weights (n,), systematically.

    Equal weights keep all places as they are.

    >>> resample_in_order(np.array([1.0, 1.0, 2.0, 0.0]), np.random.default_rng(1))
    array([0, 1, 2, 2])
    """
    total = np.cumsum(weight) / weight.sum()
    point = (np.arange(len(weight)) + rng.random()) / len(weight)
    return np.minimum(np.searchsorted(total, point), len(weight) - 1)


def _measure_change(
    problem: Problem,
    candidate: Candidate,
    expansion: Expansion,
    draws: dict[str, NDArray[np.float64]],
    chain: int,
    every: int,
) -> NDArray[np.float64]:
    """Δ_i (draw, trial) [nats] of every few draws."""
    eta, effect = draws["eta"][chain, ::every], draws["effect"][chain, ::every]
    scale = draws["noise_scale"][chain, ::every]
    trials = eta.shape[1]
    batch = max(BUDGET.together // max(trials, 1), 1)
    change = np.empty(eta.shape[:2])
    near = np.empty(trials)
    for begin in track_progress(range(0, len(eta), batch), "weighing draws by the full model"):
        some = slice(begin, begin + batch)
        exact = measure_draws(problem, candidate, eta[some], effect[some])
        for k, square in enumerate(exact, start=begin):
            place = (expansion.own, expansion.shared, expansion.gram)
            fill_squares(np.ascontiguousarray(eta[k].T), effect[k], *place, near)
            change[k] = -0.5 * (square - near) / scale[k] ** 2
    return change
