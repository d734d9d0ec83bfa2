"""A model expanded about its fit.

Its coordinates make it nearly linear.

Of a trial with η = (log k_v, log c_v, log c_p, q_ini) a joint and mode η*, the coordinates

    u = (k_v*/k_v − 1, τ/τ* − 1, c_p*/c_p − 1, q_ini − q_ini*),   τ = c_v/k_v,

are compliance, retardation time, fluidity and angle: the step solution is linear in three of them,
and nearly so in τ. With G the whitened Gram matrix of [∂F/∂u | ∂F/∂φ | residual] at the fit

    χ²(η, φ) = vᵀ G v,   v = (−u, φ* − φ, 1),   log p(y | η, φ, s) = −χ²/(2 s²) − n log s

for noise s times its estimate. A flow that a trial hardly shows, log c_p → ∞, stays exact, where an
expansion in η fails. What the expansion leaves out is measured and weighed (`correction`).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.inference.mixed_effects import Prior, hold_omega
from softfinger.inference.mixed_effects_laplace import Fit
from softfinger.inference.mixed_effects_linearised import centre_gram
from softfinger.mechanics import OWN

# d(log k_v, log c_v, log c_p, q_ini)/du at the mode
TURN = np.array([[-1.0, 0, 0, 0], [-1.0, 1.0, 0, 0], [0, 0, -1.0, 0], [0, 0, 0, 1.0]])


class Expansion(NamedTuple):
    """What the likelihood of every trial needs.

    d = 4 joint; φ has p numbers.

    Attributes
    ----------
    own, shared
        (trial, d) η* and (p,) φ*.
    gram
        (trial, d + p + 1, d + p + 1) G.
    rows, logdet
        (trial,) numbers recorded, and log|Σ| of their noise.
    curvature, pull
        (d, d, trial) H and (d, trial) b: the likelihood as a normal of η at φ*,
        exp(−½ ηᵀHη + bᵀη).
    cross
        (d, p, trial): b falls by `cross` times what φ rises.
    shared_covariance
        (d + p, d + p) of (μ, φ), about.
    """

    own: NDArray[np.float64]
    shared: NDArray[np.float64]
    gram: NDArray[np.float64]
    rows: NDArray[np.float64]
    logdet: NDArray[np.float64]
    curvature: NDArray[np.float64]
    pull: NDArray[np.float64]
    cross: NDArray[np.float64]
    shared_covariance: NDArray[np.float64]


def expand_fit(
    fit: Fit, prior: Prior, rows: NDArray[np.int64], logdet: NDArray[np.float64]
) -> Expansion:
    """Expand a model about its fit.

    Parameters
    ----------
    fit, prior
        The fit, and the prior of (μ, φ) it was made with.
    rows, logdet
        (trial,) numbers recorded, and log|Σ| of their noise.
    """
    d, size = fit.own.shape[1], fit.gram.shape[1]
    turn = np.eye(size)
    turn[:d, :d] = np.kron(np.eye(d // OWN), TURN)
    moved, near, _ = centre_gram(fit.gram, prior, fit.own, fit.shared)
    curvature = fit.gram[:, :d, :d] + 1e-12 * np.eye(d)
    pull = np.einsum("tab,tb->ta", fit.gram[:, :d, :d], fit.own) + fit.gram[:, :d, -1]
    return Expansion(
        fit.own,
        fit.shared,
        np.ascontiguousarray(turn.T @ fit.gram @ turn),
        np.asarray(rows, float),
        np.asarray(logdet, float),
        np.ascontiguousarray(np.moveaxis(curvature, 0, -1)),
        np.ascontiguousarray(pull.T),
        np.ascontiguousarray(np.moveaxis(fit.gram[:, :d, d:-1], 0, -1)),
        hold_omega(moved, near, fit.omega).shared_covariance,
    )


def forget_trial(expansion: Expansion, trial: int) -> Expansion:
    """Forget a recording, but not its trial."""
    names = ("gram", "rows", "logdet")
    left = {name: getattr(expansion, name).copy() for name in names}
    for array in left.values():
        array[trial] = 0.0
    curvature, pull, cross = (
        getattr(expansion, name).copy() for name in ("curvature", "pull", "cross")
    )
    curvature[..., trial] = 1e-12 * np.eye(len(curvature))
    pull[..., trial], cross[..., trial] = 0.0, 0.0
    return expansion._replace(**left, curvature=curvature, pull=pull, cross=cross)


def keep_trial(expansion: Expansion, trial: int) -> Expansion:
    """Reduce a campaign to one trial."""
    one = slice(trial, trial + 1)
    first = ("own", "gram", "rows", "logdet")
    last = ("curvature", "pull", "cross")
    return expansion._replace(
        **{name: getattr(expansion, name)[one].copy() for name in first},
        **{name: getattr(expansion, name)[..., one].copy() for name in last},
    )


@compiled(error_model="numpy")
def fill_squares(
    eta: NDArray, effect: NDArray, own: NDArray, shared: NDArray, gram: NDArray, square: NDArray
) -> None:
    """Write χ² (trial,) of parameters and effects.

    Parameters eta (d, trial) and effects (p,); the result goes into `square`.
    """
    size = gram.shape[1]
    v = np.empty(size)
    for i in range(gram.shape[0]):
        _fill_step(eta, effect, own, shared, i, v)
        total = 0.0
        for a in range(size):
            row = 0.5 * gram[i, a, a] * v[a]
            for b in range(a):
                row += gram[i, a, b] * v[b]
            total += row * v[a]
        square[i] = 2.0 * total


@compiled(error_model="numpy")
def slope_squares(
    eta: NDArray, effect: NDArray, own: NDArray, shared: NDArray, gram: NDArray
) -> tuple[float, NDArray, NDArray]:
    """Σ χ² over trials, and its slopes.

    The slopes are by eta (d, trial) and the effects (p,).
    """
    d, p, size = eta.shape[0], effect.size, gram.shape[1]
    v, moved = np.empty(size), np.empty(size)
    by_eta, by_effect = np.empty(eta.shape), np.zeros(p)
    total = 0.0
    for i in range(gram.shape[0]):
        _fill_step(eta, effect, own, shared, i, v)
        for a in range(size):
            moved[a] = 0.0
            for b in range(size):
                moved[a] += gram[i, a, b] * v[b]
            total += moved[a] * v[a]
        for j in range(0, d, 4):
            stiff, late = 1.0 - v[j], 1.0 - v[j + 1]  # k_v*/k_v and τ/τ*
            by_eta[j, i] = 2.0 * (moved[j] * stiff + moved[j + 1] * late)
            by_eta[j + 1, i] = -2.0 * moved[j + 1] * late
            by_eta[j + 2, i] = 2.0 * moved[j + 2] * (1.0 - v[j + 2])
            by_eta[j + 3, i] = -2.0 * moved[j + 3]
        for k in range(p):
            by_effect[k] -= 2.0 * moved[d + k]
    return total, by_eta, by_effect


@compiled(error_model="numpy")
def _fill_step(
    eta: NDArray, effect: NDArray, own: NDArray, shared: NDArray, i: int, v: NDArray
) -> None:
    """Write v = (−u, φ* − φ, 1)."""
    d = eta.shape[0]
    for j in range(0, d, 4):
        stiffer = eta[j, i] - own[i, j]
        v[j] = 1.0 - np.exp(-stiffer)
        v[j + 1] = 1.0 - np.exp(eta[j + 1, i] - own[i, j + 1] - stiffer)
        v[j + 2] = 1.0 - np.exp(own[i, j + 2] - eta[j + 2, i])
        v[j + 3] = own[i, j + 3] - eta[j + 3, i]
    for k in range(effect.size):
        v[d + k] = shared[k] - effect[k]
    v[-1] = 1.0
