"""From a search to a verdict."""

import numpy as np
import xarray as xr

from softfinger.artifacts.verdict import (
    FreeFormNote,
    Location,
    Remaining,
    ResidualRms,
    SetAside,
    StatedEffect,
    Verdict,
)
from softfinger.inference.problem import Candidate, Problem
from softfinger.mismatch.checks.findings import Findings, weigh_against_shape
from softfinger.mismatch.checks.free_form import FreeForm
from softfinger.mismatch.checks.locate import list_trial_covariates, locate_within
from softfinger.mismatch.checks.summary import compute_elpd, compute_residual, explain_spread
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.priors import PRIORS
from softfinger.mismatch.search.settle import Posterior, join_ids
from softfinger.mismatch.search.stepwise import Search
from softfinger.mismatch.verdict.estimates import state_effects
from softfinger.mismatch.verdict.explained import list_explained, list_not_tried
from softfinger.mismatch.verdict.sufferings import describe_measurement

NO_FRAME = "too few frames can be used: the others are missing, flagged, repeated or gross errors"


def conclude(
    problem: Problem,
    search: Search,
    posterior: Posterior,
    findings: Findings,
    angles: xr.Dataset,
    hidden: set[str],
    refused: dict[str, str],
    needed: float,
) -> Verdict:
    """Write the verdict.

    `hidden` could not show alone, but may beside what was found; `refused` was not tried.
    """
    final = search.best
    decision = choose_decision(search, posterior, findings.is_unlisted(needed))
    if decision == "unlisted" and search.best is not search.base:
        real = PRIORS.listed if posterior.needs_many else 1.0
        posterior = posterior.doubt(real * weigh_against_shape(search, findings))
    effects = [] if decision == "adequate" else state_effects(problem, search, posterior, decision)
    if decision == "unlisted":
        effects = [effect for effect in keep_likely(effects) if effect.id not in findings.turned]
    location = effects[0].location if effects else None
    if decision == "unlisted":  # what has turned back explains nothing
        location = locate_misfit(problem, search.base if findings.turned else final, findings)
    sets = posterior.equivalent
    return Verdict(
        campaign=str(angles.attrs.get("campaign", "")),
        decision=decision,
        effects=effects,
        equivalent=[[join_ids(ids) for ids in sets]] if decision == "ambiguous" else [],
        location=location,
        elpd=compute_elpd(problem, search.base, final),
        residual_rms_rad=_measure_residuals(problem, search, angles),
        explained_spread={}
        if final is search.base
        else explain_spread(problem, search.base, final),
        not_testable=sorted(
            {*hidden, *refused} - final.model.ids - {effect.id for effect in effects}
        ),
        free_form=describe_free_form(findings.free) if decision == "unlisted" else None,
        n_trials=len(problem.trials.name),
        set_aside=list_set_aside(angles, problem.trials.name),
        next_experiment=None,
        measurement=describe_measurement(problem.noise),
        explained=[]
        if decision == "adequate"
        else list_explained(problem, search, posterior, needed),
        remaining=describe_remaining(problem, final, findings),
        not_tried=list_not_tried(refused),
    )


def _measure_residuals(problem: Problem, search: Search, angles: xr.Dataset) -> ResidualRms:
    baseline, final = (
        float(np.sqrt(np.nanmean(compute_residual(problem, c, angles) ** 2)))
        for c in (search.base, search.best)
    )
    noise = float(np.sqrt(np.mean(problem.noise["noise_sd"].values ** 2)))
    return ResidualRms(baseline=baseline, final=final, noise=noise)


def keep_likely(effects: list[StatedEffect]) -> list[StatedEffect]:
    """Keep the effects likely in what is unlisted."""
    return [effect for effect in effects if effect.probability > DECISIONS.likely]


def choose_decision(search: Search, posterior: Posterior, unlisted: bool) -> str:
    """Choose among adequate, named, ambiguous and unlisted."""
    if unlisted or posterior.needs_many:
        return "unlisted"
    if search.best is search.base:
        return "adequate"
    top = next(iter(posterior.sets.values()))
    return "named" if top >= DECISIONS.sure else "ambiguous"


def describe_remaining(problem: Problem, candidate: Candidate, findings: Findings) -> Remaining:
    """Share of χ² that the final model leaves.

    It is within trials, over what the noise alone leaves; also where most of it is.
    """
    cells = locate_within(problem, candidate)
    place = cells["q_value"].fillna(1.0).stack(cell=("joint", "phase", "window"))
    worst = place[int(np.argmin(place.values))]
    where = "nowhere more than by chance"
    if float(worst) < DECISIONS.false_discoveries:
        joint, phase, since = worst["cell"].item()
        where = f"{phase}, from {since:g} s after a change of load"
        where = where if problem.setting.specimen else f"joint {joint}, {where}"
    rms = float(np.sqrt(max(1.0 + findings.excess, 0.0)))
    return Remaining(rms_over_noise=rms, p_value=findings.p_value, where=where)


def describe_free_form(free: FreeForm | None) -> FreeFormNote | None:
    """Point to the free-form term."""
    if free is None:
        return None
    return FreeFormNote(argument=free.argument, joints=free.joints, artifact="free_form.nc")


def locate_misfit(problem: Problem, candidate: Candidate, findings: Findings) -> Location:
    """Where an unlisted misfit lies.

    Between trials if its shape does, else in cells of time.

    A slip or a shape has a Bayes factor, whose inverse bounds a p-value (Vovk and Wang 2021, Ann.
    Stat. 49, 1736): without it, evidence so large comes in no more than that share of campaigns.
    """
    cells = locate_within(problem, candidate)
    p_value = cells["p_value"].fillna(1.0)
    joints = {
        str(int(j)): float(
            min(1.0, p_value.sel(joint=j).min() * cells["p_value"].sel(joint=j).count())
        )
        for j in cells["joint"].values
    }
    free, slips = findings.free, findings.slips
    slipped = bool(slips.trials) and slips.gain == findings.left
    between = free is not None and free.argument in list_trial_covariates(problem) and not slipped
    shown = slips if slipped else free if between else None
    if shown is not None:
        bound = float(np.exp(-max(shown.gain, 0.0)))
        joints |= {str(j): min(bound, joints[str(j)]) for j in shown.joints}
    worst = cells["q_value"].fillna(1.0).min(("joint", "phase")).values
    hit = np.flatnonzero(worst < DECISIONS.false_discoveries)
    last = float(problem.setting.duration)
    edges = DECISIONS.windows_s
    times = (edges[hit[0]], min(edges[hit[-1] + 1], last)) if hit.size else None
    return Location(
        level="measurement" if slipped else "between_trials" if between else "within_trial",
        joints=joints,
        times_s=None if between else times,
        trials=slips.trials if slipped else None,
        covariate=free.argument if between else None,
    )


def list_set_aside(angles: xr.Dataset, used: list[str]) -> list[SetAside]:
    """Trials set aside before, or without informing frames."""
    silent = [str(name) for name in angles["trial"].values if str(name) not in used]
    nothing = [SetAside(trial=name, reason=NO_FRAME) for name in silent]
    if "set_aside_reason" not in angles:
        return nothing
    return nothing + [
        SetAside(trial=str(name), reason=str(reason))
        for name, reason in zip(
            angles["set_aside_trial"].values, angles["set_aside_reason"].values, strict=True
        )
    ]
