"""A marker whose centre swims with the light.

The light swings slowly with one period, at phases of each trial's own. It turns the direction of
one link, as two waves do: the measurement model of the diagnosis has random walks.
"""

import numpy as np

from softfinger.concealed.nuisances.nuisance import Fault, Mark, Nuisance, Random, Scene, Shape


def _mark(scene: Scene, fault: Fault, rng: Random) -> Mark:
    """Turn one link's direction with the light."""
    period, link = fault.shape["period_s"], int(fault.shape["link"])
    start = rng.uniform(0.0, 2.0 * np.pi, 2)
    light = np.sin(2.0 * np.pi * scene.time / period + start[0])
    light += 0.5 * np.sin(4.4 * np.pi * scene.time / period + start[1])
    column = np.zeros(scene.motion.shape)
    column[:, link] = fault.size * scene.noise.sd * light
    if link + 1 < column.shape[1]:
        column[:, link + 1] = -column[:, link]
    return Mark(offset=column, columns=column[..., None])


NUISANCE = Nuisance(
    id="swimming_marker",
    sentence="a marker that swims with the light",
    finding="",
    also=("drift",),
    low=0.2,
    high=1.0,
    shape={"period_s": Shape(8.0, 30.0), "link": Shape(0.0, 2.0, choice=True)},
    mark=_mark,
)
