"""Exact mean and variance of joints with correlated parameters.

With the value v(u) = Var(E[q | x_u]) of knowing the parameters u (at all joints): let x and x′ be
two copies of (log k_v, log c_v, log c_p, q_ini) of all joints ~ N(μ, Σ) that share x_u and are
independent otherwise: Cov(x, x′) = M = Σ_·u Σ_uu⁻¹ Σ_u·, and v(u) = Cov(q(x), q(x′)). Weighing by
1/(k_v k_v′) or 1/c_p′ shifts means only, so that the terms of v(u) are closed forms or integrals
over log(k_v/c_v), where the two log-rates, given their shared part, are independent:
E[e(r) e(r′)] = E_y[g(y)²], g(y) = E[e | y]. Any load will do.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softfinger.compiled import compiled
from softfinger.faults import Fault
from softfinger.mechanics.load import integrate_load_array
from softfinger.mechanics.three_element import compute_elastic_basis_array
from softfinger.propagation.moments import C_P, K_V, Q_INI
from softfinger.propagation.quadrature import REACH, compute_log_step, compute_normal_weights
from softfinger.propagation.subsets import EVERY, SUBSETS, Subset

NARROWEST = 0.01  # log-rates that vary by less than this are taken as known
LOG_RATE = np.array([1.0, -1.0, 0.0, 0.0])  # log(k_v/c_v) = LOG_RATE · x


class Joint(NamedTuple):
    """One joint, with its elastic part tabulated.

    mu (4,); covariance (4, 4); lattice (m,); table (m, n); impulse (n,) [N m s].
    """

    mu: NDArray[np.float64]
    covariance: NDArray[np.float64]
    lattice: NDArray[np.float64]
    table: NDArray[np.float64]
    impulse: NDArray[np.float64]


def compute_values_array(
    mu: ArrayLike,
    covariance: ArrayLike,
    time: ArrayLike,
    load_time: ArrayLike,
    load_torque: ArrayLike,
    subsets: list[Subset] = SUBSETS,
) -> tuple[NDArray[np.float64], dict[Subset, NDArray[np.float64]]]:
    """Compute mean angles, and variance that sets explain.

    Parameters
    ----------
    mu
        (joint, 4) in the order k_v, c_v, c_p (of their logs), q_ini [rad].
    covariance
        (4 · joint, 4 · joint), positive definite.
    time
        (n,) [s].
    load_time, load_torque
        (knot,) [s], [N m].
    subsets
        Sets of parameters, each at all joints.

    Returns
    -------
    mean (joint, n) [rad], and for every set v(u) (joint, n) [rad²]; that of all parameters is the
    variance.

    Raises
    ------
    Fault
        If the covariance is not positive definite.

    Examples
    --------
    Before the load has acted only the initial angle varies:

    >>> mean, value = compute_values_array(
    ...     [[-2.4, -3.7, 2.9, 0.02]], np.diag([0.04, 0.25, 0.49, 1e-4]), [0.0], [0.0], [0.04])
    >>> mean, value[0, 1], value[3,]
    (array([[0.02]]), array([[0.]]), array([[0.0001]]))
    """
    mu, covariance, time = (np.asarray(a, float) for a in (mu, covariance, time))
    sd = np.sqrt(np.diag(covariance))
    least = np.linalg.eigvalsh(covariance / np.outer(sd, sd)).min()
    if not least > 0:
        raise Fault(
            f"a correlation of k_v, c_v, c_p and q_ini has the eigenvalue {least:g}: "
            "it must be positive definite"
        )
    load = (load_time, load_torque)
    impulse = integrate_load_array(time, *load)
    shared = {subset: _share_covariance(covariance, subset) for subset in subsets}
    means, values = [], []
    for place, own in enumerate(mu):
        block = slice(4 * place, 4 * place + 4)
        parts = {subset: matrix[block, block] for subset, matrix in shared.items()}
        lattice = _space_lattice(own, covariance[block, block], list(parts.values()))
        table = compute_elastic_basis_array(np.exp(lattice), time, *load)[0]
        joint = Joint(own, covariance[block, block], lattice, table, impulse)
        means.append(_compute_mean(joint))
        values.append({subset: _compute_value(joint, part) for subset, part in parts.items()})
    return np.stack(means), {u: np.stack([value[u] for value in values]) for u in subsets}


def _share_covariance(covariance: NDArray, subset: Subset) -> NDArray[np.float64]:
    """M, the covariance shared through parameters u."""
    if subset == EVERY:
        return covariance
    u = np.flatnonzero(np.isin(np.arange(len(covariance)) % len(EVERY), subset))
    return covariance[:, u] @ np.linalg.solve(covariance[np.ix_(u, u)], covariance[u])


def _average_elastic(joint: Joint, shift: float) -> NDArray[np.float64]:
    """Mean (n,) of e(r), log-rate shifted by `shift`."""
    spread = np.sqrt(LOG_RATE @ joint.covariance @ LOG_RATE)
    return compute_normal_weights(joint.lattice, LOG_RATE @ joint.mu + shift, spread) @ joint.table


def _average_compliance(joint: Joint, parameter: int) -> float:
    """Mean of 1/k_v or 1/c_p."""
    return np.exp(-joint.mu[parameter] + joint.covariance[parameter, parameter] / 2)


def _compute_mean(joint: Joint) -> NDArray[np.float64]:
    """Mean (n,) [rad] of the angle."""
    alone = _average_elastic(joint, -(joint.covariance @ LOG_RATE)[K_V])
    flow = joint.impulse * _average_compliance(joint, C_P)
    return _average_compliance(joint, K_V) * alone + flow + joint.mu[Q_INI]


def _compute_value(joint: Joint, shared: NDArray[np.float64]) -> NDArray[np.float64]:
    """v(u) (n,) [rad²] of a shared covariance.

    It is Cov(q(x), q(x′)) for copies with the covariance `shared`.
    """
    own_rate, shared_rate = joint.covariance @ LOG_RATE, shared @ LOG_RATE
    lattice, table, rate = joint.lattice, joint.table, LOG_RATE @ joint.mu
    spread = np.sqrt(LOG_RATE @ own_rate)
    k_mean = _average_compliance(joint, K_V)
    flow = joint.impulse * _average_compliance(joint, C_P)
    alone = _average_elastic(joint, -own_rate[K_V])
    tilted = rate - own_rate[K_V] - shared_rate[K_V]
    square = _square_shared(lattice, table, tilted, spread, np.sqrt(max(LOG_RATE @ shared_rate, 0)))
    value = k_mean**2 * (np.exp(shared[K_V, K_V]) * square - alone**2)
    value += flow**2 * np.expm1(shared[C_P, C_P]) + shared[Q_INI, Q_INI]
    with_flow = _average_elastic(joint, -own_rate[K_V] - shared_rate[C_P])
    value += 2 * k_mean * flow * (np.exp(shared[K_V, C_P]) * with_flow - alone)
    weight = compute_normal_weights(lattice, rate - own_rate[K_V], spread)
    slope = (weight * (lattice - rate + own_rate[K_V])) @ table / spread**2
    value += 2 * k_mean * (shared_rate[Q_INI] * slope - shared[Q_INI, K_V] * alone)
    return value - 2 * flow * shared[Q_INI, C_P]


def _square_shared(
    lattice: NDArray, table: NDArray, centre: float, spread: float, shared: float
) -> NDArray[np.float64]:
    """E_y[g(y)²] (n,) of partly shared log-rates.

    Their sd is `spread`; the part of sd `shared` is in common.
    """
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


@compiled
def _average_squares(
    lattice: NDArray, table: NDArray, centre: NDArray, weight: NDArray, sd: float
) -> NDArray:
    """Weighted mean of squared averages: (n,).

    It is Σ_i weight_i (mean of the table's rows under N(centre_i, sd²))². Not by a matrix product:
    there are thousands of these, too small for a threaded library.
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


def _space_lattice(mu: NDArray, covariance: NDArray, shared: list[NDArray]) -> NDArray[np.float64]:
    """Log-rates fine and wide enough for all."""
    with_rate = covariance @ LOG_RATE
    variance = LOG_RATE @ with_rate
    common = np.array([LOG_RATE @ part @ LOG_RATE for part in shared])
    left = np.sqrt(np.maximum(variance - common, 0.0))
    narrowest = min(np.sqrt(variance), left[left >= NARROWEST].min(initial=np.inf))
    shift = 2 * np.abs(with_rate[[K_V, C_P]]).max()
    reach = (REACH + 1) * np.sqrt(variance) + shift  # a shared part may reach a step more
    step = float(compute_log_step(narrowest))
    return LOG_RATE @ mu - reach + step * np.arange(int(2 * reach / step) + 2)
