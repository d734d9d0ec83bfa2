"""From a search to a verdict."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.stats import norm

from softfinger.mechanics.effects.model import Entry
from softfinger.mismatch.decide import SURE, Posterior, join_ids
from softfinger.mismatch.free_form import FreeForm, fit_free_form
from softfinger.mismatch.jumps import Jumps, find_jumps
from softfinger.mismatch.lines import Line, find_line
from softfinger.mismatch.locate import (
    WINDOWS_S,
    find_window,
    list_trial_covariates,
    locate_within,
)
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
from softfinger.mismatch.verdict import FreeForm as FreeFormNote

MISSING = 1e-3  # p-value of a misfit from which something is missing
SCATTER_LEFT = 0.5  # of the excess: with more scatter than that left, effects are not it
SHAPE_LEFT = 0.25  # of what effects gain: with more than that left to a shape, they are not it
FALSE_DISCOVERIES = 0.05  # rate among located cells
LEAST_LEFT = float(np.log(10 / 0.01))  # nats that ten such terms exceed by chance in 1 %


class Findings(NamedTuple):
    """What is left besides the evidence of listed effects.

    Attributes
    ----------
    base_excess, base_p, best_excess, best_p
        Excess χ² within trials of the base and the best model, and its p-value.
    line
        The strongest spectral line that the best model leaves.
    jumps
        Jumps in single trials that it leaves.
    free
        The best free-form term on top of the best model; None where nothing calls for one.
    gain
        Gain [nats] of the best one or two listed effects over the base model.
    further
        What a third effect adds to that [nats].
    """

    base_excess: float
    base_p: float
    best_excess: float
    best_p: float
    line: Line
    jumps: Jumps
    free: FreeForm | None
    gain: float
    further: float

    @property
    def left(self) -> float:
        """Evidence [nats] for what two effects leave: a third, a shape, a line, or jumps."""
        free = 0.0 if self.free is None else self.free.gain
        return max(self.further, free, self.line.gain, self.jumps.gain)

    def is_unlisted(self, needed: float) -> bool:
        """Whether something is missing that one or two listed effects do not mostly explain.

        Scatter may be noise that was misjudged; evidence for a shape, a line or jumps is not, so
        less of that may be left.
        """
        scatter = self.best_p < MISSING
        scatter &= self.best_excess > SCATTER_LEFT * max(self.base_excess, 0.0)
        least = max(needed, LEAST_LEFT, SHAPE_LEFT * self.gain)
        return bool(scatter or self.left > least)


def examine(problem: Problem, search: Search, angles: xr.Dataset, *, needed: float) -> Findings:
    """Examine what the best model leaves: scatter, a line, a shape."""
    rows = problem.trials.size[problem.trials.protocol]
    base, best = (compute_excess(c, rows) for c in (search.base, search.best))
    time = angles.sel(trial=problem.trials.name)["time"].transpose("trial", "frame").values
    line = find_line(problem, compute_residual(problem, search.best, angles), time)
    free = fit_free_form(problem, search.best)
    free = free if free is not None and free.gain > needed else None
    few = [c for c in (search.base, search.best, *search.candidates) if _is_small(search, c)]
    best_few = max(c.log_evidence for c in few)
    gain = best_few - search.base.log_evidence
    further = max(search.best.log_evidence - best_few, 0.0)
    jumps = find_jumps(problem, search.best, angles)
    return Findings(*base, *best, line, jumps, free, gain, further)


def _is_small(search: Search, candidate: Candidate) -> bool:
    return candidate.fit is not None and len(candidate.model.ids - search.base.model.ids) <= 2


def conclude(
    problem: Problem,
    search: Search,
    posterior: Posterior,
    findings: Findings,
    angles: xr.Dataset,
    not_testable: list[str],
    needed: float,
) -> Verdict:
    """Write the verdict."""
    final = search.best
    decision = choose_decision(search, posterior, findings.is_unlisted(needed))
    effects = [] if decision == "adequate" else list_effects(problem, search, posterior, decision)
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
        not_testable=sorted(not_testable),
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


def list_effects(
    problem: Problem, search: Search, posterior: Posterior, decision: str
) -> list[Effect]:
    """Effects of the best model; under `ambiguous` also every member of the set."""
    final = search.best
    given = search.base.model.ids
    chosen = [(final, k) for k, p in enumerate(final.model.pieces) if p.effect.id not in given]
    if decision == "ambiguous":
        for ids in posterior.equivalent:
            other = posterior.best[ids]
            known = {c.model.pieces[k].effect.id for c, k in chosen}
            chosen += [
                (other, k)
                for k, piece in enumerate(other.model.pieces)
                if piece.effect.id not in known | given and other.fit is not None
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
    """Posterior of each parameter of one piece, under the names of the verdict."""
    sd = np.sqrt(np.diag(candidate.fit.shared_covariance))
    estimates = {}
    for k, entry in enumerate(candidate.model.entries):
        if entry.piece == number:
            name, estimate = estimate_entry(entry, float(candidate.fit.shared[k]), float(sd[k]))
            estimates[name] = estimate
    return estimates


def estimate_entry(entry: Entry, mean: float, sd: float) -> tuple[str, Estimate]:
    """Name and posterior of one number of φ; what is reported otherwise goes by its quantiles."""
    parameter = entry.parameter
    if parameter.report is None:
        return entry.name, (estimate_lognormal if parameter.log else estimate_normal)(mean, sd)
    name, convert = parameter.report
    joint = entry.place[0] if entry.place else -1
    places = np.clip(mean + sd * norm.ppf([0.05, 0.16, 0.5, 0.84, 0.95]), parameter.low, None)
    values = [convert(float(np.exp(x) if parameter.log else x), joint) for x in places]
    low, lower, middle, upper, high = sorted(values)
    estimate = Estimate(mean=middle, sd=(upper - lower) / 2, q05=low, q95=high)
    return name + entry.suffix, estimate


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
