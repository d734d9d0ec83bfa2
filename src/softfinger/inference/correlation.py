"""Which parameters of a trial are correlated over trials.

None, those of one joint, or all.

The parameters of a trial, joint after joint, have the covariance Ω = D R D, D = diag σ. R is
written by its canonical partial correlations (`covariance`), row by row below the diagonal. Those
between joints are 0 where only a joint's own parameters may be correlated; this leaves R in blocks.
R, or each block, has the density of LKJ(2).
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.priors import PRIORS
from softfinger.measurement.covariance import correlate_partials_array
from softfinger.mechanics import OWN

Covariance = Literal["independent", "joint", "full"]


def mark_free_partials(joints: int, covariance: Covariance) -> NDArray[np.bool_]:
    """Mark the partial correlations (pair,) that are free.

    >>> [int(mark_free_partials(3, kind).sum()) for kind in ("independent", "joint", "full")]
    [0, 18, 66]
    """
    row, column = np.tril_indices(OWN * joints, -1)
    return {
        "independent": np.zeros(len(row), bool),
        "joint": row // OWN == column // OWN,
        "full": np.ones(len(row), bool),
    }[covariance]


def shape_partials(size: int) -> NDArray[np.float64]:
    """Beta shape α (pair,) of each partial correlation.

    (1 + z)/2 of each partial is Beta(α, α) where C is LKJ(2).

    >>> shape_partials(3)
    array([2.5, 2.5, 2. ])
    """
    column = np.tril_indices(size, -1)[1]
    return PRIORS.lkj_shape + (size - 2 - column) / 2


def shape_free_partials(joints: int, covariance: Covariance) -> NDArray[np.float64]:
    """Beta shape α of each free partial correlation."""
    if covariance == "joint":
        return np.tile(shape_partials(OWN), joints)
    return shape_partials(OWN * joints)[mark_free_partials(joints, covariance)]


def correlate_free_partials_array(
    partial: NDArray[np.float64], joints: int, covariance: Covariance
) -> NDArray[np.float64]:
    """Build R (…, p, p) from free partials.

    They are (…, free).
    """
    free = mark_free_partials(joints, covariance)
    whole = np.zeros((*partial.shape[:-1], len(free)))
    whole[..., free] = partial
    return np.clip(correlate_partials_array(whole), -1.0, 1.0)  # the diagonal, rounded


def invert_covariance_array(
    sigma: NDArray[np.float64], correlation: NDArray[np.float64] | None
) -> NDArray[np.float64]:
    """Invert Ω (p, p), given by σ and R.

    σ (p,) are the parameters' sds; R (p, p) is their correlation, none for None.

    >>> invert_covariance_array(np.array([1.0, 0.5]), None)
    array([[1., 0.],
           [0., 4.]])
    """
    if correlation is None:
        return np.diag(sigma**-2.0)
    return np.linalg.inv(correlation) / np.outer(sigma, sigma)
