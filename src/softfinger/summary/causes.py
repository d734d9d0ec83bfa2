"""Which parameter spreads the motion; which correlate."""

from itertools import combinations

import numpy as np
import xarray as xr

CHANCE = 0.1
"""Share of 90 % intervals without 0 by chance."""


def find_causes(sobol: xr.Dataset) -> xr.Dataset:
    """Find what causes most of the widest spread.

    Returns
    -------
    Dataset
        cause (joint), share (joint) of the variance that it causes alone, widest (joint) [s], the
        time at which the angle's standard deviation is largest.
    """
    own = sobol.sel(estimate="posterior")
    widest = own.isel(time=own["angle_sd"].argmax("time"))
    shares = widest["first_order"].transpose("joint", "parameter")
    names = shares["parameter"].values[shares.values.argmax(axis=1)]
    return xr.Dataset(
        {
            "cause": ("joint", names.astype(str)),
            "share": ("joint", shares.values.max(axis=1)),
            "widest": ("joint", widest["time"].values),
        },
        coords={"joint": sobol["joint"].values},
    )


def find_pairs(shapley: xr.Dataset) -> xr.Dataset:
    """Find the parameters that are correlated over trials.

    Returns
    -------
    Dataset
        pair_joint, one, other (pair); correlation (pair, quantile); clear (pair), whether the
        interval excludes 0; by_chance (), how many would be clear by chance.
    """
    names = shapley["parameter"].values.astype(str)
    pairs = [(joint, *both) for joint in shapley["joint"].values for both in combinations(names, 2)]
    value = np.array(
        [
            shapley["correlation_quantile"].sel(joint=j, parameter=a, other_parameter=b).values
            for j, a, b in pairs
        ]
    )
    joint, one, other = zip(*pairs, strict=True)
    return xr.Dataset(
        {
            "pair_joint": ("pair", np.array(joint)),
            "one": ("pair", np.array(one)),
            "other": ("pair", np.array(other)),
            "correlation": (("pair", "quantile"), value),
            "clear": ("pair", (value[:, 0] > 0) | (value[:, -1] < 0)),
            "by_chance": ((), CHANCE * len(pairs)),
        },
        coords={"quantile": shapley["quantile"].values},
    )
