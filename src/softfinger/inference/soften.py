"""Gram matrices under larger noise.

Trial i's noise gains D u with D = [sd_k D_k] and u ~ N(0, 1), D_k the directions of disturbance k.
Integrated over u, the Gram matrices of all other columns C shrink:

    Cᵀ (1 + D Dᵀ)⁻¹ C = CᵀC − (DᵀC)ᵀ (1 + DᵀD)⁻¹ DᵀC,   log|1 + D Dᵀ| = log|1 + DᵀD|

so that disturbances may be integrated one after the other.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.mixed_effects import LinearFit

Array = NDArray[np.float64]


class Softening(NamedTuple):
    """Gram matrices of a model and of disturbances.

    Along a disturbance's directions the noise may be larger.

    Attributes
    ----------
    gram
        (trial, column, column), white.
    model
        Places of the model's columns, the residual last.
    places
        Disturbance → places of its directions.
    """

    gram: Array
    model: NDArray[np.int64]
    places: Mapping[str, NDArray[np.int64]]


def soften_gram(soft: Softening, size: Mapping[str, float]) -> tuple[Array, float]:
    """Gram matrices (trial, …) of the model under larger noise.

    Also what log|Σ| gains.

    Parameters
    ----------
    size
        Disturbance → the sd along each of its directions.

    Examples
    --------
    One number with one direction along it: its variance is 1 + 3.

    >>> one = Softening(np.ones((1, 2, 2)), np.zeros(1, int), {"drift": np.ones(1, int)})
    >>> gram, logdet = soften_gram(one, {"drift": np.sqrt(3.0)})
    >>> gram.round(6).tolist(), round(logdet, 6)
    ([[[0.25]]], 1.386294)
    """
    return _integrate(soft, size, soft.model)


def admit(soft: Softening, size: Mapping[str, float]) -> tuple[Softening, float]:
    """Integrate some disturbances; those that are left, and what log|Σ| gains.

    >>> two = {"drift": np.ones(1, int), "jitter": np.full(1, 2)}
    >>> left, _ = admit(Softening(np.ones((1, 3, 3)), np.zeros(1, int), two), {"drift": 1.0})
    >>> list(left.places), left.gram.round(6).tolist()
    (['jitter'], [[[0.5, 0.5], [0.5, 0.5]]])
    """
    left = {name: places for name, places in soft.places.items() if name not in size}
    kept = np.concatenate([soft.model, *left.values()])
    ends = np.cumsum([len(soft.model), *map(len, left.values())])
    gram, logdet = _integrate(soft, size, kept)
    places = {n: np.arange(a, b) for n, a, b in zip(left, ends, ends[1:], strict=False)}
    return Softening(gram, np.arange(ends[0]), places), logdet


def measure_excess(
    soft: Softening,
    size: Mapping[str, float],
    gram: Array,
    linear: LinearFit,
    place: tuple[Array, Array],
) -> dict[str, float]:
    """Slope of the log evidence by the log of each size.

    The evidence is that without bounds. The slope is the sum of E[u²] − 1 over trials and
    directions (Fisher's identity), u integrated over the parameters of the fit.

    Parameters
    ----------
    gram, linear
        The softened matrices, and the fit to them.
    place
        (η, φ) where the model is linearised.
    """
    inner, cross = _couple(soft, size, soft.model)
    root = np.linalg.inv(np.linalg.cholesky(inner))
    pull = root.transpose(0, 2, 1) @ (root @ cross)
    moment = _expect_products(gram, linear, place)
    square = (root**2).sum(axis=1) + ((pull @ moment) * pull).sum(axis=2)
    ends = np.cumsum([0, *(len(soft.places[name]) for name in size)])
    excess = (square - 1.0).sum(axis=0)
    return {n: float(excess[a:b].sum()) for n, a, b in zip(size, ends, ends[1:], strict=False)}


def _integrate(
    soft: Softening, size: Mapping[str, float], kept: NDArray[np.int64]
) -> tuple[Array, float]:
    gram = soft.gram[:, kept[:, None], kept]
    if not size:
        return gram, 0.0
    inner, cross = _couple(soft, size, kept)
    factor = np.linalg.cholesky(inner)
    white = np.linalg.solve(factor, cross)
    logdet = 2.0 * np.log(np.einsum("tkk->tk", factor)).sum()
    return gram - white.transpose(0, 2, 1) @ white, float(logdet)


def _couple(
    soft: Softening, size: Mapping[str, float], kept: NDArray[np.int64]
) -> tuple[Array, Array]:
    """1 + DᵀD (trial, k, k) and DᵀC (trial, k, kept)."""
    place = np.concatenate([soft.places[name] for name in size])
    sd = np.concatenate([np.full(len(soft.places[name]), sd) for name, sd in size.items()])
    rows = soft.gram[:, place] * sd[:, None]
    return np.eye(len(place)) + rows[:, :, place] * sd, rows[:, :, kept]


def _expect_products(gram: Array, linear: LinearFit, place: tuple[Array, Array]) -> Array:
    """E[c cᵀ] (trial, …): the residual is C c, c = (η₀ − η, φ₀ − φ, 1)."""
    trials, d = linear.own.shape
    m = len(linear.shared)
    shift = np.concatenate(
        [place[0] - linear.own, np.broadcast_to(place[1] - linear.shared[d:], (trials, m - d))],
        axis=1,
    )
    follow = np.broadcast_to(np.eye(m), (trials, m, m)).copy()  # what (η, φ) is of (μ, φ)
    follow[:, :d] -= linear.own_covariance @ gram[:, :d, :m]
    moment = np.ones((trials, m + 1, m + 1))
    moment[:, :m, :m] = follow @ linear.shared_covariance @ follow.transpose(0, 2, 1)
    moment[:, :m, :m] += shift[:, :, None] * shift[:, None]
    moment[:, :d, :d] += linear.own_covariance
    moment[:, :m, m] = moment[:, m, :m] = shift
    return moment
