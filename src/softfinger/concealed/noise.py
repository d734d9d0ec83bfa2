"""Noise of the angles: colour, tails, gaps, clock."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from scipy.signal import lfilter

from softfinger.concealed.arrays import Array, Flags

NoiseKind = Literal["white", "ar_0.3", "ar_0.9", "ar_0.98", "heavy_tailed", "gappy", "uneven"]
NOISE_KINDS: tuple[NoiseKind, ...] = get_args(NoiseKind)
CORRELATION = {"ar_0.3": 0.3, "ar_0.9": 0.9, "ar_0.98": 0.98, "uneven": 0.5}
DEGREES_OF_FREEDOM = 4


@dataclass(frozen=True)
class Noise:
    """Noise: sd [rad], correlation ρ per frame interval."""

    kind: NoiseKind
    sd: float
    frame_interval: float
    memory: float | None = None  # in place of the kind's own autocorrelation
    rounding: float = 0.0  # sd of an error of each angle's own, over that of the noise

    @property
    def autocorrelation(self) -> float:
        """Correlation of noise over one median frame interval."""
        return CORRELATION.get(self.kind, 0.0) if self.memory is None else self.memory

    @property
    def joint_correlation(self) -> float:
        """Correlation between neighbours: they share a link, seen once."""
        return -0.5

    def link(self, joints: int) -> Array:
        """Covariance between joints, in units of the noise's variance."""
        neighbours = np.eye(joints, k=1) + np.eye(joints, k=-1)
        return (1.0 + self.rounding**2) * np.eye(joints) + self.joint_correlation * neighbours


def draw_frame_times(noise: Noise, duration: float, rng: np.random.Generator) -> Array:
    """Draw frame times of a steady clock, or not."""
    frames = int(duration / noise.frame_interval) + 1
    time = noise.frame_interval * np.arange(frames)
    if noise.kind == "uneven":
        time[1:] += noise.frame_interval * rng.uniform(-0.45, 0.45, frames - 1)
        time = time[rng.uniform(size=frames) > 0.1]
    return time


def draw_noise(
    noise: Noise,
    time: Array,
    joints: int,
    rng: np.random.Generator,
    shake: Array | float = 1.0,
) -> Array:
    """Draw the noise (frame, joint) of relative angles.

    A relative angle is the difference between two links' directions.

    Each link's direction, the base's included, errs on its own: an Ornstein–Uhlenbeck process seen
    at the frames, so a gap lets it forget. Each frame's innovations are scaled by `shake` (frame,).
    """
    shape = (time.size, joints + 1)
    if noise.kind == "heavy_tailed":
        scale = np.sqrt((DEGREES_OF_FREEDOM - 2) / DEGREES_OF_FREEDOM)
        shock = scale * rng.standard_t(DEGREES_OF_FREEDOM, shape)
    else:
        shock = rng.normal(size=shape)
    shock *= np.reshape(shake, (-1, 1))
    rho = noise.autocorrelation
    if rho == 0.0:
        direction = shock
    elif noise.kind == "uneven":
        direction = shock.copy()
        memory = rho ** (np.diff(time) / noise.frame_interval)
        for k, kept in enumerate(memory, start=1):
            direction[k] = kept * direction[k - 1] + np.sqrt(1.0 - kept**2) * shock[k]
    else:
        shock[1:] *= np.sqrt(1.0 - rho**2)
        direction = lfilter([1.0], [1.0, -rho], shock, axis=0)
    return noise.sd / np.sqrt(2.0) * np.diff(direction, axis=1)


def draw_missing(noise: Noise, frames: int, rng: np.random.Generator) -> Flags:
    """Draw scattered gaps and two longer ones."""
    missing = np.zeros(frames, bool)
    if noise.kind == "gappy":
        missing = rng.uniform(size=frames) < 0.1
        for start in rng.integers(frames // 10, 9 * frames // 10, 2):
            missing[start : start + frames // 25] = True
    return missing


def whiten(noise: Noise, time: Array, signal: Array) -> Array:
    """Whiten a signal (frame, joint, …).

    This noise would become white, with sd 1.

    Exact for the Gaussian kinds: first the joints (neighbours share a link), then the time.
    """
    factor = np.linalg.inv(noise.sd * np.linalg.cholesky(noise.link(signal.shape[1])))
    white = np.einsum("jk,fk...->fj...", factor, signal)
    if noise.autocorrelation > 0.0:
        kept = noise.autocorrelation ** (np.diff(time) / noise.frame_interval)
        kept = kept.reshape(-1, *[1] * (white.ndim - 1))
        white[1:] = (white[1:] - kept * white[:-1]) / np.sqrt(1.0 - kept**2)
    return white


def measure_whitening(noise: Noise, time: Array, joints: int) -> float:
    """Log determinant of `whiten` over all frames and joints."""
    volume = time.size * (joints * np.log(noise.sd) + np.linalg.slogdet(noise.link(joints))[1] / 2)
    if noise.autocorrelation > 0.0:
        kept = noise.autocorrelation ** (np.diff(time) / noise.frame_interval)
        volume += 0.5 * joints * np.log1p(-(kept**2)).sum()
    return float(-volume)
