"""A camera that turns slowly and without aim."""

import numpy as np

from softfinger.concealed.nuisances.nuisance import Fault, Mark, Nuisance, Random, Scene, Shape

WAVES = 12  # in which the oracle describes a trial's drift


def _mark(scene: Scene, fault: Fault, rng: Random) -> Mark:
    """Add a drift to the first joint's angle.

    It returns to its mean within some time.

    An Ornstein–Uhlenbeck process as its first Karhunen–Loève waves; the size is its sd over that
    of the noise.
    """
    grid = np.linspace(scene.time[0], scene.time[-1], 120)
    forgets = fault.shape["forgets_s"]
    power, wave = np.linalg.eigh(np.exp(-np.abs(grid[:, None] - grid) / forgets))
    loads = (wave * np.sqrt(np.clip(power, 0.0, None)))[:, -WAVES:]
    columns = np.zeros((*scene.motion.shape, WAVES))
    for k, column in enumerate(loads.T):
        columns[:, 0, k] = fault.size * scene.noise.sd * np.interp(scene.time, grid, column)
    return Mark(offset=columns @ rng.normal(size=WAVES), columns=columns)


NUISANCE = Nuisance(
    id="camera_drift",
    sentence="a slow drift of the picture",
    finding="drift",
    low=0.3,
    high=2.0,
    shape={"forgets_s": Shape(5.0, 40.0)},
    mark=_mark,
)
