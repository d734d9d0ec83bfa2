"""How the oracle sees a trial through noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.special import gammaln

from softfinger.concealed.arrays import Array, Flags
from softfinger.concealed.noise import Noise, measure_whitening, whiten
from softfinger.concealed.nuisances import Mark


@dataclass(frozen=True)
class Blur:
    """Covariance of one trial's errors.

    The errors are the noise, scaled, and columns of further errors.

    With N the noise, D its factors and G the columns: D N D + G Gᵀ, in frames that show something.
    """

    noise: Noise
    time: Array  # (frame,)
    scale: Array  # (frame, joint)
    shock: Array  # (frame,)
    columns: Array  # (frame, joint, k) [rad]
    nats: float = 0.0
    tails: float = 0.0

    def whiten(self, signal: Array) -> Array:
        """Whiten a signal (frame, joint).

        These errors would leave it white, with sd 1.
        """
        white = self._scale(signal)
        if self.columns.shape[2]:
            turn, size = self._axes
            shrunk = (1.0 - 1.0 / np.hypot(1.0, size))[:, None] * turn.T
            white = white - turn @ (shrunk @ white)
        return white.reshape(signal.shape)

    def change(self, noise: Noise) -> Blur:
        """Give the same trial other noise."""
        return replace(self, noise=noise)

    def add_nats(self, residual: Array) -> float:
        """Add to −|r|²/2 what makes it a density.

        The result is the log density of a whitened residual r (frame, joint).
        """
        volume = measure_whitening(self.noise, self.time, self.scale.shape[1])
        joints = self.scale.shape[1]
        volume -= np.log(self.scale).sum() + joints * np.log(self.shock).sum()
        if self.columns.shape[2]:
            volume -= np.log(np.hypot(1.0, self._axes[1])).sum()
        nats = self.nats + volume - 0.5 * np.log(2.0 * np.pi) * residual.size
        if self.tails:
            nats += _weigh_tails(residual, self.shock, self.tails)
        return float(nats)

    def _scale(self, signal: Array) -> Array:
        """Whiten, columns aside, as (frame · joint, …)."""
        extra = (1,) * (signal.ndim - 2)
        white = whiten(
            self.noise, self.time, signal / self.scale.reshape(*self.scale.shape, *extra)
        )
        white = white / self.shock.reshape(-1, 1, *extra)
        return white.reshape(self.scale.size, *signal.shape[2:])

    @cached_property
    def _axes(self) -> tuple[Array, Array]:
        turn, size, _ = np.linalg.svd(self._scale(self.columns), full_matrices=False)
        return turn, size


def _weigh_tails(residual: Array, shock: Array, freedom: float) -> float:
    """Log density of innovations, Student's t over normal."""
    joints = residual.shape[1]
    square = (residual**2).sum(axis=1)
    inner = shock**2 * square / (freedom - 2.0)
    student = gammaln(0.5 * (freedom + joints)) - gammaln(0.5 * freedom)
    student = (
        student - 0.5 * joints * np.log(freedom - 2.0) - 0.5 * (freedom + joints) * np.log1p(inner)
    )
    normal = -0.5 * square - 0.5 * joints * np.log(2.0) - joints * np.log(shock)
    return float((student - normal).sum())


def build_blur(noise: Noise, time: Array, joints: int, marks: Sequence[Mark]) -> Blur:
    """Build the blur of an oracle.

    The oracle knows these marks. All frames are kept.
    """
    blank = np.ones((time.size, joints))
    scale, shock = blank.copy(), np.ones(time.size)
    columns = [np.zeros((time.size, joints, 0))]
    for mark in marks:
        scale *= mark.scale
        shock *= mark.shock
        if mark.columns is not None:
            columns.append(mark.columns)
    return Blur(
        noise=_round(noise, max((mark.rounding for mark in marks), default=0.0)),
        time=time,
        scale=scale,
        shock=shock,
        columns=np.concatenate(columns, axis=2),
        nats=sum(mark.nats for mark in marks),
        tails=max((mark.tails for mark in marks), default=0.0),
    )


def _round(noise: Noise, rounding: float) -> Noise:
    """Add a white error to the noise."""
    if rounding == 0.0:
        return noise
    return replace(noise, rounding=rounding, memory=noise.autocorrelation / (1.0 + rounding**2))


def keep_frames(blur: Blur, kept: Flags) -> Blur:
    """Keep some of the frames."""
    return replace(
        blur,
        time=blur.time[kept],
        scale=blur.scale[kept],
        shock=blur.shock[kept],
        columns=blur.columns[kept],
    )
