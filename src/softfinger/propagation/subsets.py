"""What sets of parameters explain of the variance.

v(u) = Var(E[q | x_u])/Var(q) is the share that knowing the parameters u would explain. All indices
are sums of such shares: the first-order index of i is v(i), its total index 1 − v(all but i), the
second-order index of a pair v(ij) − v(i) − v(j), and the Shapley effect of i is the mean, over all
orders in which parameters may become known, of what i adds to v. A parameter is that of all joints
together. Where parameters are correlated, v(i) also contains what goes with i; the total index
contains only what i adds when all others are known. A second-order index is negative where two
parameters explain the same. The Shapley effects sum to 1 all the same; without correlation they are
S_i plus half of each interaction.

References
----------
Sobol' (1993), Mathematical Modelling and Computational Experiments 1, 407.
Owen (2014), SIAM/ASA J. Uncertainty Quantification 2, 245, doi:10.1137/130936233.
Owen, Prieur (2017), SIAM/ASA J. Uncertainty Quantification 5, 986, doi:10.1137/16M1097717.
"""

from collections.abc import Mapping
from itertools import combinations
from math import factorial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.mechanics import PARAMETERS

Subset = tuple[int, ...]
Shares = Mapping[Subset, NDArray[np.float64]]
"""Set of parameters → share of the variance that they explain, (…)."""

EVERY = tuple(range(len(PARAMETERS)))
SUBSETS: list[Subset] = [u for size in EVERY for u in combinations(EVERY, size + 1)]
PAIRS = tuple(combinations(EVERY, 2))
PAIR_NAMES = tuple(f"{PARAMETERS[i]}:{PARAMETERS[j]}" for i, j in PAIRS)


class SobolIndices(NamedTuple):
    """Indices (…, 4); pairs (…, 6) as `PAIR_NAMES`."""

    first_order: NDArray[np.float64]
    total: NDArray[np.float64]
    second_order: NDArray[np.float64]


def leave_out(parameter: int) -> Subset:
    """All parameters but one."""
    return tuple(other for other in EVERY if other != parameter)


def compute_sobol_indices(shares: Shares) -> SobolIndices:
    """Compute first-order, total and second-order indices."""
    first = np.stack([shares[i,] for i in EVERY], axis=-1)
    total = np.stack([1.0 - shares[leave_out(i)] for i in EVERY], axis=-1)
    second = np.stack([shares[i, j] - shares[i,] - shares[j,] for i, j in PAIRS], axis=-1)
    return SobolIndices(first, np.maximum(total, 0.0), second)


def compute_shapley_effects(shares: Shares) -> NDArray[np.float64]:
    """Compute the Shapley effect (…, 4) of each parameter.

    Examples
    --------
    Two of four parameters explain everything, and are always correlated:

    >>> shares = {u: np.array(float(0 in u or 1 in u)) for u in SUBSETS}
    >>> compute_shapley_effects(shares)
    array([0.5, 0.5, 0. , 0. ])
    """
    effect = np.zeros((*shares[EVERY].shape, len(EVERY)))
    for subset, share in shares.items():
        weight = factorial(len(subset) - 1) * factorial(4 - len(subset)) / factorial(4)
        for player in subset:
            before = tuple(other for other in subset if other != player)
            effect[..., player] += weight * (share - (shares[before] if before else 0.0))
    return np.maximum(effect, 0.0)
