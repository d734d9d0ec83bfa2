"""The hierarchical posterior of a campaign."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.inference.bounded import place_effects
from softfinger.inference.budget import BUDGET
from softfinger.inference.correction import Correction, correct_draws
from softfinger.inference.correlation import Covariance
from softfinger.inference.density import Effects, Given, build_pymc_model
from softfinger.inference.disturbed import admit_found, admit_known
from softfinger.inference.expansion import Expansion, expand_fit, forget_trial, keep_trial
from softfinger.inference.gibbs import sample_gibbs
from softfinger.inference.integrate import compute_integrated_log_likelihood
from softfinger.inference.layout import build_tree, name_draws
from softfinger.inference.leave_out import leave_trials_out
from softfinger.inference.mixed_effects_laplace import Fit
from softfinger.inference.predictive import Recorded
from softfinger.inference.problem import Candidate, Problem, pose_problem
from softfinger.inference.sampling import (
    Density,
    compile_density,
    expand_points,
    sample_density,
    scale_points,
)
from softfinger.inference.whitening import read_trials
from softfinger.mechanics.effects.measurement_file import MeasurementEntry
from softfinger.mechanics.effects.model import EffectModel
from softfinger.mechanics.effects.model_file import ModelFile

REFIT = {
    "chains": BUDGET.refit_chains,
    "tune": BUDGET.refit_tune,
    "draws": BUDGET.refit_draws,
}


class Preparation(NamedTuple):
    """Everything that is known of a campaign before sampling."""

    recorded: Recorded
    given: Given
    coords: dict[str, NDArray]

    @property
    def sigma(self) -> NDArray[np.float64]:
        """Sd (d,) of the population, about."""
        return np.sqrt(np.diag(self.recorded.candidate.fit.omega))


def fit_posterior(
    angles: xr.Dataset,
    config: Mapping[str, Any],
    seed: int,
    content: ModelFile | None = None,
    *,
    priors: bool = True,
) -> xr.DataTree:
    """Fit the hierarchical model of all trials.

    Parameters
    ----------
    config
        The `estimation` block: sampler, chains, tune, draws, cores, target_accept, max_depth,
        covariance, predictive_draws.
    content
        A model file; without it the paper's model.
    priors
        Whether the file's priors count; they do not where they come from these recordings.

    Returns
    -------
    DataTree
        ArviZ groups posterior, sample_stats, prior, prior_predictive, posterior_predictive,
        log_likelihood (per trial, its own parameters integrated out), leave_one_out,
        loo_pit, independence, prior_sensitivity, observed_data, constant_data. Attribute `note`
        describes what so few data cannot show.

    Raises
    ------
    Fault
        If nothing can be fitted: no usable frame, or no load.
    """
    rng = np.random.default_rng(seed)
    prepared = prepare_fit(angles, content, priors=priors)
    density = compile_fit(prepared, config)
    drawn, stats = draw_points(prepared, config, rng, density)
    found = correct_posterior(prepared, drawn, rng)
    posterior = name_draws(take_draws(drawn, found), prepared.coords, prepared.recorded)
    scores = score_trials(prepared, density, posterior, config, rng)
    return build_tree(prepared, posterior, stats, found, scores, config, rng)


def prepare_fit(
    angles: xr.Dataset, content: ModelFile | None = None, *, priors: bool = True
) -> Preparation:
    """Fit and expand the model; set the priors.

    The angles are set right already by what the file states of their `measurement`. Where none
    states it, the noise includes what the model's own residual shows of log, clock and picture.
    """
    problem, fit = pose_problem(angles, content, priors=priors)
    spreads = {} if content is None else content.spreads
    if content is None or (priors and content.measurement is None):  # no diagnosis of these
        few = choose_some(angles)
        posed = (problem, fit) if few is angles else pose_problem(few, content, priors=priors)
        problem, fit = admit_found(problem, fit, posed, spreads)
    else:
        known = content.measurement or MeasurementEntry()
        problem, fit = admit_known(problem, fit, {**known.disturbances, **spreads})
    return prepare_candidate(angles, problem, Candidate(problem.base, fit, fit.log_evidence))


def choose_some(angles: xr.Dataset) -> xr.Dataset:
    """Choose trials in which disturbances are sought, evenly."""
    number = angles.sizes["trial"]
    if number <= BUDGET.disturbed_trials:
        return angles
    places = np.linspace(0, number - 1, BUDGET.disturbed_trials).astype(int)
    return angles.isel(trial=places)


def prepare_candidate(angles: xr.Dataset, problem: Problem, candidate: Candidate) -> Preparation:
    """Expand a fitted model, and set the priors."""
    known = angles.sel(trial=problem.trials.name)
    frames = problem.noise.sel(trial=problem.trials.name)
    prior = problem.population
    size, kind = problem.trials.size, problem.trials.protocol
    expansion = expand_fit(
        candidate.fit,
        problem.build_prior(candidate.model),
        size[kind],
        problem.trials.logdet,
    )
    given = Given(
        expansion,
        prior,
        describe_effects(candidate.model, candidate.fit),
        *read_trials(expansion.curvature, expansion.pull, prior),
    )
    coords = {
        "trial": np.array(problem.trials.name),
        "joint": angles["joint"].values,
        "effect_parameter": np.array(given.effects.names, str),
    }
    return Preparation(Recorded(problem, candidate, known, frames), given, coords)


def describe_effects(model: EffectModel, fit: Fit) -> Effects:
    """Names, priors, bounds and fit of φ."""
    names = [f"{model.pieces[e.piece].effect.id}.{e.name}" for e in model.entries]
    bounded = place_effects(fit.shared, fit.shared_covariance, model.low, model.high)
    return Effects(names, *model.shared_prior, bounded)


def compile_fit(prepared: Preparation, config: Mapping[str, Any]) -> Density | None:
    """Compile the density, which Gibbs does without."""
    if config["sampler"] == "gibbs":
        return None
    return compile_density(build_pymc_model(prepared.given, prepared.coords, config["covariance"]))


def draw_points(
    prepared: Preparation,
    config: Mapping[str, Any],
    rng: np.random.Generator,
    density: Density | None,
    given: Given | None = None,
) -> tuple[dict[str, NDArray[np.float64]], xr.Dataset]:
    """Sample the expanded model.

    Returns its variables (chain, draw, …) and the sampler's statistics.

    Parameters
    ----------
    density
        Compiled for a campaign of the same trials and joints.
    given
        Replaces what the campaign gives, one trial less.
    """
    given = prepared.given if given is None else given
    if config["sampler"] == "gibbs":
        refuse_covariance(config["covariance"])
        size = {name: config[name] for name in ("chains", "tune", "draws", "cores")}
        return sample_gibbs(given, prepared.sigma, rng, **size)
    points, stats = sample_density(
        density,
        scale_points(density.shapes, given, prepared.sigma),
        chains=config["chains"],
        tune=config["tune"],
        draws=config["draws"],
        cores=config["cores"],
        target_accept=config["target_accept"],
        max_depth=config["max_depth"],
        rng=rng,
        data=density.choose_data(given),
    )
    return expand_points(points, density.shapes, given, config["covariance"]), stats


def refuse_covariance(covariance: Covariance) -> None:
    """Refuse correlated parameters, which Gibbs sampling cannot draw."""
    if covariance != "independent":
        raise Fault(
            f"estimation: covariance is {covariance}, but sampler gibbs draws independent "
            "parameters only; set sampler: nuts, or covariance: independent"
        )


def correct_posterior(
    prepared: Preparation, drawn: dict[str, NDArray[np.float64]], rng: np.random.Generator
) -> Correction:
    """Weigh the draws by the full model."""
    problem, candidate = prepared.recorded.problem, prepared.recorded.candidate
    return correct_draws(problem, candidate, prepared.given.expansion, drawn, rng)


def take_draws(
    drawn: dict[str, NDArray[np.float64]], found: Correction
) -> dict[str, NDArray[np.float64]]:
    """Put draws (chain, draw, …) where weighing wants."""
    if np.array_equal(found.kept, np.tile(np.arange(drawn["mu"].shape[1]), (len(found.kept), 1))):
        return drawn  # without a copy: of 10 000 trials the draws take gigabytes
    chain = np.arange(len(found.kept))[:, None]
    return {name: values[chain, found.kept] for name, values in drawn.items()}


def sample_posterior(
    prepared: Preparation,
    config: Mapping[str, Any],
    rng: np.random.Generator,
    density: Density | None = None,
) -> tuple[xr.Dataset, xr.Dataset]:
    """Sample and weigh; named variables and statistics."""
    density = compile_fit(prepared, config) if density is None else density
    drawn, stats = draw_points(prepared, config, rng, density)
    kept = take_draws(drawn, correct_posterior(prepared, drawn, rng))
    return name_draws(kept, prepared.coords, prepared.recorded), stats


def score_trials(
    prepared: Preparation,
    density: Density | None,
    posterior: xr.Dataset,
    config: Mapping[str, Any],
    rng: np.random.Generator,
) -> tuple[xr.DataArray, xr.Dataset, list[xr.Dataset]]:
    """Score every trial, and leave each one out.

    Computes log p(y_i | population, effects, noise) of every draw.

    The scores of `leave_trials_out` follow, then for every trial what the others make likely.
    """
    expansion: Expansion = prepared.given.expansion
    recording = compute_integrated_log_likelihood(expansion, posterior, rng)

    def refit(trial: int) -> tuple[xr.Dataset, NDArray[np.float64]]:
        less = forget_trial(expansion, trial)
        value, variance = read_trials(less.curvature, less.pull, prepared.given.prior)
        given = prepared.given._replace(expansion=less, value=value, variance=variance)
        drawn, _ = draw_points(prepared, {**config, **REFIT}, rng, density, given)
        draws = name_draws(drawn, prepared.coords, prepared.recorded).isel(trial=[trial])
        alone = keep_trial(expansion, trial)
        return draws, compute_integrated_log_likelihood(alone, draws, rng).values

    (spawned,) = rng.spawn(1)
    return recording, *leave_trials_out(recording, posterior, refit, spawned)
