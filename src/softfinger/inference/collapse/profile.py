"""Least squares of a joint for every rate.

The problem of one trial is linear but for x = log(k_v/c_v).

Given x, the motion a e(t; x) + b ∫u dt + q is linear in (a, b, q) = (1/k_v, 1/c_p, q_ini); what is
left of the squares is a function of x alone (variable projection). It is searched on a grid over
the whole table of rates and then on ever finer grids around the best, so no start is needed.

References
----------
Golub, Pereyra (1973), SIAM J. Numer. Anal. 10, 413, doi:10.1137/0710036.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.inference.budget import BUDGET
from softfinger.inference.collapse.basis import ElasticTable, fill_coefficients
from softfinger.inference.collapse.table import Collapse

RIDGE = 1e-13  # relative; curves that look alike share their amplitude


class Profile(NamedTuple):
    """Best rate of each trial.

    Also the linear coefficients there, and the squares left over.
    """

    log_rate: NDArray[np.float64]  # (trial,)
    linear: NDArray[np.float64]  # (trial, 3): 1/k_v, 1/c_p, q_ini
    rss: NDArray[np.float64]  # (trial,)


def build_joint_gram(
    collapse: Collapse, joint: int, sd: float = 1.0, autocorrelation: float = 0.0
) -> NDArray[np.float64]:
    """Build the Gram matrices of one joint alone.

    ΨᵀR⁻¹Ψ (trial, M + 3, M + 3), with Ψ = [U, ∫u, 1, y].

    Parameters
    ----------
    joint
        Index from 0.
    sd, autocorrelation
        Noise of that joint; the defaults give plain sums of squares.
    """
    modes = collapse.table.value.shape[1]
    pick = np.r_[: modes + 2, modes + 2 + joint]
    some = np.ix_(range(len(collapse.first)), pick, pick)
    first = collapse.first[:, pick]
    gram = np.einsum("ia,ib->iab", first, first) / sd**2
    for node, gap in enumerate(collapse.gap):
        kept = autocorrelation**gap
        now, before, cross = (collapse.products[:, node, part][some] for part in range(3))
        gained = now - kept * (cross + cross.transpose(0, 2, 1)) + kept**2 * before
        gram += gained / (sd**2 * (1 - kept**2))
    return gram


def profile_rates(gram: NDArray[np.float64], table: ElasticTable) -> Profile:
    """Find the rate of least squares of each trial.

    Parameters
    ----------
    gram
        (trial, M + 3, M + 3) of `build_joint_gram`.
    table
        The coefficients c(x).
    """
    low, high = table.nodes[[0, -1]]
    offset = np.linspace(0.0, high - low, BUDGET.profile_grid)
    best = np.full(len(gram), low)
    for _ in range(BUDGET.profile_zooms + 1):
        rss = solve_linear_array(gram, best[:, None] + offset, table)[1]
        best += offset[rss.argmin(axis=1)]
        width = offset[1] - offset[0]
        offset = np.linspace(-width, width, 2 * BUDGET.profile_zoom + 1)
    linear, rss = solve_linear_array(gram, best[:, None], table)
    return Profile(best, linear[:, 0], rss[:, 0])


def solve_linear_array(
    gram: NDArray[np.float64], log_rate: NDArray[np.float64], table: ElasticTable
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Solve for (1/k_v, 1/c_p, q_ini) at given rates.

    Parameters
    ----------
    gram
        (trial, M + 3, M + 3).
    log_rate
        (trial, rate) x [log 1/s].

    Returns
    -------
    linear, rss : (trial, rate, 3) and (trial, rate).
    """
    gram, log_rate = np.ascontiguousarray(gram), np.ascontiguousarray(log_rate)
    normal = _reduce(gram, log_rate, *table)
    size = np.sqrt(np.einsum("...kk->...k", normal[..., :3, :3])) + 1e-300
    scaled = normal[..., :3, :3] / (size[..., :, None] * size[..., None, :])
    right = normal[..., :3, 3] / size
    solution = np.linalg.solve(scaled + RIDGE * np.eye(3), right[..., None])[..., 0]
    fitted = np.einsum("...ab,...b->...a", scaled, solution)
    rss = normal[..., 3, 3] + ((fitted - 2 * right) * solution).sum(axis=-1)
    return solution / size, rss


@compiled(error_model="numpy")
def _reduce(
    gram: NDArray,
    log_rate: NDArray,
    place: NDArray,
    value: NDArray,
    slope: NDArray,
) -> NDArray:
    """Gram matrices of [e(x), ∫u, 1, y].

    (trial, rate, 4, 4).
    """
    modes = value.shape[1]
    reduced = np.empty((*log_rate.shape, 4, 4))
    last = value.shape[0] - 1
    curve, unused = np.empty(modes), np.empty(modes)
    for i in range(log_rate.shape[0]):
        for r in range(log_rate.shape[1]):
            fill_coefficients(log_rate[i, r], place, value, slope, 0, last, modes, curve, unused)
            moved = curve @ gram[i, :modes]
            reduced[i, r, 0, 0] = moved[:modes] @ curve
            reduced[i, r, 0, 1:] = moved[modes:]
            reduced[i, r, 1:, 0] = moved[modes:]
            reduced[i, r, 1:, 1:] = gram[i, modes:, modes:]
    return reduced
