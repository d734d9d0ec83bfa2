"""Leading models are judged with their own measurement.

It is the one that the model's own residual requires.

What a model leaves may come from the recordings: a load log that scatters, clocks, a picture that
drifts. Each may take an effect's place only where its evidence is better. So the measurement that
goes with the search is that of whichever leads, the base model or an effect, each at its best; and
the sets of effects that are found are compared once more, each with its own.
"""

from dataclasses import replace
from itertools import chain
from typing import NamedTuple

import numpy as np
import xarray as xr

from softfinger.inference.budget import BUDGET as INFERENCE
from softfinger.inference.disturbance_sizes import Moves, fit_disturbances, list_moves
from softfinger.inference.disturbances import find_kind
from softfinger.inference.disturbed import admit_disturbances, forget_spreads
from softfinger.inference.problem import Candidate, Problem, predict_frames
from softfinger.inference.spreads import find_effect, is_spread
from softfinger.inference.tails import weigh_tails
from softfinger.measurement.measure import add_components, measure
from softfinger.measurement.mend import MENDED
from softfinger.measurement.trials import prepare_trials
from softfinger.mechanics.effects.model import Piece
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.rank import Progress, has_reached, reaching_nats
from softfinger.mismatch.priors import PRIORS
from softfinger.mismatch.search.demand import Demand, choose_simplest
from softfinger.mismatch.search.finalists import list_finalists
from softfinger.mismatch.search.finer import fit_finer, fit_rivals_finer
from softfinger.mismatch.search.stepwise import Search


class Judged(NamedTuple):
    """A model with a measurement of its own.

    The problem with it, and its log evidence [nats].

    The noise's own level counts, so that models with different measurements compare.
    """

    problem: Problem
    candidate: Candidate
    evidence: float


def settle_measurement(
    plain: Problem, base: Candidate, leaders: list[Candidate]
) -> tuple[Problem, Candidate]:
    """Take the measurement of whichever leads.

    The base model leads, or one of the best effects.

    Parameters
    ----------
    plain
        Without disturbances.
    leaders
        The best effects, as of `list_leaders`.

    Returns
    -------
    problem, base
        With that measurement; as they are where it has no disturbance: tails alone change no
        leader, and are weighed at the end.
    """
    judging = (judge(plain, c, plain, base) for c in (base, *leaders))
    best = max((j for j in judging if j is not None), key=lambda j: j.evidence, default=None)
    if best is None or not best.problem.disturbed:
        return plain, base
    if best.candidate.model is base.model:
        return best.problem, best.candidate
    problem = forget_spreads(plain, best.problem, best.candidate)
    if not problem.disturbed:
        return plain, base
    again = fit_again(problem, base, base)
    return (plain, base) if again is None else (problem, again)


def judge_finalists(
    plain: Problem,
    problem: Problem,
    search: Search,
    rivals: list[Candidate],
    angles: xr.Dataset,
    demand: Demand,
    pieces: list[Piece],
    progress: Progress,
) -> tuple[Problem, Search]:
    """Judge the leading sets of effects anew.

    Each has its own measurement.

    Frames count that are no outliers of the best model. A model leads only if what it has more than
    a simpler one gains more than is demanded, also where the simpler one has finer laws; the
    measurement is that of the model that leads.

    Parameters
    ----------
    plain, problem
        Without disturbances, and as the search had it.
    rivals
        Sets that a search without disturbances found, its best first.
    pieces
        The catalogue.
    progress
        Wraps the long loops; base and best are judged whatever the time.

    Returns
    -------
    problem, search
        With the measurement of the model that then leads; its candidates are the finalists.
    """
    measured = measure_again(plain, search.best, angles)
    finalists = sorted(list_finalists(search, rivals), key=lambda c: -c.log_evidence)
    others = [c for c in finalists if c is not search.base]
    fitted = problem if measured is plain else None
    judged: list[Judged] = []
    best = None
    for candidate in chain([search.base], progress(others, "judging sets of effects")):
        worth = -np.inf
        if best is not None:
            worth = best.evidence - reaching_nats(best.evidence - judged[0].evidence)
        one = judge(measured, candidate, fitted, search.base, worth)
        judged += [] if one is None else [one]
        best = max(judged, key=lambda j: j.evidence, default=None)
    if best is None or (best.problem is plain and plain is problem and _agree(judged, plain)):
        return problem, search
    told = [one.candidate._replace(log_evidence=one.evidence) for one in judged]
    leading = choose_simplest(told, search.base.model.ids, demand)
    best = next(one for one, c in zip(judged, told, strict=True) if c is leading)
    level = best.evidence - best.candidate.log_evidence
    settled = []
    for other in judged:
        same = other.problem is best.problem
        again = other.candidate if same else fit_again(best.problem, other.candidate, search.base)
        if again is not None:  # at its best, be that with the measurement of the other
            evidence = other.evidence - level
            if not _has_strange_spread(best.problem, other.candidate):
                evidence = max(evidence, again.log_evidence)
            settled.append(again._replace(log_evidence=evidence))
    search = _settle(search, settled, demand)
    known = search.candidates, pieces, progress
    finer = fit_finer(best.problem, search.best, *known)
    finer += fit_rivals_finer(best.problem, search.base, search.best, *known)
    return best.problem, _settle(search, [search.base, *search.candidates, *finer], demand)


def _has_strange_spread(problem: Problem, candidate: Candidate) -> bool:
    """Whether parameters of an effect that a model lacks differ between trials."""
    spreads = filter(is_spread, problem.disturbed)
    return any(find_effect(name) not in candidate.model.ids for name in spreads)


def judge(
    plain: Problem,
    candidate: Candidate,
    fitted: Problem | None,
    base: Candidate,
    worth: float = -np.inf,
) -> Judged | None:
    """Fit a model with its residual's disturbances and tails.

    None where that fails, or where it would not reach what is worth reaching.

    Parameters
    ----------
    plain
        Without disturbances.
    fitted
        The problem that the candidate was fitted to.
    base
        From which its gain counts.
    worth
        Evidence [nats] that is worth reaching.
    """
    moves = list_moves(plain, candidate)
    problem, size = _soften(plain, candidate, moves)
    tailed = weigh_tails(plain, candidate, problem)
    if tailed is not plain:
        problem, size = _soften(tailed, candidate, moves)
    more = _measure_level(problem) - PRIORS.component_nats * len(size)
    rival = worth - more
    again = candidate if problem is fitted else fit_again(problem, candidate, base, rival)
    if again is None:
        return None
    return Judged(problem, again, again.log_evidence + more)


def needs_disturbance(plain: Problem, candidate: Candidate) -> bool:
    """Whether a model's residual shows any disturbance."""
    return bool(fit_disturbances(plain, candidate, PRIORS.component_nats, most=1)[0])


def _soften(plain: Problem, candidate: Candidate, moves: Moves) -> tuple[Problem, dict[str, float]]:
    """Admit the disturbances that a model's residual shows.

    From the evidence that one costs: to be claimed it needs more.
    """
    size, evidence, directions = fit_disturbances(plain, candidate, PRIORS.component_nats, moves)
    if not size:
        return plain, size
    noise = add_components(plain.noise, size, evidence)
    return replace(admit_disturbances(plain, size, directions), noise=noise), size


def measure_again(problem: Problem, candidate: Candidate, angles: xr.Dataset) -> Problem:
    """Judge the frames against a better model.

    The problem stays as it is where the same ones count.
    """
    chosen = angles.sel(trial=problem.trials.name)
    noise = _carry_over(measure(chosen, predict_frames(problem, candidate, chosen)), problem.noise)
    known = problem.noise["used"].sel(trial=problem.trials.name).values
    if np.array_equal(noise["used"].values, known):
        return problem
    trials = prepare_trials(chosen, noise)
    if trials.name != problem.trials.name:
        return problem
    return replace(problem, trials=trials, noise=noise)


def _carry_over(noise: xr.Dataset, known: xr.Dataset) -> xr.Dataset:
    """Keep what was mended in log and clock before."""
    names = known["component"].values.tolist()
    mended = [name for name in names if find_kind(name) or name in MENDED]
    size, nats = (
        {name: float(known[part].sel(component=name)) for name in mended}
        for part in ("component_size", "component_evidence")
    )
    return add_components(noise, size, nats) if mended else noise


def _agree(judged: list[Judged], plain: Problem) -> bool:
    """Whether no model has a disturbance."""
    return all(j.problem is plain for j in judged)


def _settle(search: Search, settled: list[Candidate], demand: Demand) -> Search:
    settled = sorted(settled, key=lambda c: -c.log_evidence)
    base = next((c for c in settled if c.model.ids == search.base.model.ids), None)
    if base is None:
        return search
    best = choose_simplest(settled, search.base.model.ids, demand)
    size = len(best.model.ids)
    rest = [c for c in settled if c is not base]
    kept = [c for c in rest if len(c.model.ids) <= max(size, len(base.model.ids) + 1)]
    first_gain = max(best.log_evidence - base.log_evidence, 0.0)
    return search._replace(
        base=base,
        candidates=kept,
        rejected=[],
        best=best,
        first_gain=first_gain,
        shape=None,
        alone=None,
    )


def compare_levels(problem: Problem, other: Problem) -> float:
    """What a problem's log evidence has over another's [nats].

    Its noise has another level there.
    """
    return _measure_level(problem) - _measure_level(other)


def _measure_level(problem: Problem) -> float:
    """The noise's part of a log evidence [nats]."""
    return float(problem.trials.tails.sum() - 0.5 * problem.trials.logdet.sum())


def fit_again(
    problem: Problem, candidate: Candidate, base: Candidate, rival: float = -np.inf
) -> Candidate | None:
    """Fit a model from where it was, else None."""
    fit, gain = candidate.fit, candidate.log_evidence - base.log_evidence
    start = fit.own, fit.shared, fit.omega
    tolerance = max(BUDGET.rest_nats, INFERENCE.rest_share * gain)
    again = problem.fit(candidate.model, start, tolerance=tolerance, rival=rival)
    if again is None or not has_reached(again, rival):
        return None
    return Candidate(candidate.model, again, again.log_evidence)
