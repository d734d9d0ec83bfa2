"""Causal response of a joint to its load.

It creeps and never turns back.

q(t) = q₀ + Σₖ aₖ ∫ φₖ(t − s) dL(s), with φ an elastic step, exponential creep on times from a few
frames to the trial's length, and flow; all aₖ of one sign. Every linear viscoelastic material that
creeps monotonously moves so, whatever its parameters: what is far from every such motion has
something else in it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

Array = NDArray[np.float64]
N_TIMES = 6


@dataclass(frozen=True)
class Response:
    """Fitted responses of the joints of a trial.

    Attributes
    ----------
    amplitude : (joint, term)
        Of one sign within a joint; per unit of load.
    rest : (joint,) [rad]
        Angle before any load.
    residual : (joint, frame) [rad]
    times : (term,) [s]
        Creep times; 0 for the elastic term, ∞ for the flow.
    """

    amplitude: Array
    rest: Array
    residual: Array
    times: Array


def choose_times(span: float, interval: float) -> Array:
    """Creep times [s] (term,), 0 first, ∞ last."""
    shortest = min(2.0 * interval, 0.1 * span)
    return np.concatenate([[0.0], np.geomspace(shortest, span, N_TIMES), [np.inf]])


def compute_terms(time: Array, load_time: Array, load: Array, times: Array) -> Array:
    """Response (frame, term) to a piecewise-linear load.

    A jump ΔL at s adds ΔL (1 − exp(−(t − s)/τ)), a change Δm of slope adds
    Δm (t − s − τ (1 − exp(−(t − s)/τ))); flow is ∫ L dt over the span of the frames.
    """
    jump_at, jump, bend_at, bend = split_load(load_time, load)
    span = max(float(time[-1] - time[0]), 1e-12)
    terms = np.empty((time.size, times.size))
    for k, tau in enumerate(times):
        terms[:, k] = _respond(time, jump_at, jump, bend_at, bend, tau, span)
    return terms


def split_load(load_time: Array, load: Array) -> tuple[Array, Array, Array, Array]:
    """Jumps and slope changes of a load: (at, size)."""
    gap = np.diff(load_time)
    step = gap <= 0
    slope = np.where(step, 0.0, np.diff(load) / np.where(step, 1.0, gap))
    ramps = slope[~step]
    at = load_time[:-1][~step]
    change = np.diff(np.concatenate([[0.0], ramps, [0.0]]))
    bend_at = np.concatenate([at, load_time[-1:]])
    jump_at = np.concatenate([load_time[:1], load_time[1:][step]])
    jump = np.concatenate([load[:1], np.diff(load)[step]])
    keep, bent = jump != 0, np.abs(change) > 1e-12 * np.abs(load).max(initial=1e-300)
    return jump_at[keep], jump[keep], bend_at[bent], change[bent]


def _respond(
    time: Array, jump_at: Array, jump: Array, bend_at: Array, bend: Array, tau: float, span: float
) -> Array:
    since, along = time[:, None] - jump_at, np.clip(time[:, None] - bend_at, 0.0, None)
    after = np.clip(since, 0.0, None)
    if tau == 0.0:
        return (since >= 0) @ jump + along @ bend
    if np.isinf(tau):
        return (after @ jump + 0.5 * along**2 @ bend) / span
    risen = -np.expm1(-after / tau) @ jump
    return risen + (along + tau * np.expm1(-along / tau)) @ bend


def fit_response(terms: Array, angle: Array, times: Array) -> Response:
    """Fit angles (joint, frame) by non-negative least squares.

    NaN = missing; the response has either sign.
    """
    amplitude = np.zeros((len(angle), times.size))
    rest, residual = np.zeros(len(angle)), np.full_like(angle, np.nan)
    for joint, values in enumerate(angle):
        seen = np.isfinite(values)
        design, target = terms[seen], values[seen]
        if target.size < 4:
            continue
        middle = design.mean(axis=0)
        size = np.sqrt(((design - middle) ** 2).mean(axis=0)) + 1e-300
        scaled = (design - middle) / size
        fits = []
        for sign in (1.0, -1.0):
            found, error = nnls(scaled, sign * (target - target.mean()), maxiter=200)
            fits.append((error, sign * found / size))
        _, amplitude[joint] = min(fits, key=lambda fit: fit[0])
        rest[joint] = target.mean() - middle @ amplitude[joint]
        residual[joint, seen] = target - rest[joint] - design @ amplitude[joint]
    return Response(amplitude, rest, residual, times)
