"""From a search to a verdict."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.stats import norm

from softfinger.mismatch.decide import SURE, Posterior, join_ids
from softfinger.mismatch.locate import WINDOWS_S, find_window, locate_within
from softfinger.mismatch.problem import Problem
from softfinger.mismatch.rank import Candidate
from softfinger.mismatch.search import Search
from softfinger.mismatch.statements import state_effect
from softfinger.mismatch.summary import (
    compute_elpd,
    compute_excess,
    compute_residual,
    explain_spread,
)
from softfinger.mismatch.verdict import (
    Effect,
    Estimate,
    Location,
    ResidualRms,
    SetAside,
    Verdict,
    estimate_lognormal,
    estimate_normal,
)

MISSING = 1e-3  # p-value of a misfit from which something is missing
EXPLAINED = 0.5  # share of the base model's excess χ² that listed effects must explain


class Findings(NamedTuple):
    """What the tests say besides the evidence: excess χ² of base and best model."""

    base_excess: float
    base_p: float
    best_excess: float
    best_p: float

    @property
    def unexplained(self) -> bool:
        """Whether something is missing that the best model does not explain by half."""
        if self.best_p > MISSING:
            return False
        return self.best_excess > (1 - EXPLAINED) * max(self.base_excess, 0.0)


def test_misfit(problem: Problem, search: Search) -> Findings:
    """Test what base and best model leave within trials."""
    rows = problem.trials.size[problem.trials.protocol]
    return Findings(*compute_excess(search.base, rows), *compute_excess(search.best, rows))


def conclude(
    problem: Problem,
    search: Search,
    posterior: Posterior,
    findings: Findings,
    angles: xr.Dataset,
    not_testable: list[str],
) -> Verdict:
    """Write the verdict."""
    final = search.best
    decision = choose_decision(search, posterior, findings)
    effects = [] if decision == "adequate" else list_effects(problem, search, posterior, decision)
    location = effects[0].location if effects else None
    if decision == "unlisted" and location is None:
        location = locate_misfit(problem, search.base)
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
        not_testable=sorted(not_testable),
        free_form=None,
        n_trials=len(problem.trials.name),
        set_aside=list_set_aside(angles),
        next_experiment=None,
    )


def choose_decision(search: Search, posterior: Posterior, findings: Findings) -> str:
    """Choose among adequate, named, ambiguous and unlisted."""
    if findings.unexplained:
        return "unlisted"
    if search.best is search.base:
        return "adequate"
    top = next(iter(posterior.sets.values()))
    return "named" if top >= SURE else "ambiguous"


def list_effects(
    problem: Problem, search: Search, posterior: Posterior, decision: str
) -> list[Effect]:
    """Effects of the best model; under `ambiguous` also every member of the set."""
    final = search.best
    chosen = [(final, piece) for piece in range(len(final.model.pieces))]
    if decision == "ambiguous":
        for ids in posterior.equivalent:
            other = posterior.best[ids]
            known = {c.model.pieces[k].effect.id for c, k in chosen}
            chosen += [
                (other, k)
                for k, piece in enumerate(other.model.pieces)
                if piece.effect.id not in known and other.fit is not None
            ]
    effects = [describe(problem, search.base, c, k, posterior) for c, k in chosen]
    return sorted(effects, key=lambda effect: -effect.probability)


def describe(
    problem: Problem, base: Candidate, candidate: Candidate, number: int, posterior: Posterior
) -> Effect:
    """Describe one effect of a model."""
    piece = candidate.model.pieces[number]
    parameters = estimate_parameters(candidate, number)
    probability = min(1.0, posterior.inclusion[piece.effect.id])
    return Effect(
        id=piece.effect.id,
        joints=piece.joints,
        probability=probability,
        parameters=parameters,
        statement=state_effect(
            piece.effect, piece.form.name, piece.joints, probability, parameters
        ),
        location=locate_effect(problem, base, candidate, number),
    )


def estimate_parameters(candidate: Candidate, number: int) -> dict[str, Estimate]:
    """Posterior of each parameter of one piece."""
    sd = np.sqrt(np.diag(candidate.fit.shared_covariance))
    estimates = {}
    for k, entry in enumerate(candidate.model.entries):
        if entry.piece == number:
            build = estimate_lognormal if entry.parameter.log else estimate_normal
            estimates[entry.name] = build(float(candidate.fit.shared[k]), float(sd[k]))
    return estimates


def locate_effect(problem: Problem, base: Candidate, candidate: Candidate, number: int) -> Location:
    """Where one effect acts: the p-value of each joint that its amplitudes have."""
    piece = candidate.model.pieces[number]
    sd = np.sqrt(np.diag(candidate.fit.shared_covariance))
    joints = {str(j + 1): 1.0 for j in range(problem.trials.joints)}
    for k, entry in enumerate(candidate.model.entries):
        if entry.piece == number and entry.parameter.amplitude:
            tail = 2 * norm.sf(abs(candidate.fit.shared[k]) / sd[k])
            tail = float(min(1.0, max(tail, 1e-300) * problem.trials.joints))
            touched = [entry.place[0]] if entry.place else range(problem.trials.joints)
            for j in touched:
                joints[str(j + 1)] = min(joints[str(j + 1)], tail)
    between = piece.effect.level == "between_trials"
    return Location(
        level=piece.effect.level,
        joints=joints,
        times_s=None if between else find_window(problem, base, candidate),
        trials=None,
        covariate=name_covariate(piece) if between else None,
    )


def name_covariate(piece: object) -> str:
    """What a between-trials effect moves with."""
    return piece.form.covariate or "trial_number"


def locate_misfit(problem: Problem, candidate: Candidate) -> Location:
    """Where an unlisted misfit lies: the joints' cells and their time since the change of load."""
    cells = locate_within(problem, candidate)
    p_value = cells["p_value"].fillna(1.0)
    joint = {
        str(int(j)): float(min(1.0, p_value.sel(joint=j).min() * p_value.sel(joint=j).count()))
        for j in cells["joint"].values
    }
    worst = cells["q_value"].fillna(1.0).min(("joint", "phase")).values
    hit = np.flatnonzero(worst < 0.05)
    last = float(problem.setting.duration)
    times = (WINDOWS_S[hit[0]], min(WINDOWS_S[hit[-1] + 1], last)) if hit.size else None
    return Location(level="within_trial", joints=joint, times_s=times, trials=None, covariate=None)


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
