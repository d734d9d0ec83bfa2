"""Evidence for waves in what a model leaves.

A wave has two columns, with amplitudes of one size.

With X the whitened columns of a trial, two for each wave, y its n whitened numbers of unit
variance, s the sd of the amplitudes, and the variance unknown, the evidence is

    −½ log|1 + s² XᵀX| − (n/2) log(1 − Q/n),    Q = yᵀX (XᵀX + s⁻²)⁻¹ Xᵀy
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.mismatch.checks.lines import WaveSeries, whiten_series

Array = NDArray[np.float64]
Wave = NDArray[np.complex128]
"""Two columns as real and imaginary part."""


class Products(NamedTuple):
    """Products of the waves' columns and the residual.

    XᵀX (trial, 2 · wave, 2 · wave), Xᵀy (trial, 2 · wave) and n (trial,).
    """

    square: Array
    pull: Array
    count: Array

    def share_gain(self) -> "Products":
        """Products of the wave with one gain."""
        return Products(*(part.sum(axis=0, keepdims=True) for part in self))


def project_wave(series: list[WaveSeries], waves: list[Wave]) -> Products:
    """Project each trial's whitened numbers on its wave (n,).

    Several waves at once are (n, wave).
    """
    square, pull = [], []
    for one, wave in zip(series, waves, strict=True):
        rows = [whiten_series(part, one.gap, one.memory) for part in np.atleast_2d(wave.T)]
        columns = one.per_rad * np.stack([part for w in rows for part in (w.real, w.imag)])
        columns -= columns.mean(axis=1, keepdims=True)
        square.append(columns @ columns.T)
        pull.append(columns @ one.values)
    count = np.array([float(one.values.size) for one in series])
    return Products(np.stack(square), np.stack(pull), count)


def weigh_wave(products: Products, sizes: Array) -> Array:
    """Evidence [nats] for waves of each size [rad].

    >>> one = Products(np.eye(2)[None], np.zeros((1, 2)), np.ones(1))
    >>> weigh_wave(one, np.ones(1)).round(6).tolist()
    [-0.693147]
    """
    square, pull, count = products
    found, one = np.zeros(len(sizes)), np.eye(pull.shape[1])
    for k, size in enumerate(sizes):
        amplitude = np.linalg.solve(square + one / size**2, pull[..., None])[..., 0]
        explained = np.einsum("ta,ta->t", pull, amplitude) / count
        wide = np.linalg.slogdet(one + size**2 * square)[1]
        found[k] = -0.5 * np.sum(count * np.log1p(-explained) + wide)
    return found


def estimate_wave(products: Products, size: float) -> tuple[Wave, float]:
    """Amplitudes a − ib (trial,) [rad], and sd."""
    spread = np.linalg.inv(products.square + np.eye(2) / size**2)
    mean = np.einsum("tab,tb->ta", spread, products.pull)
    sd = np.sqrt(np.mean(mean**2) + np.einsum("taa->", spread) / mean.size)
    return mean[:, 0] - 1j * mean[:, 1], float(sd)


def average_evidence(evidence: Array) -> float:
    """Log of the mean evidence.

    >>> round(average_evidence(np.log([1.0, 3.0])), 6)
    0.693147
    """
    return float(np.logaddexp.reduce(evidence, axis=None) - np.log(np.size(evidence)))
