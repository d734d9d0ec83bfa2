"""A verdict's parameters by sampling, not curvature."""

from typing import Any, NamedTuple

import arviz_stats as az  # ArviZ without its plots, which take long to import
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.artifacts.verdict import Estimate, StatedEffect, Verdict
from softfinger.inference.posterior import prepare_candidate, sample_posterior
from softfinger.mechanics.effects.model import Entry
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.diagnose import Diagnosis
from softfinger.mismatch.verdict.law import state_candidate_curves
from softfinger.mismatch.verdict.statements import state_effect
from softfinger.units import read_units

SAMPLING: dict[str, Any] = {
    "sampler": "nuts",
    "covariance": "independent",
    "chains": BUDGET.chains,
    "tune": BUDGET.tune,
    "draws": BUDGET.kept_draws,
    "cores": BUDGET.cores,
    "target_accept": BUDGET.target_accept,
    "max_depth": BUDGET.max_depth,
}


class Refined(NamedTuple):
    """A verdict and φ's largest R-hat, maybe NaN."""

    verdict: Verdict
    r_hat: float


def refine_verdict(
    diagnosis: Diagnosis, angles: xr.Dataset, rng: np.random.Generator, r_hat_max: float
) -> Refined:
    """Sample the best model for its effects' parameters.

    The verdict stays as it is where nothing was left out, or where the chains do not agree.

    Parameters
    ----------
    r_hat_max
        Beyond it the chains do not agree, and the fit's curvature stays.
    """
    best, verdict = diagnosis.search.best, diagnosis.verdict
    if not verdict.effects or not best.model.pieces:
        return Refined(verdict, float("nan"))
    prepared = prepare_candidate(angles, diagnosis.problem, best)
    posterior, _ = sample_posterior(prepared, SAMPLING, rng)
    effect = posterior["effect_internal"]
    r_hat = float(az.rhat(effect.to_dataset(name="effect"))["effect"].max())
    if not r_hat < r_hat_max:
        return Refined(verdict, r_hat)
    draws = effect.transpose("effect_parameter", "chain", "draw").values
    found: dict[str, dict[str, Estimate]] = {}
    for entry, internal in zip(best.model.entries, draws, strict=True):
        estimates = estimate_draws(entry, internal.ravel())
        found.setdefault(best.model.pieces[entry.piece].effect.id, {}).update(estimates)
    pieces = {piece.effect.id: k for k, piece in enumerate(best.model.pieces)}

    def refine(effect: StatedEffect) -> StatedEffect:
        if effect.id not in found or set(effect.parameters) != set(found[effect.id]):
            return effect
        piece = best.model.pieces[pieces[effect.id]]
        words = state_effect(
            piece.effect,
            piece.form.name,
            effect.joints,
            effect.probability,
            found[effect.id],
            effect.spread,
            state_candidate_curves(diagnosis.problem, best, pieces[effect.id]),
            read_units(diagnosis.problem.noise.attrs),
        )
        return effect.model_copy(update={"parameters": found[effect.id], "statement": words})

    effects = [refine(effect) for effect in verdict.effects]
    return Refined(verdict.model_copy(update={"effects": effects}), r_hat)


def estimate_draws(entry: Entry, internal: NDArray[np.float64]) -> dict[str, Estimate]:
    """Posterior of one number of φ, from draws.

    It goes by name; draws (n,) are on the internal scale.
    """
    estimates = {}
    for name, values in entry.report(internal).items():
        low, high = np.quantile(values, (0.05, 0.95))
        estimates[name] = Estimate(
            mean=float(values.mean()), sd=float(values.std(ddof=1)), q05=float(low), q95=float(high)
        )
    return estimates
