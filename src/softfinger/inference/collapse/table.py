"""Small matrices from which the likelihood is computed.

With the basis U of `basis`, the residual of joint j at frame i is linear in known rows,

    r_j(i) = w_jᵀ ψ(i),   ψ = [U_1 … U_M, ∫u, 1, y_1 … y_J] / scale,
    w_j = [c(x_j) / k_v, 1 / c_p, q_ini, −1 at y_j]

and AR(1) noise, correlated between joints, needs only the sums of products of neighbouring rows

    N = Σ_g ψ(i) ψ(i)ᵀ,   B = Σ_g ψ(i−1) ψ(i−1)ᵀ,   X = Σ_g ψ(i−1) ψ(i)ᵀ

per gap g, and the first row. ρ, σ and the joints' correlation stay free.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.inference.collapse.basis import (
    ElasticTable,
    Protocol,
    build_elastic_modes,
    build_elastic_table,
)
from softfinger.measurement.gaps import place_gap_nodes_array, spread_gaps_array
from softfinger.mechanics.load import integrate_load_array


class Collapse(NamedTuple):
    """What is left of a campaign's frames.

    D = modes + 2 + joints.
    """

    table: ElasticTable
    gap: NDArray[np.float64]  # (gap,) nodes of gaps between frames, in median intervals
    products: NDArray[np.float64]  # (trial, gap, 3, D, D): N, B, X
    first: NDArray[np.float64]  # (trial, D): the first used row
    count: NDArray[np.float64]  # (trial, gap + 1): pairs of frames, then 1 if there is a frame
    offset: NDArray[np.float64]  # (trial,) [nats]: the constant of log p
    patterns: NDArray[np.bool_]  # (pattern, joint): who is present
    pattern: NDArray[np.int64]  # (trial,)

    @property
    def present(self) -> NDArray[np.bool_]:
        """Which joints (trial, joint) take part."""
        return self.patterns[self.pattern]


def collapse_angles(angles: xr.Dataset, frames: xr.Dataset) -> Collapse:
    """Reduce every trial to the matrices of its likelihood.

    Parameters
    ----------
    frames
        What `select_frames` gives for it.
    """
    series = _gather_trials(angles, frames)
    protocols = {_fingerprint(s.protocol): s.protocol for s in series if len(s.angle)}
    table = build_elastic_table(list(protocols.values()))
    modes = {key: build_elastic_modes(table, value) for key, value in protocols.items()}
    gaps = [np.diff(s.protocol[0][s.kept]) / float(frames["frame_interval"]) for s in series]
    nodes = place_gap_nodes_array(np.concatenate(gaps))
    n, size = len(series), table.value.shape[1] + 2 + angles.sizes["joint"]
    products, first = np.zeros((n, len(nodes), 3, size, size)), np.zeros((n, size))
    count = np.zeros((n, len(nodes) + 1))
    for i, (trial, gap) in enumerate(zip(series, gaps, strict=True)):
        if len(trial.angle) > 0:
            rows = _build_rows(trial, modes[_fingerprint(trial.protocol)])
            weights = spread_gaps_array(gap, nodes)
            first[i], count[i] = rows[0], [*weights.sum(axis=0), 1.0]
            products[i] = _sum_products(rows, weights)
    present = frames["present"].transpose("trial", "joint").values
    patterns, pattern = np.unique(present, axis=0, return_inverse=True)
    constant = [np.log(s.scale).sum() + 0.5 * np.log(2 * np.pi) * len(s.scale) for s in series]
    offset = -present.sum(axis=1) * np.array(constant)
    return Collapse(table, nodes, products, first, count, offset, patterns, pattern.ravel())


class _Series(NamedTuple):
    """One trial: protocol, kept frames and angles."""

    protocol: Protocol
    kept: NDArray
    angle: NDArray  # (kept, joint), 0 where the joint is not present
    scale: NDArray  # (kept,)


def _gather_trials(angles: xr.Dataset, frames: xr.Dataset) -> list[_Series]:
    clock = angles["time"].transpose("trial", "frame").values
    load = [angles[name].transpose("trial", "knot").values for name in _LOAD]
    recorded = angles["joint_angle"].transpose("trial", "frame", "joint").values
    present, scale = frames["present"].values, frames["frame_scale"].values
    series = []
    for trial, used in enumerate(frames["used"].values):
        usable = _find_increasing(clock[trial], used)
        protocol = (clock[trial, usable], load[0][trial], load[1][trial])
        angle = np.where(present[trial], recorded[trial, used], 0.0)
        series.append(_Series(protocol, used[usable], angle, scale[trial, used]))
    return series


_LOAD = ("load_time", "load_torque")


def _find_increasing(time: NDArray, used: NDArray) -> NDArray[np.bool_]:
    """All frames at which time increases."""
    known = np.isfinite(time)
    return known if (np.diff(time[known]) > 0).all() else used


def _fingerprint(protocol: Protocol) -> bytes:
    return b"".join(part.tobytes() for part in protocol)


def _build_rows(trial: _Series, modes: NDArray) -> NDArray:
    integral = integrate_load_array(*trial.protocol)
    rows = [modes[:, trial.kept], integral[trial.kept][None], np.ones((1, len(trial.angle)))]
    return np.ascontiguousarray((np.concatenate([*rows, trial.angle.T]) / trial.scale).T)


@compiled(error_model="numpy")
def _sum_products(rows: NDArray, weights: NDArray) -> NDArray:
    """Weighted sums of ψψᵀ: (gap, 3, D, D).

    Σ weight ψψᵀ of the later rows, of the earlier, and of earlier × later.
    """
    size = rows.shape[1]
    products = np.zeros((weights.shape[1], 3, size, size))
    for i in range(1, rows.shape[0]):
        for node in range(weights.shape[1]):
            weight = weights[i - 1, node]
            if weight == 0.0:
                continue
            for a in range(size):
                now, before = weight * rows[i, a], weight * rows[i - 1, a]
                for b in range(size):
                    products[node, 0, a, b] += now * rows[i, b]
                    products[node, 1, a, b] += before * rows[i - 1, b]
                    products[node, 2, a, b] += before * rows[i, b]
    return products
