"""Noise of another size in every trial."""

import numpy as np
from scipy.stats import norm

from softfinger.concealed.nuisances.nuisance import Fault, Mark, Nuisance, Random, Scene


def _mark(scene: Scene, fault: Fault, rng: Random) -> Mark:
    """Scale a trial's noise by a log-normal factor.

    The size is the sd of the factor's logarithm.

    That the factor is known costs what its integral over the prior would: its density times the
    width √(2π / 2N) that N values leave to it.
    """
    log_scale = fault.size * rng.normal()
    width = np.sqrt(np.pi / scene.motion.size)
    nats = norm.logpdf(log_scale, scale=fault.size) + np.log(width)
    return Mark(scale=float(np.exp(log_scale)), nats=float(nats))


NUISANCE = Nuisance(
    id="uneven_noise",
    sentence="noise of another size in every trial",
    finding="uneven_noise",
    low=0.4,
    high=0.8,
    trials=2,
    mark=_mark,
)
