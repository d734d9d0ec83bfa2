"""The Laplace answer of our own pilot fit, as INLA would give it.

It is the best of its kind: mode and curvature of the whole hierarchical model, which cost no draws
at all. What it gets wrong is its skewness: means are shifted and the spread of σ is symmetric.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.mixed_effects_laplace import Fit
from softfinger.mechanics import PARAMETERS

NAMES = tuple(f"mu_{name if name == 'q_ini' else f'log_{name}'}" for name in PARAMETERS)


class Misfit(NamedTuple):
    """Largest shift of a mean, in its sd, and the ratio of sds farthest from 1."""

    shift: float
    sd_ratio: float


def compare(fit: Fit, posterior: xr.Dataset) -> Misfit:
    """The pilot's answer for μ beside draws of it."""
    joints = posterior.sizes["joint"]
    mean, sd = (_arrange(a, joints) for a in (fit.mean, np.sqrt(np.diag(fit.mean_covariance))))
    drawn = [posterior[name].stack(all=("chain", "draw")).to_numpy() for name in NAMES]
    draws = np.stack(drawn, axis=1)  # (joint, parameter, draw)
    shift = np.abs(mean - draws.mean(axis=-1)) / draws.std(axis=-1)
    ratio = sd / draws.std(axis=-1)
    return Misfit(float(shift.max()), float(max(ratio.ravel(), key=lambda r: abs(np.log(r)))))


def _arrange(values: NDArray, joints: int) -> NDArray[np.float64]:
    return values.reshape(joints, -1)
