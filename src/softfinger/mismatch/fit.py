"""The fit of a model with effects, laid out as the artifact `posterior`."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from softfinger.mechanics.effects.model_file import ModelFile
from softfinger.mismatch.mcmc import Size, sample_effects
from softfinger.mismatch.mcmc_draws import name_effect_draws
from softfinger.mismatch.problem import Candidate, pose_problem


def fit_effects(
    angles: xr.Dataset, content: ModelFile, config: Mapping[str, Any], seed: int, *, priors: bool
) -> xr.DataTree:
    """Sample the hierarchical posterior of a model with effects.

    Parameters
    ----------
    angles
        The `angles` artifact.
    content
        The model file.
    config
        The `estimation` block: chains, tune, draws.
    priors
        Whether the file's priors count; they do not where they come from these recordings.

    Returns
    -------
    DataTree
        Groups posterior, which also holds `effect` (chain, draw, effect_parameter), and
        sample_stats. The noise's covariance is the estimate without a model, but for its size.
    """
    problem, fit = pose_problem(angles, content, priors=priors)
    candidate = Candidate(problem.base, fit, fit.log_evidence)
    size = Size(config["chains"], config["tune"], config["draws"])
    draws, accepted = sample_effects(problem, candidate, size, np.random.default_rng(seed))
    posterior = name_effect_draws(problem, candidate, draws)
    dims = ("chain", "draw")
    stats = {
        "diverging": (dims, np.zeros(accepted.shape, bool)),
        "acceptance_rate": (dims, accepted),
    }
    coords = {name: posterior[name] for name in dims}
    return xr.DataTree.from_dict(
        {"posterior": posterior, "sample_stats": xr.Dataset(stats, coords)}
    )
