"""Covariance of neighbouring joints' noise over any gap.

Over one median interval the noise of joint j keeps the share ρ_j and gets an innovation of sd
σ_j √(1 − ρ_j²); innovations of joints j and k have correlation C_jk. Over g intervals

    ε_j(t + g) = ρ_j^g ε_j(t) + w_j,
    cov(w_j, w_k) = s_jk (1 − (ρ_j ρ_k)^g),
    s_jk = σ_j σ_k C_jk √((1 − ρ_j²)(1 − ρ_k²)) / (1 − ρ_j ρ_k)

and g = ∞ gives the stationary covariance s; σ_j is the marginal sd. Between whole numbers of
intervals the same formula interpolates.

C is written by its canonical partial correlations z, row by row below the diagonal:
C = L Lᵀ, L_jk = z_jk ∏_{m<k} √(1 − z_jm²), L_jj = ∏_{m<j} √(1 − z_jm²). Any z in (−1, 1) will do.

References
----------
Lewandowski, Kurowicka, Joe (2009), J. Multivariate Anal. 100, 1989,
doi:10.1016/j.jmva.2009.04.008.
"""

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled


def compute_innovation_covariance_array(
    gap: float,
    sd: NDArray[np.float64],
    autocorrelation: NDArray[np.float64],
    correlation: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Compute what the noise's covariance gains over a gap.

    It is (joint, joint) [rad²].

    Parameters
    ----------
    gap
        In median frame intervals; ∞ for the stationary covariance.
    sd, autocorrelation
        (joint,) σ [rad] and ρ in [0, 1).
    correlation
        (joint, joint) C of the innovations.

    Examples
    --------
    >>> one = np.ones(1)
    >>> compute_innovation_covariance_array(1.0, 2 * one, 0.6 * one, one[:, None]).round(6)
    array([[2.56]])
    """
    spread = sd * np.sqrt(1.0 - autocorrelation**2)
    kept = np.outer(autocorrelation, autocorrelation)
    return np.outer(spread, spread) * correlation * (1.0 - kept**gap) / (1.0 - kept)


def correlate_partials_array(partial: NDArray[np.float64]) -> NDArray[np.float64]:
    """Build C (…, joint, joint) from partials (…, pair).

    >>> correlate_partials_array(np.array([-0.5]))
    array([[ 1. , -0.5],
           [-0.5,  1. ]])
    """
    partial = np.asarray(partial, float)
    flat = partial.reshape(int(np.prod(partial.shape[:-1])), partial.shape[-1])
    correlation = np.stack([_multiply_factor(factorise_partials(row)) for row in flat])
    return correlation.reshape(*partial.shape[:-1], *correlation.shape[1:])


def _multiply_factor(factor: NDArray) -> NDArray:
    return factor @ factor.T


@compiled(error_model="numpy")
def factorise_partials(partial: NDArray) -> NDArray:
    """Build L (joint, joint) from partial correlations (pair,)."""
    joints = (1 + int(np.sqrt(1 + 8 * partial.size))) // 2
    factor = np.zeros((joints, joints))
    pair = 0
    for j in range(joints):
        left = 1.0
        for k in range(j):
            factor[j, k] = partial[pair] * left
            left *= np.sqrt(1.0 - partial[pair] ** 2)
            pair += 1
        factor[j, j] = left
    return factor


@compiled(error_model="numpy")
def pull_factor_back(partial: NDArray, factor: NDArray, factor_bar: NDArray) -> NDArray:
    """Slope by the partials (pair,) from that by L.

    The slope by L is (joint, joint).
    """
    joints = factor.shape[0]
    bar = np.empty(partial.size)
    pair = partial.size
    for j in range(joints - 1, 0, -1):
        after = factor_bar[j, j] * factor[j, j]  # Σ over later columns of L̄ L
        for k in range(j - 1, -1, -1):
            pair -= 1
            z = partial[pair]
            before = 1.0
            for m in range(k):
                before *= np.sqrt(1.0 - partial[pair - k + m] ** 2)
            bar[pair] = factor_bar[j, k] * before - after * z / (1.0 - z * z)
            after += factor_bar[j, k] * factor[j, k]
    return bar
