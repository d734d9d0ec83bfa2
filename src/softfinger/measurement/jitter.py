"""Errors of the frames' times among noise that grows with the speed.

A frame that was taken s seconds late moves every joint by its own velocity times s: the joints err
together. Noise of the markers (blur) errs in each joint for itself.

References
----------
Frisch, Waugh (1933), Econometrica 1, 387: a slope beside another regressor.
"""

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from softfinger.measurement.noise import NoiseFit
from softfinger.measurement.reml import whiten_windows

Array = NDArray[np.float64]


def is_jitter(fit: NoiseFit, growth: Array) -> bool:
    """Whether the joints share what grows with the speed.

    Two joints' residuals, in units of their sd, correlate as κ g g' + ρ √(1 − g²) √(1 − g'²). Here
    g is the share of the sd that grows, with the sign of the velocity, and ρ the correlation at
    rest, which each pair has for itself. κ is 1 for errors of time and 0 for noise of each joint;
    its least-squares estimate is nearer to one of them. A joint alone shows neither: it is taken
    for jitter.

    Parameters
    ----------
    growth
        (trial, joint, frame) a v: what grows, over the sd at rest, with the sign of the velocity.
    """
    joints = growth.shape[1]
    share = growth / np.sqrt(1.0 + growth**2)
    share = share.transpose(1, 0, 2).reshape(joints, -1)
    residuals = [
        left / max(np.sqrt(np.mean(left**2)), 1e-300) if left.size else left
        for left in whiten_windows(fit.windows, fit.memories)
    ]
    seen = together = 0.0
    for a, b in combinations(range(joints), 2):
        first, second = fit.windows[a].place, fit.windows[b].place
        place, i, j = np.intersect1d(first, second, return_indices=True)
        grown = share[a, place] * share[b, place]
        still = np.sqrt((1.0 - share[a, place] ** 2) * (1.0 - share[b, place] ** 2))
        grown -= still * (still @ grown) / max(still @ still, 1e-300)
        seen += grown @ grown
        together += grown @ (residuals[a][i] * residuals[b][j])
    return bool(together >= 0.5 * seen)
