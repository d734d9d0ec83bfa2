"""Replicates: campaigns without effects, drawn from the fitted base model.

They have the campaign's own loads and frames, but are drawn only in the whitened reduced space: of
a trial z* = A b + e nothing is needed but Cᵀe + (CᵀA) b. The noise e is normal, or t-distributed
row by row where quiet windows show heavy tails (`inference/tails.py`). The parameters b are those
of the trials, in another order and with either sign: they keep their tails and what joints have in
common, of which a normal with Ω knows nothing, and of which few trials show little.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.mixed_effects import Prior
from softfinger.inference.problem import Candidate
from softfinger.mismatch.budget import BUDGET

RIDGE = 1e-10  # of a column's square: far below what a score shows


def draw_products(
    whole: NDArray,
    base: Candidate,
    prior: Prior,
    rng: np.random.Generator,
    replicates: int,
    tails: Sequence[tuple[NDArray, NDArray]] = (),
) -> Iterator[NDArray]:
    """Draw Cᵀz (trial, d + c) about μ from the base model.

    Parameters
    ----------
    whole
        (trial, d + c, d + c) CᵀC.
    tails
        Rows C (row, d + c) and their noise's degrees of freedom (row,) of each trial; none where
        it is normal.
    """
    factor = None if tails else np.stack([_root(gram) for gram in whole])
    d = len(base.fit.omega)
    for begin in range(0, replicates, BUDGET.replicates):
        some = min(BUDGET.replicates, replicates - begin)
        own = _draw_own(whole, base, prior, rng, some)
        noise = _draw_noise(factor, tails, rng, some)
        product = noise + whole[:, :, :d] @ own.transpose(1, 2, 0)
        yield from np.ascontiguousarray(product.transpose(2, 0, 1))


def _draw_noise(
    factor: NDArray | None,
    tails: Sequence[tuple[NDArray, NDArray]],
    rng: np.random.Generator,
    count: int,
) -> NDArray:
    """Draw Cᵀe (trial, d + c, count) of unit variance."""
    if factor is not None:
        return factor @ rng.standard_normal((*factor.shape[:2], count))
    return np.stack([rows.T @ _draw_tailed(freedom, rng, count) for rows, freedom in tails])


def _draw_tailed(freedom: NDArray, rng: np.random.Generator, count: int) -> NDArray:
    """Draw t-distributed noise (row, count) of unit variance."""
    drawn = rng.standard_t(freedom[:, None], (len(freedom), count))
    return np.sqrt((freedom - 2.0) / freedom)[:, None] * drawn


def _draw_own(
    whole: NDArray, base: Candidate, prior: Prior, rng: np.random.Generator, count: int
) -> NDArray:
    """Draw the trials' parameters (count, trial, d) about μ.

    Ω is the mean square of the trials' parameters, as far as they are known, and of as many typical
    ones as its prior counts. So each draw is a permutation of these.
    """
    fit, (trials, d) = base.fit, base.fit.own.shape
    doubt = _root_of_covariance(fit.own_covariance)
    common = fit.own_covariance @ whole[:, :d, :d] @ _root_of_covariance(fit.mean_covariance)
    drawn = np.empty((count, trials, d))
    for one in drawn:
        known = fit.own - fit.mean + common @ rng.standard_normal(d)
        known += (doubt @ rng.standard_normal((trials, d, 1)))[..., 0]
        typical = prior.spread * rng.standard_normal((round(prior.weight), d))
        order = rng.permutation(np.concatenate([known, typical]))
        one[:] = order[:trials] * rng.choice([-1.0, 1.0], (trials, 1))
    return drawn


def set_apart(gram: NDArray) -> NDArray:
    """Give each column a hair of its own.

    Gram matrices are (trial, …) or one. Columns hide in each other: what is left of one then is
    rounding, and no root exists. Draws from another matrix than the one that scores them would
    gain without bound.
    """
    apart = gram.copy()
    diagonal = np.einsum("...ii->...i", apart)
    diagonal *= 1.0 + RIDGE
    diagonal += np.finfo(float).tiny  # of a column that moves nothing
    return apart


def _root(gram: NDArray) -> NDArray:
    """Root R of a Gram matrix G = RRᵀ, in scaled columns."""
    size = np.sqrt(np.diag(gram))
    return np.linalg.cholesky(gram / np.outer(size, size)) * size[:, None]


def _root_of_covariance(covariance: NDArray) -> NDArray:
    """Root R of a covariance C = RRᵀ, singular or not.

    Precise recordings leave differences of parameters no variance but rounding, of either sign.
    """
    size = np.sqrt(np.einsum("...ii->...i", covariance))[..., None]
    value, vector = np.linalg.eigh(covariance / (size * size.swapaxes(-1, -2)))
    return size * vector * np.sqrt(np.maximum(value, 0.0))[..., None, :]
