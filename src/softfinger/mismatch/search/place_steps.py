"""When within the gaps of its log the load's steps came."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from softfinger.inference.disturbances import list_disturbances
from softfinger.inference.disturbed import admit_disturbances
from softfinger.inference.problem import Candidate, Problem
from softfinger.measurement.decisions import DECISIONS as MEASURING
from softfinger.measurement.step_time import (
    advance_steps_array,
    list_steps_array,
    open_steps_array,
    place_steps_array,
)
from softfinger.measurement.trials import Trials
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.priors import PRIORS
from softfinger.mismatch.search.finalists import list_leaders
from softfinger.mismatch.search.judge import compare_levels, fit_again, judge
from softfinger.mismatch.search.log_and_clock import discount, find_lowest, measure_lost

Array = NDArray[np.float64]


class PlacedSteps(NamedTuple):
    """When the load's steps come, and what that gains.

    `early`: sooner than at their later rows, as a share of the gap; `is_open`: at any moment of it;
    `each`: sooner by shares of their own (trial, step); `nats` [nats] over the log as it is;
    `cost` [nats] of shares of their own, off that; `evidence` [nats] of the best with them, an
    effect less what chance gains.
    """

    early: float = 0.0
    is_open: bool = False
    each: Array | None = None
    nats: float = 0.0
    cost: float = 0.0
    evidence: float = -np.inf


def place_steps(
    plain: Problem, base: Candidate, singles: list[Candidate], needed: float
) -> PlacedSteps:
    """Find when in their gaps the load's steps come.

    As the log has them where a model of the log as it is explains more.

    By the base model or the best effects, each at its best and an effect less what chance gains.

    Parameters
    ----------
    plain, base, singles
        Fitted to steps at the later of the two rows that state them.
    """
    leaders = base, *list_leaders(base, singles, needed)
    known = max(discount(c, base, needed) for c in leaders)
    best = PlacedSteps()
    for candidate in leaders:
        early = _find_steps_early(plain, candidate, base)
        opened = _open_steps(plain, candidate, base)
        each = _place_each(plain, candidate, base)
        found = max(
            (early, opened, each),
            key=lambda steps: steps.nats - MEASURING.present_nats * (steps.early == 0.0),
        )
        if min(opened.nats, each.nats) > max(early.nats, MEASURING.present_nats):
            nats = (_judge_steps(plain, steps, candidate, base) for steps in (opened, each))
            open_nats, each_nats = nats
            found = opened if open_nats > each_nats + DECISIONS.form_error * each.nats else each
        evidence = discount(candidate, base, needed) + found.nats
        if found.nats > MEASURING.present_nats and evidence >= max(known, best.evidence):
            best = found._replace(evidence=evidence)
    return best


def _judge_steps(
    plain: Problem, steps: PlacedSteps, candidate: Candidate, base: Candidate
) -> float:
    """Evidence [nats] of steps with whatever else the recordings suffer from.

    A line over a gap takes some of that: what times that jitter do to the frames just after a step.
    """
    moved = replace(plain, trials=_move_steps(plain.trials, steps))
    again = fit_again(moved, candidate, base)
    judged = None if again is None else judge(moved, again, None, base)
    return -np.inf if judged is None else judged.evidence - steps.cost


def _move_steps(trials: Trials, steps: PlacedSteps) -> Trials:
    load = trials.load_time, trials.load_torque
    if steps.is_open:
        return trials._replace(load_time=open_steps_array(*load, trials.interval))
    return trials._replace(load_time=place_steps_array(*load, steps.each, trials.interval))


def _find_steps_early(plain: Problem, candidate: Candidate, base: Candidate) -> PlacedSteps:
    """Move all steps by one share of their gaps.

    They stay at their rows where a slight share explains less.
    """
    load = plain.trials.load_time, plain.trials.load_torque

    def lose(share: float) -> float:
        sooner = advance_steps_array(*load, share, plain.trials.interval)
        moved = replace(plain, trials=plain.trials._replace(load_time=sooner))
        again = fit_again(moved, candidate, base)
        return (
            BUDGET.no_motion_nats if again is None else candidate.log_evidence - again.log_evidence
        )

    if lose(BUDGET.step_share) >= 0.0:
        return PlacedSteps()
    options = {"xatol": BUDGET.step_digits}
    found = minimize_scalar(lose, bounds=(0.0, 1.0), method="bounded", options=options)
    return PlacedSteps(float(found.x), nats=-float(found.fun))


def _open_steps(plain: Problem, candidate: Candidate, base: Candidate) -> PlacedSteps:
    """Let steps come at any moment of their gaps."""
    trials, unit = plain.trials, {"step_scatter": 1.0}
    line = open_steps_array(trials.load_time, trials.load_torque, trials.interval)
    opened = replace(plain, trials=trials._replace(load_time=line))
    again = fit_again(opened, candidate, base)
    directions = {} if again is None else list_disturbances(opened, again, set(unit))
    if again is None or not directions:
        return PlacedSteps(nats=-np.inf)
    problem = admit_disturbances(opened, unit, directions)
    softer = fit_again(problem, again, base)
    if softer is None:
        return PlacedSteps(nats=-np.inf)
    nats = softer.log_evidence - candidate.log_evidence + compare_levels(problem, plain)
    return PlacedSteps(is_open=True, nats=nats)


def _place_each(plain: Problem, candidate: Candidate, base: Candidate) -> PlacedSteps:
    """Place each step where the motion has it.

    A line over a gap is more than a step; where a frame shows the motion in a millisecond, so does
    a step that came elsewhere in its gap. The share U of the gap by which it came sooner has mean ½
    and variance 1/12. With half the misfit L(U) its evidence is, by Laplace's method at the mode,

        −L − 6 (U − ½)² − ½ log(1 + 1/(12 var)),  1/var = L″
    """
    trials = plain.trials
    load = trials.load_time, trials.load_torque
    is_step = list_steps_array(*load, trials.interval) > 0.0
    if is_step.shape[1] > BUDGET.placed_steps:
        return PlacedSteps(nats=-np.inf)
    mean, variance = PRIORS.step_mean, PRIORS.step_variance
    share, spread = np.where(is_step, mean, 0.0), np.full(is_step.shape, variance)

    def move(share: Array) -> Trials:
        return trials._replace(load_time=place_steps_array(*load, share, trials.interval))

    now, before = fit_again(replace(plain, trials=move(share)), candidate, base), -np.inf
    for number in range(BUDGET.step_rounds):
        if now is None or now.log_evidence < before + BUDGET.rest_nats:
            break
        here, width = replace(plain, trials=move(share)), BUDGET.step_zoom**number
        share, spread = _scan_steps(here, now, share, move, width)
        share, before = np.where(is_step, share, 0.0), now.log_evidence
        now = fit_again(replace(plain, trials=move(share)), now, base)
    if now is None:
        return PlacedSteps(nats=-np.inf)
    lost = (share - mean) ** 2 / (2.0 * variance) + 0.5 * np.log(variance / spread)
    gain, cost = now.log_evidence - candidate.log_evidence, float(lost[is_step].sum())
    return PlacedSteps(each=share, nats=gain - cost, cost=cost)


def _scan_steps(
    here: Problem, candidate: Candidate, share: Array, move: Callable[[Array], Trials], width: float
) -> tuple[Array, Array]:
    """Most probable share of each step within a width of where it is, and its variance.

    Both are (trial, step), found one step after the other; as they are where a place has no motion.
    """
    around = width * np.linspace(-0.5, 0.5, BUDGET.step_tries)
    share, spread = share.copy(), np.full(share.shape, PRIORS.step_variance)
    for step in range(share.shape[1]):
        centre = np.clip(share[:, step], width / 2.0, 1.0 - width / 2.0)
        tried = centre + around[:, None]
        put = np.arange(share.shape[1]) == step
        moved = (move(np.where(put, place[:, None], share)) for place in tried)
        away = (tried - PRIORS.step_mean) ** 2 / (2.0 * PRIORS.step_variance)
        lost = measure_lost(here, candidate, moved) + away
        if np.isfinite(lost).all():
            shift, spread[:, step] = find_lowest(around, lost)
            share[:, step] = np.clip(centre + shift, 0.0, 1.0)
    return share, spread


def describe_steps(
    plain: Problem, steps: PlacedSteps
) -> tuple[dict[str, Any], dict[str, tuple[float, float]]]:
    """Steps as a model file has them.

    Also component → mean time that they come sooner [s], and evidence [nats].
    """
    if steps.is_open:
        return {"steps_open": True}, {}
    trials = plain.trials
    gaps = list_steps_array(trials.load_time, trials.load_torque, trials.interval)
    if steps.each is None:
        early = steps.early * gaps[gaps > 0.0].mean()
        return {"steps_early": steps.early}, {"step_time": (float(early), steps.nats)}
    early = (steps.each * gaps)[gaps > 0.0].mean()
    of_trials = zip(trials.name, steps.each, gaps, strict=True)
    shares = {name: share[gap > 0.0].tolist() for name, share, gap in of_trials}
    return {"step_shares": shares}, {"step_moments": (float(early), steps.nats)}
