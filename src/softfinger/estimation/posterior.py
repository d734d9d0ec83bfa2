"""The hierarchical posterior of a campaign: prepare, sample, check predictions, lay out."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.estimation.layout import build_tree, name_draws
from softfinger.estimation.model import build_model
from softfinger.estimation.sampling import (
    compile_density,
    draw_starts,
    expand_points,
    sample_density,
)
from softfinger.population.collapse import Collapse, collapse_angles, restrict_collapse
from softfinger.population.frames import select_frames
from softfinger.population.outliers import find_outliers
from softfinger.population.pilot import Pilot, find_plausible_rates, fit_pilot
from softfinger.population.priors import Prior, build_prior


class Preparation(NamedTuple):
    """Everything that is known of a campaign before sampling."""

    frames: xr.Dataset
    collapse: Collapse
    prior: Prior
    pilot: Pilot
    coords: dict[str, NDArray]


def fit_posterior(angles: xr.Dataset, config: Mapping[str, Any], seed: int) -> xr.DataTree:
    """Fit the hierarchical model of all trials.

    Parameters
    ----------
    angles
        The `angles` artifact.
    config
        The `estimation` block: chains, tune, draws, cores, predictive_draws.
    seed
        Of this stage's random stream.

    Returns
    -------
    DataTree
        ArviZ groups posterior, sample_stats, prior, prior_predictive, posterior_predictive,
        log_likelihood (per trial, its own parameters integrated out), observed_data,
        constant_data. Attribute `note` says what so few data cannot tell.

    Raises
    ------
    Fault
        If nothing can be fitted: no usable frame, or no load.
    """
    rng = np.random.default_rng(seed)
    prepared = prepare_fit(angles)
    posterior, stats = sample_posterior(prepared, config, rng)
    return build_tree(angles, prepared, posterior, stats, config, rng)


def prepare_fit(angles: xr.Dataset) -> Preparation:
    """Select frames, collapse the likelihood, set the priors and run the pilot fit.

    Outliers against a first pilot fit are left out of the second: what they are is frozen before
    sampling, and kept in `frames` as `outlier` (trial, frame).
    """
    frames = select_frames(angles)
    prior = build_prior(angles, frames)
    collapse = collapse_angles(angles, frames)
    pilot = fit_pilot(collapse, prior)
    outlier = find_outliers(angles, frames, pilot)
    frames = frames.assign(outlier=outlier, used=frames["used"] & ~outlier)
    if outlier.any():
        collapse = collapse_angles(angles, frames)
        pilot = fit_pilot(collapse, prior)
    collapse = restrict_collapse(collapse, *find_plausible_rates(collapse, pilot))
    coords = {name: angles[name].values for name in ("trial", "joint")}
    return Preparation(frames, collapse, prior, pilot, coords)


def sample_posterior(
    prepared: Preparation, config: Mapping[str, Any], rng: np.random.Generator
) -> tuple[xr.Dataset, xr.Dataset]:
    """Sample: the named variables of the posterior and the sampler's statistics."""
    model = build_model(prepared.collapse, prepared.prior, prepared.pilot, prepared.coords)
    density = compile_density(model)
    points, stats = sample_density(
        density,
        draw_starts(density.shapes, prepared.pilot),
        chains=config["chains"],
        tune=config["tune"],
        draws=config["draws"],
        cores=config["cores"],
        rng=rng,
    )
    variables = expand_points(points, density.shapes, prepared.prior, prepared.pilot)
    return name_draws(variables, prepared.coords), stats
