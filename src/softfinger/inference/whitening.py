"""Parameters of a trial as standard normals.

The population is given. NUTS needs this geometry.

With the likelihood's normal stand-in (curvature H, pull b; `laplace`) and the population N(μ, Ω),
the trial's parameters are about normal with precision Λ = H + Ω⁻¹ and mean Λ⁻¹(b + Ω⁻¹μ). So

    Λ = R Rᵀ,   η = R⁻ᵀ y,   y = R⁻¹ (b + Ω⁻¹ μ) + z,   log|∂η/∂z| = −Σ log R_aa

makes z about standard normal whatever the population is: trials that the data fix stay where they
are (centred), trials that the data leave open move with μ and scale with σ (non-centred). Effects φ
that differ from those of the stand-in shift its pull, b = b* − C (φ − φ*).

μ itself, given σ, has about the spread that the trials' own values leave it: `place_mean`.

Arrays have the trial last, so that every step runs over all trials side by side; p = 4 J.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.inference.priors import PopulationPrior

LEAST_INFORMATION = 1e-6  # of the prior's
Array = Any  # of numpy or of PyTensor: the formulas are the same


def place_mean(
    prior_mean: Array, prior_sd: Array, sigma: Array, value: Array, variance: Array
) -> tuple[Array, Array]:
    """Place μ, parameter by parameter, given σ.

    It depends on what each trial shows of its own value:

    1/s² = 1/s₀² + Σ 1/(σ² + v_i),   centre = s² (m₀/s₀² + Σ η̂_i/(σ² + v_i))

    Parameters
    ----------
    prior_mean, prior_sd, sigma
        (…, p) m₀, s₀ and σ; arrays or PyTensor variables.
    value, variance
        (p, trial) η̂ and v.

    Returns
    -------
    centre, spread : (…, p).

    Examples
    --------
    One trial, known exactly, half as far from μ as the prior:

    >>> one = np.ones(1)
    >>> centre, spread = place_mean(0 * one, 2 * one, one, np.array([[5.0]]), np.zeros((1, 1)))
    >>> centre, spread**-2
    (array([4.]), array([1.25]))
    """
    weight = 1 / (sigma[..., None] ** 2 + variance)
    precision = prior_sd**-2.0 + weight.sum(axis=-1)
    centre = (prior_mean * prior_sd**-2.0 + (weight * value).sum(axis=-1)) / precision
    return centre, precision**-0.5


def read_trials(
    curvature: NDArray[np.float64], pull: NDArray[np.float64], prior: PopulationPrior
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Value and variance (p, trial) from each trial's stand-in.

    They are what the trial gives by itself for each parameter.

    A prior wide enough for any trial is used, and then taken out again.

    Parameters
    ----------
    curvature, pull
        (p, p, trial) H and (p, trial) b.
    prior
        Of the population.
    """
    joints = len(pull) // len(prior.mu_mean)
    width = np.tile(prior.mu_sd**2 + prior.sigma_median**2, joints)
    covariance = np.linalg.inv(np.moveaxis(curvature, -1, 0) + np.diag(1 / width))
    centre = np.tile(prior.mu_mean, joints) / width
    mean = np.einsum("tab,tb->ta", covariance, pull.T + centre)
    spread = np.einsum("taa->ta", covariance)
    information = np.maximum(1 / spread - 1 / width, LEAST_INFORMATION / width)
    return ((mean / spread - centre) / information).T, (1 / information).T


@compiled(error_model="numpy")
def shift_pull(pull: NDArray, cross: NDArray, change: NDArray) -> NDArray:
    """Pull (p, trial) after effects changed.

    They changed by φ − φ* (e,); `cross` is C (p, e, trial).
    """
    shifted = pull.copy()
    for a in range(pull.shape[0]):
        for k in range(change.size):
            shifted[a] -= change[k] * cross[a, k]
    return shifted


@compiled(error_model="numpy")
def colour_trials(
    z: NDArray, curvature: NDArray, pull: NDArray, mean: NDArray, precision: NDArray
) -> tuple[NDArray, NDArray, NDArray]:
    """Turn standard normals z (p, trial) into parameters.

    Parameters
    ----------
    z
        (p, trial).
    curvature, pull
        (p, p, trial) H and (p, trial) b.
    mean, precision
        (p,) μ and (p, p) Ω⁻¹.

    Returns
    -------
    eta, log_volume, factor : (p, trial), (trial,) log|∂η/∂z| and (p, p, trial) R.
    """
    size = z.shape[0]
    factor = factorise_trials(curvature, precision)
    eta, log_volume = np.empty(z.shape), np.zeros(z.shape[1])
    for a in range(size):
        shift = 0.0
        for b in range(size):
            shift += precision[a, b] * mean[b]
        eta[a] = pull[a] + shift
        for b in range(a):
            _subtract(eta[a], factor[a, b], eta[b])
        eta[a] /= factor[a, a]
        log_volume -= np.log(factor[a, a])
    eta += z
    _solve_transposed(factor, eta)
    return eta, log_volume, factor


@compiled(error_model="numpy")
def factorise_trials(curvature: NDArray, precision: NDArray) -> NDArray:
    """Factorise H + Ω⁻¹ of every trial.

    R is (p, p, trial), its upper half 0.
    """
    size, trials = curvature.shape[0], curvature.shape[2]
    factor = np.zeros((size, size, trials))
    for a in range(size):
        for b in range(a + 1):
            root = factor[a, b]
            root[:] = curvature[a, b] + precision[a, b]
            for c in range(b):
                _subtract(root, factor[a, c], factor[b, c])
            if a == b:
                root[:] = np.sqrt(root)
            else:
                root /= factor[b, b]
    return factor


@compiled(error_model="numpy")
def pull_colours_back(
    eta: NDArray,
    z: NDArray,
    factor: NDArray,
    mean: NDArray,
    precision: NDArray,
    eta_bar: NDArray,
    volume_bar: NDArray,
) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Slopes by z, b, μ and Ω⁻¹.

    They follow from slopes by η (p, trial) and the log volume (trial,).

    ȳ = R⁻¹ η̄ is also z̄; r̄ = R⁻ᵀ ȳ belongs to b + Ω⁻¹μ; R̄ = −η ȳᵀ − r̄ (y − z)ᵀ − diag(v̄ / R_aa).
    """
    size = z.shape[0]
    z_bar = eta_bar.copy()
    for a in range(size):
        for b in range(a):
            _subtract(z_bar[a], factor[a, b], z_bar[b])
        z_bar[a] /= factor[a, a]
    shift_bar = z_bar.copy()
    _solve_transposed(factor, shift_bar)
    factor_bar = np.empty(factor.shape)
    for b in range(size):
        settled = -z[b]  # becomes y − z of parameter b
        for a in range(b, size):
            _subtract(settled, -factor[a, b], eta[a])
        for a in range(b, size):
            factor_bar[a, b] = -eta[a] * z_bar[b] - shift_bar[a] * settled
        factor_bar[b, b] -= volume_bar / factor[b, b]
    precision_bar = _pull_factor_back(factor, factor_bar)
    total = np.empty(size)
    for a in range(size):
        total[a] = shift_bar[a].sum()
    for a in range(size):
        for b in range(size):
            precision_bar[a, b] += total[a] * mean[b]
    return z_bar, shift_bar, precision.T @ total, precision_bar


@compiled(error_model="numpy")
def whiten_about(eta: NDArray, centre: NDArray, factor: NDArray) -> NDArray:
    """Turn parameters (p, trial) into Rᵀ(η − centre)."""
    z = np.zeros(eta.shape)
    for b in range(len(z)):
        for a in range(b, len(z)):
            _subtract(z[b], -factor[a, b], eta[a] - centre[a])
    return z


@compiled(error_model="numpy")
def colour_about(z: NDArray, centre: NDArray, factor: NDArray) -> NDArray:
    """Turn z (p, trial) into parameters (p, trial).

    They are about the centre of `colour_trials`.
    """
    eta = z.copy()
    _solve_transposed(factor, eta)
    return eta + centre


@compiled(error_model="numpy")
def _subtract(x: NDArray, y: NDArray, z: NDArray) -> None:
    """Take y z from x, all (trial,)."""
    for i in range(x.size):
        x[i] -= y[i] * z[i]


@compiled(error_model="numpy")
def _solve_transposed(factor: NDArray, x: NDArray) -> None:
    """Overwrite x (p, trial) with R⁻ᵀ x."""
    for a in range(len(x) - 1, -1, -1):
        x[a] /= factor[a, a]
        for b in range(a):
            _subtract(x[b], factor[a, b], x[a])


@compiled(error_model="numpy")
def _pull_factor_back(factor: NDArray, factor_bar: NDArray) -> NDArray:
    """Slope (p, p) by Λ from that by R.

    It is symmetric, and summed over trials; R = chol Λ.

    Reverse of the factorisation, entry by entry from the last; `factor_bar` is used up.
    Murray (2016), arXiv:1602.07527.
    """
    size = factor.shape[0]
    total = np.zeros((size, size))
    for a in range(size - 1, -1, -1):
        for b in range(a, -1, -1):
            bar = factor_bar[a, b]
            bar /= factor[b, b]
            if a == b:
                bar *= 0.5
                total[a, a] += bar.sum()
                for c in range(a):
                    _subtract(factor_bar[a, c], 2.0 * bar, factor[a, c])
                continue
            _subtract(factor_bar[b, b], bar, factor[a, b])
            for c in range(b):
                _subtract(factor_bar[a, c], bar, factor[b, c])
                _subtract(factor_bar[b, c], bar, factor[a, c])
            half = 0.5 * bar.sum()
            total[a, b] += half
            total[b, a] += half
    return total
