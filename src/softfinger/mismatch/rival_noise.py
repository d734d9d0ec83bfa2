"""Noise as a rival explanation: what a model leaves may be noise that lasts longer than it seemed.

Noise seen in quiet windows says little of its slow part. Where even the best model leaves more than
that noise, or where an effect gains little once noise may last longer, each leading model is judged
with the noise that its own residual asks for (an AR(1) process per joint), as long as the quiet
windows allow it. What then still stands out is no noise.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import xarray as xr

from softfinger.mismatch.problem import LAYOUT, Candidate, Problem
from softfinger.mismatch.search import Search
from softfinger.mismatch.summary import compute_residual
from softfinger.mismatch.trials import prepare_trials
from softfinger.population.mixed_effects_laplace import SHARE
from softfinger.population.noise import compare_noise, estimate_residual_noise

UNBELIEVABLE = 1e-3  # p-value from which quiet windows refuse a noise
TOLERANCE = 0.02  # nats within which a refit is at rest
FINALISTS = 6  # sets of effects that are judged anew


class Judged(NamedTuple):
    """A model with noise of its own: the problem with that noise, and its log evidence [nats].

    The noise's own level counts, so that models with different noise compare.
    """

    problem: Problem
    candidate: Candidate
    evidence: float


def may_be_noise(problem: Problem, search: Search, angles: xr.Dataset, needed: float) -> bool:
    """Whether effects gain at most `needed` nats once every model has noise of its own."""
    simpler: dict[frozenset[str], Candidate] = {}
    for candidate in (search.base, *search.candidates):
        if candidate.fit is not None and candidate.model.ids < search.best.model.ids:
            simpler.setdefault(candidate.model.ids, candidate)
    judged = [_judge(problem, c, search.base, angles) for c in simpler.values()]
    rivals = [j for j in judged if j is not None and j.problem is not problem]
    if not rivals:
        return False
    best = _judge(problem, search.best, search.base, angles)
    return best is not None and best.evidence - max(j.evidence for j in rivals) <= needed


def admit_noise(
    problem: Problem, search: Search, angles: xr.Dataset, needed: float
) -> tuple[Problem, Search]:
    """Judge the leading models anew, each with the noise that explains what it leaves.

    A model leads only if what it has more than a simpler one gains more than `needed` nats.

    Returns
    -------
    problem, search
        With the noise of the model that then leads; its candidates are the finalists.
    """
    finalists: dict[frozenset[str], Candidate] = {search.base.model.ids: search.base}
    for candidate in search.candidates:
        if candidate.fit is not None and len(finalists) <= FINALISTS:
            finalists.setdefault(candidate.model.ids, candidate)
    finalists.setdefault(search.best.model.ids, search.best)
    judging = (_judge(problem, c, search.base, angles) for c in finalists.values())
    judged = [j for j in judging if j is not None]
    if not judged:
        return problem, search
    best_problem = max(judged, key=lambda j: j.evidence).problem
    level = _measure_level(best_problem)
    settled = []
    for _, candidate, evidence in judged:
        same = best_problem is problem
        fitted = candidate if same else _refit(best_problem, candidate, search.base)
        if fitted is not None:
            settled.append(fitted._replace(log_evidence=evidence - level))
    settled.sort(key=lambda c: -c.log_evidence)
    base = next((c for c in settled if c.model.ids == search.base.model.ids), None)
    if base is None:
        return problem, search
    rest = [c for c in settled if c is not base]
    best = settled[0]
    for simpler in sorted(settled, key=lambda c: len(c.model.ids)):
        close = best.log_evidence - simpler.log_evidence <= needed
        if close and simpler.model.ids < best.model.ids:
            best = simpler
    size = len(best.model.ids)
    kept = [c for c in rest if len(c.model.ids) <= max(size, len(base.model.ids) + 1)]
    first_gain = max(best.log_evidence - base.log_evidence, 0.0)
    if best_problem is not problem:
        search = search._replace(shape=None, alone=None)
    return best_problem, search._replace(
        base=base, candidates=kept, rejected=[], best=best, first_gain=first_gain
    )


def _judge(
    problem: Problem, candidate: Candidate, base: Candidate, angles: xr.Dataset
) -> Judged | None:
    noisy = _explain_by_noise(problem, candidate, angles)
    again = candidate if noisy is problem else _refit(noisy, candidate, base)
    if again is None:
        return None
    return Judged(noisy, candidate, again.log_evidence + _measure_level(noisy))


def _measure_level(problem: Problem) -> float:
    """What the noise itself adds to a log evidence [nats]."""
    return -0.5 * float(problem.trials.logdet[problem.trials.protocol].sum())


def _explain_by_noise(problem: Problem, candidate: Candidate, angles: xr.Dataset) -> Problem:
    chosen = angles.sel(trial=problem.trials.name)
    time = chosen["time"].transpose("trial", "frame").values
    residual = compute_residual(problem, candidate, angles)
    sd, rho = estimate_residual_noise(residual, time, problem.trials.interval)
    if compare_noise(chosen.assign(joint_angle=(LAYOUT, residual)), sd, rho) < UNBELIEVABLE:
        return problem
    sd = np.where(np.isfinite(sd), sd, problem.noise["noise_sd"].values)
    noise = problem.noise.assign(noise_sd=("joint", sd), noise_autocorrelation=("joint", rho))
    return replace(problem, noise=noise, trials=prepare_trials(chosen, noise)[0])


def _refit(problem: Problem, candidate: Candidate, base: Candidate) -> Candidate | None:
    fit, gain = candidate.fit, candidate.log_evidence - base.log_evidence
    start = fit.own, fit.shared, fit.omega
    again = problem.fit(candidate.model, start, tolerance=max(TOLERANCE, SHARE * gain))
    if again is None or not again.converged:
        return None
    return Candidate(candidate.model, again, again.log_evidence)
