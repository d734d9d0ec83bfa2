"""Whether the motion prefers another load log or clock."""

from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from softfinger.inference.disturbances import SIZES
from softfinger.inference.problem import Candidate, Problem
from softfinger.inference.reduce import reduce_trials
from softfinger.measurement.decisions import DECISIONS as MEASURING
from softfinger.measurement.trials import Trials
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.search.finalists import list_leaders
from softfinger.mismatch.search.judge import fit_again


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
        max((discount(c, base, needed) for c in some if c is not None), default=-np.inf)
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


class StartedClocks(NamedTuple):
    """Clocks that start in each trial elsewhere.

    `offset`: by how much each trial's frames are later than stated (trial,) [s]; `problem`,
    `candidate`: with that set right; `cost`: what so many numbers cost [nats], but their mean.
    """

    offset: NDArray[np.float64]
    problem: Problem
    candidate: Candidate
    cost: float


def start_clocks(plain: Problem, candidate: Candidate, base: Candidate) -> StartedClocks | None:
    """Start each trial's clock where its motion has it.

    An offset of frames is more than a slope describes, for the motion has a corner at each step.
    So all offsets of a grid are tried, each trial's own parameters following to first order; then
    the model is fitted again. The offsets have a normal prior, whose mean and sd are theirs.

    None where the model has no motion or fit so, or where offsets do not explain what they cost.
    """
    trials, now, here = plain.trials, candidate, plain
    reach = BUDGET.offset_frames * trials.interval
    grid = np.linspace(-reach, reach, BUDGET.offset_tries)
    offset, cost = np.zeros(len(trials.name)), 0.0
    for number in range(BUDGET.offset_rounds):
        lost = _scan_clocks(here, now, grid)
        if not np.isfinite(lost).all():
            return None
        moved, variance = find_lowest(grid, lost)
        offset = offset + moved
        away = offset - offset.mean()
        spread = max(float(np.mean(away**2)), np.finfo(float).tiny)
        cost = 0.5 * float(np.sum(np.log1p(spread / variance) + away**2 / spread))
        explained = float(lost.sum(axis=1).min() - lost.min(axis=0).sum())
        if number == 0 and explained < cost + MEASURING.present_nats:
            return None
        here = replace(plain, trials=trials._replace(node=trials.node + offset[:, None, None]))
        again = fit_again(here, now, base)
        if again is None:
            return None
        now = again
    return StartedClocks(offset, here, now, cost)


def _scan_clocks(
    problem: Problem, candidate: Candidate, grid: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Half the misfit (offset, trial) of later and sooner frames."""
    trials = problem.trials
    moved = (trials._replace(node=trials.node + offset) for offset in grid)
    return measure_lost(problem, candidate, moved)


def measure_lost(
    problem: Problem, candidate: Candidate, moved: Iterable[Trials]
) -> NDArray[np.float64]:
    """Half the misfit (try, trial) of moved trials.

    Each trial's own parameters follow to first order, as far as the population lets them.
    """
    fit, nothing = candidate.fit, np.zeros(0, np.int64)
    slope = problem.simulate(candidate.model, fit.own, fit.shared)[1][..., : fit.own.shape[1]]
    precision, away = np.linalg.inv(fit.omega), fit.own - fit.mean
    lost = []
    for trials in moved:
        other = replace(problem, trials=trials)
        angle = other.simulate(candidate.model, fit.own, fit.shared, nothing)[0]
        gram = reduce_trials(problem.trials, angle, slope)
        pull = gram[:, :-1, -1] - away @ precision
        step = np.linalg.solve(gram[:, :-1, :-1] + precision, pull[..., None])[..., 0]
        lost.append(0.5 * (gram[:, -1, -1] - np.sum(pull * step, axis=1)))
    return np.array(lost)


def find_lowest(
    grid: NDArray[np.float64], lost: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where each column is lowest, and that place's variance.

    By a parabola through three points of the grid.

    >>> grid = np.linspace(-2.0, 2.0, 9)
    >>> [part.round(6).tolist() for part in find_lowest(grid, 8.0 * (grid[:, None] - 0.6) ** 2)]
    [[0.6], [0.0625]]
    >>> find_lowest(grid, 10.0 * grid[:, None])[0]  # without a bend, an end of the grid
    array([-2.])
    """
    at = np.clip(lost.argmin(axis=0), 1, len(grid) - 2)
    column, width = np.arange(lost.shape[1]), grid[1] - grid[0]
    before, here, after = (lost[at + k, column] for k in (-1, 0, 1))
    bend = np.maximum(before - 2.0 * here + after, np.finfo(float).tiny)
    with np.errstate(over="ignore"):  # then it is at an end
        shift = np.clip(0.5 * (before - after) / bend, -1.0, 1.0)
    return grid[at] + shift * width, width**2 / bend


def find_common(offset: NDArray[np.float64]) -> float:
    """Mean of trials' offsets (trial,), which is an effect; 0 where chance has as much.

    That of one trial alone is its mean.

    >>> find_common(np.array([0.0, 2.0, 4.0])), find_common(np.array([2.9, 3.0, 3.1])).round(3)
    (0.0, np.float64(3.0))
    """
    mean = offset.mean()
    if len(offset) == 1:
        return mean
    error = offset.std(ddof=1) / np.sqrt(len(offset))
    return mean if abs(mean) > DECISIONS.common_errors * error else 0.0


def discount(candidate: Candidate, base: Candidate, needed: float) -> float:
    """Log evidence [nats] less what chance gains by its effects."""
    added = len(candidate.model.ids - base.model.ids)
    return candidate.log_evidence - needed * added
