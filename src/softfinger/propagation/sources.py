"""The two estimates to propagate, with their forward models."""

import numpy as np
import xarray as xr

from softfinger.inference.motion import Move, move_paper_joint
from softfinger.propagation.config import SpreadConfig
from softfinger.propagation.new_trials import Source
from softfinger.propagation.populations import select_posterior, select_two_stage

BOUNDS = {"lower": 0.05, "upper": 0.95}


def gather_sources(
    least_squares: xr.Dataset,
    posterior: xr.DataTree,
    knobs: SpreadConfig,
    rng: np.random.Generator,
    move: Move,
) -> tuple[Source, Source]:
    """Gather two-stage estimate and posterior (moved by `move`)."""
    seeds = rng.integers(2**32, size=2).tolist()
    return (
        Source(select_two_stage(least_squares), move_paper_joint, knobs, seeds[0]),
        Source(select_posterior(posterior, knobs.draws), move, knobs, seeds[1]),
    )
