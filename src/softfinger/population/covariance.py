"""The covariance of noise of neighbouring joints over any gap between frames.

Over one median interval the noise of joint j keeps the share ρ_j and gets an innovation of sd
σ_j √(1 − ρ_j²); innovations of joints j and k have correlation C_jk. Over g intervals

    ε_j(t + g) = ρ_j^g ε_j(t) + w_j,
    cov(w_j, w_k) = σ_j σ_k C_jk √((1 − ρ_j²)(1 − ρ_k²)) (1 − (ρ_j ρ_k)^g) / (1 − ρ_j ρ_k)

and g = ∞ gives the stationary covariance; σ_j is the marginal sd. Between whole numbers of
intervals the same formula holds as an interpolation.
"""

import numpy as np
from numpy.typing import NDArray


def compute_innovation_covariance_array(
    gap: float,
    sd: NDArray[np.float64],
    autocorrelation: NDArray[np.float64],
    correlation: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Compute the covariance (joint, joint) [rad²] of what noise gains over a gap.

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
