"""Shapley effects of correlated parameters over time, exact for the paper's joint under any load.

When parameters are correlated, the variance no longer splits into Sobol indices. With the value
v(u) = Var(E[q | x_u]) of knowing the parameters u, the Shapley effect of a parameter is the mean,
over all orders in which parameters may become known, of what it adds to v, over Var(q): never
negative, and they sum to 1. Without correlation it is S_i plus half of each interaction.

Let x and x′ be two copies of (log k_v, log c_v, log c_p, q_ini) ~ N(μ, Σ) that share x_u and are
independent otherwise: Cov(x, x′) = M = Σ_·u Σ_uu⁻¹ Σ_u·, and v(u) = Cov(q(x), q(x′)). Weighing by
1/(k_v k_v′) or 1/c_p′ shifts means only, so that the terms of v(u) are closed forms or integrals
over log(k_v/c_v), where the two log-rates, given their shared part, are independent:
E[e(r) e(r′)] = E_y[g(y)²], g(y) = E[e | y].

References
----------
Owen (2014), SIAM/ASA J. Uncertainty Quantification 2, 245, doi:10.1137/130936233.
Owen, Prieur (2017), SIAM/ASA J. Uncertainty Quantification 5, 986, doi:10.1137/16M1097717.
"""

from itertools import combinations
from math import factorial

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from softfinger.faults import Fault
from softfinger.mechanics.load import integrate_load_array
from softfinger.mechanics.three_element import compute_elastic_basis_array
from softfinger.propagation.moments import C_P, K_V, Q_INI
from softfinger.propagation.quadrature import REACH, compute_log_step, compute_normal_weights

NARROWEST = 0.01  # log-rates that vary by less than this are taken as known
LOG_RATE = np.array([1.0, -1.0, 0.0, 0.0])  # log(k_v/c_v) = LOG_RATE · x
SUBSETS = [subset for size in range(1, 5) for subset in combinations(range(4), size)]


def compute_shapley_array(
    mu: ArrayLike,
    covariance: ArrayLike,
    time: ArrayLike,
    load_time: ArrayLike,
    load_torque: ArrayLike,
) -> NDArray[np.float64]:
    """Compute the Shapley effects of the parameters on the variance of the joint angle.

    Parameters
    ----------
    mu
        (…, 4) in the order k_v, c_v, c_p (of their logs), q_ini [rad]; NaN gives NaN.
    covariance
        (…, 4, 4), positive definite.
    time
        (n,) [s].
    load_time, load_torque
        (knot,) [s], [N m].

    Returns
    -------
    (…, n, 4)

    Raises
    ------
    Fault
        If a covariance is not positive definite.

    Examples
    --------
    Before the load has acted only the initial angle varies; a parameter that goes with it half the
    way shares its effect:

    >>> covariance = np.diag([0.04, 0.25, 0.49, 1e-4])
    >>> covariance[2, 3] = covariance[3, 2] = 0.5 * 0.7 * 0.01
    >>> compute_shapley_array(
    ...     [-2.4, -3.7, 2.9, 0.02], covariance, [0.0], [0.0], [0.04]).round(6)
    array([[0.   , 0.   , 0.125, 0.875]])
    """
    mu, covariance, time = (np.asarray(a, float) for a in (mu, covariance, time))
    lead = mu.shape[:-1]
    mu, covariance = mu.reshape(-1, 4), covariance.reshape(-1, 4, 4)
    known = np.isfinite(mu).all(axis=1) & np.isfinite(covariance).all(axis=(1, 2))
    least = np.linalg.eigvalsh(covariance[known]).min(initial=np.inf)
    if least <= 0:
        raise Fault(
            f"a covariance of k_v, c_v, c_p and q_ini has the eigenvalue {least:g}: "
            "it must be positive definite"
        )
    effects = np.full((len(mu), time.size, 4), np.nan)
    if known.any():
        impulse = integrate_load_array(time, load_time, load_torque)
        lattice = _space_lattice(mu[known], covariance[known])
        table = compute_elastic_basis_array(np.exp(lattice), time, load_time, load_torque)[0]
        for row in np.flatnonzero(known):
            values = {
                subset: _compute_value(mu[row], covariance[row], subset, lattice, table, impulse)
                for subset in SUBSETS
            }
            effects[row] = _average_orders(values)
    return effects.reshape(*lead, time.size, 4)


def _compute_value(
    mu: NDArray,
    covariance: NDArray,
    subset: tuple[int, ...],
    lattice: NDArray,
    table: NDArray,
    impulse: NDArray,
) -> NDArray[np.float64]:
    """v(u) = Cov(q(x), q(x′)) for copies that share the parameters u: (n,) [rad²]."""
    u = list(subset)
    shared = covariance[:, u] @ np.linalg.solve(covariance[np.ix_(u, u)], covariance[u])
    own_rate, shared_rate = covariance @ LOG_RATE, shared @ LOG_RATE  # with every parameter
    rate = LOG_RATE @ mu
    spread = np.sqrt(LOG_RATE @ own_rate)
    k_mean = np.exp(-mu[K_V] + covariance[K_V, K_V] / 2)
    flow = impulse * np.exp(-mu[C_P] + covariance[C_P, C_P] / 2)

    def lagged_mean(shift: float) -> NDArray:
        return compute_normal_weights(lattice, rate + shift, spread) @ table

    alone = lagged_mean(-own_rate[K_V])
    elastic = k_mean * alone
    tilted = rate - own_rate[K_V] - shared_rate[K_V]
    square = _square_shared(lattice, table, tilted, spread, np.sqrt(max(LOG_RATE @ shared_rate, 0)))
    value = k_mean**2 * np.exp(shared[K_V, K_V]) * square - elastic**2
    value += flow**2 * np.expm1(shared[C_P, C_P]) + shared[Q_INI, Q_INI]
    with_flow = np.exp(shared[K_V, C_P]) * lagged_mean(-own_rate[K_V] - shared_rate[C_P])
    value += 2 * k_mean * flow * (with_flow - alone)
    weight = compute_normal_weights(lattice, rate - own_rate[K_V], spread)
    slope = (weight * (lattice - rate + own_rate[K_V])) @ table / spread**2
    value += 2 * k_mean * (shared_rate[Q_INI] * slope - shared[Q_INI, K_V] * alone)
    return value - 2 * flow * shared[Q_INI, C_P]


def _square_shared(
    lattice: NDArray, table: NDArray, centre: float, spread: float, shared: float
) -> NDArray[np.float64]:
    """E_y[g(y)²] (n,) for log-rates of sd `spread` that have a part of sd `shared` in common."""
    own = np.sqrt(max(spread**2 - shared**2, 0.0))
    if own < NARROWEST:
        return compute_normal_weights(lattice, centre, spread) @ table**2
    if shared < NARROWEST:
        return (compute_normal_weights(lattice, centre, spread) @ table) ** 2
    step = float(compute_log_step(shared))
    half = int(REACH * shared / step) + 1
    y = step * np.arange(-half, half + 1)
    weight = compute_normal_weights(y, 0.0, shared)
    return _average_squares(lattice, table, centre + y, weight, own)


@njit(cache=True)
def _average_squares(
    lattice: NDArray, table: NDArray, centre: NDArray, weight: NDArray, sd: float
) -> NDArray:
    """Σ_i weight_i (mean of the table's rows under N(centre_i, sd²))²: (n,).

    Not by a matrix product: there are thousands of these, too small for a threaded library.
    """
    n = table.shape[1]
    square = np.zeros(n)
    for i in range(centre.size):
        given = np.zeros(n)
        total = 0.0
        first = np.searchsorted(lattice, centre[i] - REACH * sd)
        last = np.searchsorted(lattice, centre[i] + REACH * sd)
        for m in range(first, last):
            z = (lattice[m] - centre[i]) / sd
            mass = np.exp(-0.5 * z * z)
            total += mass
            for t in range(n):
                given[t] += mass * table[m, t]
        scale = weight[i] / total**2
        for t in range(n):
            square[t] += scale * given[t] * given[t]
    return square


def _space_lattice(mu: NDArray, covariance: NDArray) -> NDArray[np.float64]:
    """Log-rates fine and wide enough for every population and subset."""
    rate = mu @ LOG_RATE
    with_rate = covariance @ LOG_RATE
    variance = with_rate @ LOG_RATE
    narrowest = np.sqrt(variance.min())
    for subset in SUBSETS[:-1]:
        u = list(subset)
        inner = np.linalg.solve(covariance[:, u][:, :, u], with_rate[:, u, None])[..., 0]
        left = np.sqrt(np.maximum(variance - (with_rate[:, u] * inner).sum(axis=1), 0.0))
        narrowest = min(narrowest, left[left >= NARROWEST].min(initial=np.inf))
    shift = 2 * np.abs(with_rate[:, [K_V, C_P]]).max()
    reach = (REACH + 1) * np.sqrt(variance.max()) + shift  # a shared part may reach a step more
    step = float(compute_log_step(narrowest))
    low, high = rate.min() - reach, rate.max() + reach
    return low + step * np.arange(int((high - low) / step) + 2)


def _average_orders(values: dict[tuple[int, ...], NDArray]) -> NDArray[np.float64]:
    """Shapley effects (n, 4) from v(u) (n,) of every subset u but the empty one."""
    whole = values[SUBSETS[-1]]
    effect = np.zeros((whole.size, 4))
    for subset, value in values.items():
        weight = factorial(len(subset) - 1) * factorial(4 - len(subset)) / factorial(4)
        for player in subset:
            before = tuple(other for other in subset if other != player)
            effect[:, player] += weight * (value - (values[before] if before else 0.0))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.maximum(effect, 0.0) / whole[:, None]
