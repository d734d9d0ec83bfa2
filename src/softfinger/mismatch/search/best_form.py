"""The form that gains most in a replicate.

A form gains as it does where the recordings are scored: by one linearisation, the law with the
size of most evidence, and without the places that it does not need. Chance has the same choices.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.inference.mixed_effects import Prior, climb_omega, invert_scaled, solve_gram
from softfinger.mismatch.candidates.columns import ScoreColumns
from softfinger.mismatch.priors import PRIORS

ROUNDS, SLIGHT = 3, 0.1  # of EM, and the nats at which it stops: a score errs by more


class BestForm(NamedTuple):
    """A form's gain [nats], the size of its law, and its columns.

    They are those of the places that it needs.
    """

    gain: float
    size: float
    columns: NDArray[np.int64]


class Squares(NamedTuple):
    """What all replicates have in common of CᵀC.

    Attributes
    ----------
    own
        (trial, d, d) of ∂F/∂η.
    side
        (trial, c, d) of the forms' columns with ∂F/∂η.
    form
        (c, a) of each column with those of its form, over all trials.
    """

    own: NDArray[np.float64]
    side: NDArray[np.float64]
    form: NDArray[np.float64]


def gather_squares(columns: ScoreColumns, gram: NDArray[np.float64], d: int) -> Squares:
    """Gather what scores need of the columns' products.

    `gram` is CᵀC (trial, d + c, d + c).
    """
    form = np.zeros((gram.shape[1] - d, columns.count.max(initial=0)))
    for first, count in zip(columns.first, columns.count, strict=True):
        part = slice(d + first, d + first + count)
        form[first : first + count, :count] = gram[:, part, part].sum(axis=0)
    own, side = gram[:, :d, :d], gram[:, d:, :d]
    return Squares(np.ascontiguousarray(own), np.ascontiguousarray(side), form)


def find_best_form(
    columns: ScoreColumns,
    squares: Squares,
    product: NDArray[np.float64],
    prior: Prior,
    omega: NDArray[np.float64],
) -> tuple[BestForm, float]:
    """Find the form that gains most, and the evidence of none.

    Ω is fitted under the base model.

    Parameters
    ----------
    product
        Cᵀz (trial, d + c).
    """
    if not columns.blocks:
        return BestForm(-np.inf, 1.0, np.zeros(0, int)), 0.0
    own = _join_own(squares, product, len(omega))
    omega, _ = climb_omega(own, prior, omega, ROUNDS, SLIGHT)
    shared, covariance, _, _, _, alone, _ = solve_gram(own, prior, omega)
    cross, direct, square = _take_up(squares, product, columns.first, columns.count, omega)
    gain, size, form, kept = _find_best(
        (cross, direct - cross @ shared, square),
        covariance,
        (columns.first, columns.count),
        columns.sd,
        (columns.law, columns.positive, columns.place),
        np.array(PRIORS.law_sizes),
    )
    more = columns.first[form] + np.flatnonzero(kept[: columns.count[form]])
    return BestForm(gain, size, more), alone


def _join_own(squares: Squares, product: NDArray[np.float64], d: int) -> NDArray[np.float64]:
    """Gram matrices of [∂F/∂η | z]: (trial, d + 1, d + 1)."""
    own = np.zeros((len(product), d + 1, d + 1))
    own[:, :d, :d] = squares.own
    own[:, :d, d] = own[:, d, :d] = product[:, :d]
    return own


@compiled
def _find_best(
    left: tuple[NDArray, NDArray, NDArray],
    covariance: NDArray,
    forms: tuple[NDArray, NDArray],
    amplitude_sd: NDArray,
    kinds: tuple[NDArray, NDArray, NDArray],
    sizes: NDArray,
) -> tuple[float, float, int, NDArray]:
    """Gain, size and number of the best form, and its columns.

    `left` is what `_take_up` returns, the products with z at the fitted μ.
    """
    cross, direct, square = left
    first, count = forms
    law, positive, place = kinds
    best, best_size, best_form = -np.inf, 1.0, 0
    best_kept = np.ones(count.max(), np.bool_)
    for form in range(first.size):
        p, begin = count[form], first[form]
        part = slice(begin, begin + p)
        seen = square[part, :p] - cross[part] @ covariance @ cross[part].T
        every = np.ones(p, np.bool_)
        gain, reach, size = -np.inf, -np.inf, 1.0
        wide = amplitude_sd[part].copy()
        for one in sizes if law[part].any() else sizes[:1]:
            here = np.where(law[part], one * amplitude_sd[part], amplitude_sd[part])
            now, fits = _weigh(seen, direct[part], here, positive[part], every)
            if now > gain or not np.isfinite(gain):
                gain, reach, size, wide = now, fits, one, here
        kept = every
        half_normal = np.log(2.0) * positive[part].sum()
        if reach + half_normal > best:  # without what its places cost it could lead
            gain, kept = _drop_places(seen, direct[part], wide, positive[part], place[part], gain)
        if gain > best:
            best, best_size, best_form = gain, size, form
            best_kept[:p] = kept
    return best, best_size, best_form, best_kept


@compiled
def _drop_places(
    seen: NDArray, direct: NDArray, wide: NDArray, positive: NDArray, place: NDArray, gain: float
) -> tuple[float, NDArray]:
    """Drop a form's places while it gains.

    Returns the gain, and the columns that are kept.
    """
    kept = np.ones(direct.size, np.bool_)
    while True:
        most, without = gain, -1
        for one in range(place.max() + 1):
            fewer = kept & (place != one)
            if 0 < fewer.sum() < kept.sum():
                now, _ = _weigh(seen, direct, wide, positive, fewer)
                if now > most:
                    most, without = now, one
        if without < 0:
            return gain, kept
        gain, kept = most, kept & (place != without)


@compiled
def _weigh(
    seen: NDArray, direct: NDArray, wide: NDArray, positive: NDArray, kept: NDArray
) -> tuple[float, float]:
    """Gain [nats] of some amplitudes.

    Also what it would be if they cost nothing.
    """
    at = np.flatnonzero(kept)
    hessian = np.empty((at.size, at.size))
    pull, volume = np.empty(at.size), 0.0
    for a in range(at.size):
        pull[a] = direct[at[a]]
        volume += 2.0 * math.log(wide[at[a]])
        for b in range(at.size):
            hessian[a, b] = seen[at[a], at[b]]
        hessian[a, a] += wide[at[a]] ** -2.0
    inside = np.linalg.inv(hessian)
    mean = inside @ pull
    fits = 0.5 * (mean @ pull)
    gain = fits - 0.5 * (np.linalg.slogdet(hessian)[1] + volume)
    for a in range(at.size):
        if positive[at[a]]:
            share = math.erfc(-mean[a] / math.sqrt(2.0 * max(inside[a, a], 1e-300)))
            gain += math.log(max(share, 1e-300))
    return (gain if np.isfinite(gain) else -np.inf), fits


@compiled
def _take_up(
    squares: Squares, product: NDArray, first: NDArray, count: NDArray, omega: NDArray
) -> tuple[NDArray, NDArray, NDArray]:
    """What is left of columns beside every trial's η.

    Their products with ∂F/∂μ and with z, and each form's columns with one another.
    """
    d, size = omega.shape[0], squares.side.shape[1]
    inverse = np.linalg.inv(omega)
    cross, direct, square = np.zeros((size, d)), np.zeros(size), squares.form.copy()
    for i in range(product.shape[0]):
        side = squares.side[i]
        taken = side @ invert_scaled(inverse + squares.own[i])
        cross += side - taken @ squares.own[i]
        direct += product[i, d:] - taken @ product[i, :d]
        for form in range(first.size):
            begin = first[form]
            for a in range(begin, begin + count[form]):
                for b in range(begin, begin + count[form]):
                    left = 0.0
                    for c in range(d):
                        left += taken[a, c] * side[b, c]
                    square[a, b - begin] -= left
    return cross, direct, square
