"""Parameters of a trial as standard normals, given the population: the geometry NUTS likes.

With the likelihood's normal stand-in (curvature H, pull b; `laplace`) and the population N(μ, Ω),
the trial's parameters are about normal with precision Λ = H + Ω⁻¹ and mean Λ⁻¹(b + Ω⁻¹μ). So

    Λ = R Rᵀ,   η = R⁻ᵀ (R⁻¹ (b + Ω⁻¹ μ) + z),   log|∂η/∂z| = −Σ log R_aa

makes z about standard normal whatever the population is: trials that the data fix stay where they
are (centred), trials that the data leave open move with μ and scale with σ (non-centred).
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True)
def colour_trials(
    z: NDArray, curvature: NDArray, pull: NDArray, mean: NDArray, precision: NDArray
) -> tuple[NDArray, NDArray, NDArray]:
    """Turn standard normals z (trial, p) into parameters.

    Parameters
    ----------
    z
        (trial, p).
    curvature, pull
        (trial, p, p) H and (trial, p) b.
    mean, precision
        (p,) μ and (p, p) Ω⁻¹.

    Returns
    -------
    eta, log_volume, factor : (trial, p), (trial,) log|∂η/∂z| and (trial, p, p) R.
    """
    trials, size = z.shape
    eta, log_volume = np.empty((trials, size)), np.zeros(trials)
    factor = np.zeros((trials, size, size))
    shift = precision @ mean
    for i in range(trials):
        root = factor[i]
        _factorise(curvature[i], precision, root)
        for a in range(size):  # η holds R⁻¹(b + Ω⁻¹μ) + z, then R⁻ᵀ of it
            value = pull[i, a] + shift[a]
            for b in range(a):
                value -= root[a, b] * (eta[i, b] - z[i, b])
            eta[i, a] = value / root[a, a] + z[i, a]
            log_volume[i] -= np.log(root[a, a])
        _solve_upper(root, eta[i])
    return eta, log_volume, factor


@njit(cache=True)
def pull_colours_back(
    eta: NDArray,
    z: NDArray,
    factor: NDArray,
    mean: NDArray,
    precision: NDArray,
    eta_bar: NDArray,
    volume_bar: NDArray,
) -> tuple[NDArray, NDArray, NDArray]:
    """Slopes by z, μ and Ω⁻¹ from slopes by η (trial, p) and the log volume (trial,).

    η = R⁻ᵀ y, y = s + z, R s = b + Ω⁻¹μ; the slope by R goes through the Cholesky factorisation.
    """
    trials, size = z.shape
    z_bar = np.empty((trials, size))
    shift_bar = np.zeros(size)
    precision_bar = np.zeros((size, size))
    y, side, root_bar = np.empty(size), np.empty(size), np.empty((size, size))
    for i in range(trials):
        root = factor[i]
        for a in range(size):
            y[a] = 0.0
            for b in range(a, size):
                y[a] += root[b, a] * eta[i, b]
            value = eta_bar[i, a]
            for b in range(a):
                value -= root[a, b] * z_bar[i, b]
            z_bar[i, a] = value / root[a, a]
            side[a] = z_bar[i, a]
        _solve_upper(root, side)
        for a in range(size):
            shift_bar[a] += side[a]
            for b in range(a + 1):
                root_bar[a, b] = -eta[i, a] * z_bar[i, b] - side[a] * (y[b] - z[i, b])
            root_bar[a, a] -= volume_bar[i] / root[a, a]
        _pull_factor_back(root, root_bar, precision_bar)
    mean_bar = precision.T @ shift_bar
    for a in range(size):
        for b in range(size):
            precision_bar[a, b] += shift_bar[a] * mean[b]
    return z_bar, mean_bar, precision_bar


@njit(cache=True)
def whiten_trials(
    eta: NDArray, curvature: NDArray, pull: NDArray, mean: NDArray, precision: NDArray
) -> NDArray:
    """Turn parameters (trial, p) back into z (trial, p)."""
    centre, _, factor = colour_trials(np.zeros_like(eta), curvature, pull, mean, precision)
    z = np.zeros_like(eta)
    for i in range(eta.shape[0]):
        z[i] = factor[i].T @ (eta[i] - centre[i])
    return z


@njit(cache=True)
def _factorise(curvature: NDArray, precision: NDArray, root: NDArray) -> None:
    size = root.shape[0]
    for a in range(size):
        for b in range(a + 1):
            value = curvature[a, b] + precision[a, b]
            for c in range(b):
                value -= root[a, c] * root[b, c]
            root[a, b] = np.sqrt(value) if a == b else value / root[b, b]


@njit(cache=True)
def _solve_upper(root: NDArray, x: NDArray) -> None:
    """Overwrite x with R⁻ᵀ x."""
    for a in range(x.size - 1, -1, -1):
        x[a] /= root[a, a]
        for b in range(a):
            x[b] -= root[a, b] * x[a]


@njit(cache=True)
def _pull_factor_back(root: NDArray, root_bar: NDArray, precision_bar: NDArray) -> None:
    """Add the slope by Λ, symmetric, that belongs to `root_bar`, the slope by R = chol Λ.

    Reverse of the factorisation, entry by entry from the last; `root_bar` is used up.
    Murray (2016), arXiv:1602.07527.
    """
    size = root.shape[0]
    for a in range(size - 1, -1, -1):
        for b in range(a, -1, -1):
            if a == b:
                bar = 0.5 * root_bar[a, a] / root[a, a]
            else:
                bar = root_bar[a, b] / root[b, b]
                root_bar[b, b] -= bar * root[a, b]
            if a == b:
                for c in range(b):
                    root_bar[a, c] -= 2.0 * bar * root[a, c]
                precision_bar[a, a] += bar
            else:
                for c in range(b):
                    root_bar[a, c] -= bar * root[b, c]
                    root_bar[b, c] -= bar * root[a, c]
                precision_bar[a, b] += 0.5 * bar
                precision_bar[b, a] += 0.5 * bar
