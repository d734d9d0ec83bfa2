"""The hierarchical posterior of a campaign: prepare, sample, check predictions, lay out."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.estimation.blocks import sample_blocks
from softfinger.estimation.layout import build_tree, name_draws
from softfinger.estimation.leave_out import forget_trial, keep_trial, leave_trials_out
from softfinger.estimation.model import build_model, gather_data
from softfinger.estimation.sampling import (
    Density,
    compile_density,
    expand_points,
    sample_density,
    scale_points,
)
from softfinger.faults import Fault
from softfinger.population.collapse import collapse_angles
from softfinger.population.correlation import Covariance
from softfinger.population.frames import select_frames
from softfinger.population.integrate import compute_integrated_log_likelihood
from softfinger.population.outliers import find_outliers
from softfinger.population.pilot import Pilot, find_plausible_rates, fit_pilot
from softfinger.population.priors import Prior, build_prior
from softfinger.population.windows import LocalCollapse, localise_collapse

REFIT = {"chains": 2, "tune": 150, "draws": 200}  # enough for the mean of one trial's likelihood


class Preparation(NamedTuple):
    """Everything that is known of a campaign before sampling."""

    frames: xr.Dataset
    collapse: LocalCollapse
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
        The `estimation` block: sampler, chains, tune, draws, cores, target_accept, max_depth,
        covariance, predictive_draws.
    seed
        Of this stage's random stream.

    Returns
    -------
    DataTree
        ArviZ groups posterior, sample_stats, prior, prior_predictive, posterior_predictive,
        log_likelihood (per trial, its own parameters integrated out), leave_one_out,
        loo_pit, independence, prior_sensitivity, observed_data, constant_data. Attribute `note`
        says what so few data cannot tell.

    Raises
    ------
    Fault
        If nothing can be fitted: no usable frame, or no load.
    """
    rng = np.random.default_rng(seed)
    prepared = prepare_fit(angles)
    density = compile_fit(prepared, config)
    posterior, stats = sample_posterior(prepared, config, rng, density)
    scores = score_trials(prepared, density, posterior, config, rng)
    return build_tree(angles, prepared, posterior, stats, scores, config, rng)


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
        pilot = fit_pilot(collapse, prior, pilot)
    local = localise_collapse(collapse, *find_plausible_rates(collapse, pilot))
    coords = {name: angles[name].values for name in ("trial", "joint")}
    return Preparation(frames, local, prior, pilot, coords)


def sample_posterior(
    prepared: Preparation,
    config: Mapping[str, Any],
    rng: np.random.Generator,
    density: Density | None = None,
) -> tuple[xr.Dataset, xr.Dataset]:
    """Sample: the named variables of the posterior and the sampler's statistics.

    Parameters
    ----------
    prepared, config, rng
        As for `fit_posterior`.
    density
        Compiled for a campaign of the same trials and joints.

    Raises
    ------
    Fault
        If blocks are asked for parameters that go together.
    """
    if config["sampler"] == "blocks":
        _refuse_covariance(config["covariance"])
        variables, stats = sample_blocks(
            prepared.collapse, prepared.prior, prepared.pilot, rng,
            **{name: config[name] for name in ("chains", "tune", "draws", "cores")},
        )  # fmt: skip
        return name_draws(variables, prepared.coords), stats
    density = compile_fit(prepared, config) if density is None else density
    data = gather_data(prepared.collapse, prepared.pilot)
    points, stats = sample_density(
        density,
        scale_points(density.shapes, prepared.pilot, data["resolution"]),
        chains=config["chains"],
        tune=config["tune"],
        draws=config["draws"],
        cores=config["cores"],
        target_accept=config["target_accept"],
        max_depth=config["max_depth"],
        rng=rng,
        data={name: data[name] for name in density.data if name in data},
    )
    variables = expand_points(
        points,
        density.shapes,
        prepared.prior,
        prepared.pilot,
        data["resolution"],
        config["covariance"],
    )
    return name_draws(variables, prepared.coords), stats


def _refuse_covariance(covariance: Covariance) -> None:
    if covariance != "independent":
        raise Fault(
            f"estimation: covariance is {covariance}, but sampler blocks draws independent "
            "parameters only; set sampler: nuts, or covariance: independent"
        )


def compile_fit(prepared: Preparation, config: Mapping[str, Any]) -> Density | None:
    """Compile the model of a campaign, where the sampler needs it."""
    _, collapse, prior, pilot, coords = prepared
    if config["sampler"] == "blocks":
        return None
    return compile_density(build_model(collapse, prior, pilot, coords, config["covariance"]))


def score_trials(
    prepared: Preparation,
    density: Density | None,
    posterior: xr.Dataset,
    config: Mapping[str, Any],
    rng: np.random.Generator,
) -> tuple[xr.DataArray, xr.Dataset, list[xr.Dataset]]:
    """Compute log p(y_i | population, noise) of every draw, and leave every trial out.

    The scores of `leave_trials_out` follow, and for every trial what the others say.
    """
    collapse, pilot = prepared.collapse, prepared.pilot
    recording = compute_integrated_log_likelihood(collapse, pilot.modes, posterior, rng)

    def refit(trial: int) -> tuple[xr.Dataset, NDArray[np.float64]]:
        less, unaware = forget_trial(collapse, pilot, prepared.prior, trial)
        left = prepared._replace(collapse=less, pilot=unaware)
        draws, _ = sample_posterior(left, {**config, **REFIT}, rng, density)
        alone = keep_trial(collapse, pilot.modes, trial)
        draws = draws.isel(trial=[trial])
        return draws, compute_integrated_log_likelihood(*alone, draws, rng).values

    (spawned,) = rng.spawn(1)
    return recording, *leave_trials_out(recording, posterior, refit, spawned)
