"""Whether the motion prefers another load log or clock."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.optimize import minimize_scalar

from softfinger.inference.disturbances import SIZES, list_disturbances
from softfinger.inference.disturbed import admit_disturbances
from softfinger.inference.problem import Candidate, Problem
from softfinger.measurement.decisions import DECISIONS as MEASURING
from softfinger.measurement.step_time import advance_steps_array, open_steps_array
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.search.judge import fit_again, list_leaders


def weigh_log(
    plain: Problem, base: Candidate, singles: list[Candidate], angles: xr.Dataset, needed: float
) -> float:
    """Evidence [nats] for another log of the load.

    The rival is the log that was fitted.

    Each counts by the base model or by the best effects, an effect less what chance gains.

    Parameters
    ----------
    plain, base, singles
        Fitted to the log as it is.
    angles
        With the other log.
    """
    known = angles.sel(trial=plain.trials.name)
    log = {
        name: known[name].transpose("trial", "knot").values for name in ("load_time", "load_torque")
    }
    other = replace(plain, trials=plain.trials._replace(**log))
    leaders = list_leaders(base, singles, needed)
    moved = (fit_again(other, c, base) for c in (base, *leaders))
    best = [
        max((_discount(c, base, needed) for c in some if c is not None), default=-np.inf)
        for some in ((base, *leaders), moved)
    ]
    return best[1] - best[0]


def find_clock_rate(plain: Problem, base: Candidate) -> tuple[float, float]:
    """Find how slow the camera's clock runs.

    Also what that gains [nats].

    By the evidence of the base model, over the rates that `SIZES` allow.
    """
    largest = max(SIZES["clock_rate"])

    def lose(rate: float) -> float:
        trials = plain.trials._replace(node=plain.trials.node * (1.0 + rate))
        again = fit_again(replace(plain, trials=trials), base, base)
        return BUDGET.no_motion_nats if again is None else base.log_evidence - again.log_evidence

    bounds = (-largest, largest)
    found = minimize_scalar(lose, bounds=bounds, method="bounded", options={"xatol": 1e-5})
    return float(found.x), -float(found.fun)


class PlacedSteps(NamedTuple):
    """When the load's steps come, and what that gains.

    `early`: sooner than at their later rows, as a share of the gap; `is_open`: at any moment of it;
    `nats` [nats] over the log as it is.
    """

    early: float = 0.0
    is_open: bool = False
    nats: float = 0.0


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
    known = max(_discount(c, base, needed) for c in leaders)
    best, most = PlacedSteps(), 0.0
    for candidate in leaders:
        found = max(
            (_find_steps_early(plain, candidate, base), _open_steps(plain, candidate, base)),
            key=lambda steps: steps.nats - MEASURING.present_nats * steps.is_open,
        )
        lead = _discount(candidate, base, needed) + found.nats - known
        if found.nats > MEASURING.present_nats and lead >= most:
            best, most = found, lead
    return best


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
    softer = fit_again(admit_disturbances(opened, unit, directions), again, base)
    nats = -np.inf if softer is None else softer.log_evidence - candidate.log_evidence
    return PlacedSteps(is_open=True, nats=nats)


def _discount(candidate: Candidate, base: Candidate, needed: float) -> float:
    added = len(candidate.model.ids - base.model.ids)
    return candidate.log_evidence - needed * added
