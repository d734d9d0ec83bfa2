"""From a search to a verdict."""

import numpy as np
import xarray as xr

from softfinger.mismatch.decide import SURE, Posterior, join_ids
from softfinger.mismatch.describe import list_effects
from softfinger.mismatch.findings import Findings, weigh_against_shape
from softfinger.mismatch.free_form import FreeForm
from softfinger.mismatch.locate import WINDOWS_S, list_trial_covariates, locate_within
from softfinger.mismatch.problem import Candidate, Problem
from softfinger.mismatch.search import Search
from softfinger.mismatch.summary import compute_elpd, compute_residual, explain_spread
from softfinger.mismatch.verdict import FreeForm as FreeFormNote
from softfinger.mismatch.verdict import Location, ResidualRms, SetAside, Verdict

FALSE_DISCOVERIES = 0.05  # rate among located cells
LIKELY = 0.5  # probability from which an effect is stated to be a part of what is unlisted


def conclude(
    problem: Problem,
    search: Search,
    posterior: Posterior,
    findings: Findings,
    angles: xr.Dataset,
    hidden: set[str],
    needed: float,
) -> Verdict:
    """Write the verdict; `hidden` could not show alone, but may beside what was found."""
    final = search.best
    decision = choose_decision(search, posterior, findings.is_unlisted(needed))
    if decision == "unlisted" and search.best is not search.base:
        posterior = posterior.doubt(weigh_against_shape(search, findings))
    effects = [] if decision == "adequate" else list_effects(problem, search, posterior, decision)
    if decision == "unlisted":
        effects = [effect for effect in effects if effect.probability > LIKELY]
    location = effects[0].location if effects else None
    if decision == "unlisted":
        location = locate_misfit(problem, search.best, findings)
    rms = [
        float(np.sqrt(np.nanmean(compute_residual(problem, c, angles) ** 2)))
        for c in (search.base, final)
    ]
    noise = float(np.sqrt(np.mean(problem.noise["noise_sd"].values ** 2)))
    sets = posterior.equivalent
    return Verdict(
        campaign=str(angles.attrs.get("campaign", "")),
        decision=decision,
        effects=effects,
        equivalent=[[join_ids(ids) for ids in sets]] if decision == "ambiguous" else [],
        location=location,
        elpd=compute_elpd(problem, search.base, final),
        residual_rms_rad=ResidualRms(baseline=rms[0], final=rms[1], noise=noise),
        explained_spread={}
        if final is search.base
        else explain_spread(problem, search.base, final),
        not_testable=sorted(hidden - final.model.ids - {effect.id for effect in effects}),
        free_form=describe_free_form(findings.free) if decision == "unlisted" else None,
        n_trials=len(problem.trials.name),
        set_aside=list_set_aside(angles),
        next_experiment=None,
    )


def choose_decision(search: Search, posterior: Posterior, unlisted: bool) -> str:
    """Choose among adequate, named, ambiguous and unlisted."""
    if unlisted:
        return "unlisted"
    if search.best is search.base:
        return "adequate"
    top = next(iter(posterior.sets.values()))
    return "named" if top >= SURE else "ambiguous"


def describe_free_form(free: FreeForm | None) -> FreeFormNote | None:
    """Point to the free-form term."""
    if free is None:
        return None
    return FreeFormNote(argument=free.argument, joints=free.joints, artifact="free_form.nc")


def locate_misfit(problem: Problem, candidate: Candidate, findings: Findings) -> Location:
    """Where an unlisted misfit lies: between trials if its shape does, else in cells of time."""
    cells = locate_within(problem, candidate)
    p_value = cells["p_value"].fillna(1.0)
    joints = {
        str(int(j)): float(
            min(1.0, p_value.sel(joint=j).min() * cells["p_value"].sel(joint=j).count())
        )
        for j in cells["joint"].values
    }
    free, jumps = findings.free, findings.jumps
    slipped = bool(jumps.trials) and jumps.gain == findings.left
    between = free is not None and free.argument in list_trial_covariates(problem) and not slipped
    if slipped:
        joints = {name: 1e-3 if int(name) in jumps.joints else p for name, p in joints.items()}
    if between:
        joints = {name: 1e-3 if int(name) in free.joints else p for name, p in joints.items()}
    worst = cells["q_value"].fillna(1.0).min(("joint", "phase")).values
    hit = np.flatnonzero(worst < FALSE_DISCOVERIES)
    last = float(problem.setting.duration)
    times = (WINDOWS_S[hit[0]], min(WINDOWS_S[hit[-1] + 1], last)) if hit.size else None
    return Location(
        level="measurement" if slipped else "between_trials" if between else "within_trial",
        joints=joints,
        times_s=None if between else times,
        trials=jumps.trials if slipped else None,
        covariate=free.argument if between else None,
    )


def list_set_aside(angles: xr.Dataset) -> list[SetAside]:
    """Trials that were set aside before or by the selection of frames."""
    if "set_aside_reason" not in angles:
        return []
    return [
        SetAside(trial=str(name), reason=str(reason))
        for name, reason in zip(
            angles["set_aside_trial"].values, angles["set_aside_reason"].values, strict=True
        )
    ]
