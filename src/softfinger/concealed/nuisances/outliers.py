"""Frames with wrong markers."""

import numpy as np
from scipy.stats import norm

from softfinger.concealed.nuisances.nuisance import Fault, Mark, Nuisance, Random, Scene, Shape


def _mark(scene: Scene, fault: Fault, rng: Random) -> Mark:
    """Add a normal error to some frames.

    It is many times the noise, and acts on every joint.

    The oracle knows which frames they are and how wide the errors; what it knows costs it the
    probability of this choice of frames.
    """
    frames, joints = scene.motion.shape
    hit = rng.uniform(size=frames) < fault.size
    width = fault.shape["times_the_noise"] * scene.noise.sd
    offset = np.where(hit[:, None], width * rng.normal(size=(frames, joints)), 0.0)
    chance = np.where(hit, np.log(fault.size), np.log1p(-fault.size)).sum()
    wide = np.hypot(width, scene.noise.sd)
    density = norm.logpdf(offset[hit], scale=wide).sum()
    return Mark(offset=offset, left_out=hit, nats=float(chance + density))


NUISANCE = Nuisance(
    id="outliers",
    sentence="single frames with gross errors",
    finding="outliers",
    also=("heavy_tails",),
    low=0.01,
    high=0.02,
    shape={"times_the_noise": Shape(6.0, 30.0)},
    mark=_mark,
)
