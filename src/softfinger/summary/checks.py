"""The report's checks, each with a limit."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.special import stdtrit

NOT_RUN = "the fit was not run"
NO_BANDS = "the bands were not computed"
NO_SCORES = "no log-likelihood per trial was kept"
FEW = "needs two trials"
EARLY = 1.0
"""End [s] of the early look; inertia acts before."""
PASSED, FAILED, NOT_MADE = 1, 0, -1


class Result(NamedTuple):
    """One check; an infinite bound does not count."""

    name: str
    value: float = np.nan
    lower: float = -np.inf
    upper: float = np.inf
    passed: int = NOT_MADE
    joint: int = 0
    trials: int = 0
    remark: str = ""
    powered: bool = True


def gather_checks(results: list[Result]) -> xr.Dataset:
    """Gather checks in one Dataset of dimension (check).

    value, lower, upper, passed, joint, trials, remark, powered.

    `passed` is 1, 0, or −1 where the check could not be made, and `remark` why not; `powered` is
    whether it could have failed on either side; `joint` is the
    worst one (0: none) and `trials` how many are beyond the limit.
    """
    names, *columns = zip(*results, strict=True)
    data = {
        name: ("check", np.array(column))
        for name, column in zip(Result._fields[1:], columns, strict=True)
    }
    return xr.Dataset(data, {"check": list(names)})


def write_judgement(*, passed: bool) -> int:
    """Write a judgement as a number."""
    return PASSED if passed else FAILED


def check_computation(sampling: xr.Dataset | None) -> Iterator[Result]:
    """Check draws against the fit's own limits."""
    if sampling is None:
        names = ("r_hat", "ess_bulk", "ess_tail", "divergences")
        yield from (Result(name, remark=NOT_RUN) for name in names)
        return
    limits, worst = sampling.attrs, float(sampling["r_hat"].max())
    top = float(limits["r_hat_max"])
    yield Result("r_hat", worst, upper=top, passed=write_judgement(passed=worst < top))
    for name in ("ess_bulk", "ess_tail"):
        least, low = float(sampling[name].min()), float(limits["ess_min"])
        yield Result(name, least, lower=low, passed=write_judgement(passed=least > low))
    count, most = int(sampling["divergences"]), float(limits["divergences_max"])
    yield Result("divergences", count, upper=most, passed=write_judgement(passed=count <= most))


def check_pareto(posterior: xr.DataTree | None, limit: float) -> Result:
    """Check whether leaving one trial out was possible.

    It is made where the fit kept what that needs.

    A trial without which the fit was sampled anew needs no weights: its k counts as 0.
    """
    if posterior is None:
        return Result("pareto_k", upper=limit, remark=NOT_RUN)
    if "leave_one_out" not in posterior.children:
        return Result("pareto_k", upper=limit, remark=NO_SCORES)
    scores = posterior["leave_one_out"].dataset
    left = scores["refitted"].to_numpy()
    k = np.where(left, 0.0, scores["pareto_k"].to_numpy())
    if k.size < 2:
        return Result("pareto_k", upper=limit, remark=FEW)
    beyond = int((k >= limit).sum())
    passed = write_judgement(passed=k.max() < limit)
    remark = f"{int(left.sum())} sampled anew" if left.any() else ""
    return Result("pareto_k", k.max(), upper=limit, passed=passed, trials=beyond, remark=remark)


def check_fit(residuals: xr.Dataset | None, shared_max: float) -> Iterator[Result]:
    """Check that what is left is unshared noise."""
    names = ("shared_residual", "shared_residual_early", "ring")
    if residuals is None:
        yield from (Result(name, remark=NOT_RUN) for name in names)
        return
    limit = max(shared_max, find_chance_limit(residuals))
    for name, end in zip(names, (None, EARLY), strict=False):
        excess = measure_shared_residual(residuals.sel(since_change=slice(None, end)))
        if np.isfinite(excess):
            yield Result(name, excess, upper=limit, passed=write_judgement(passed=excess < limit))
        else:
            yield Result(name, upper=limit, remark=FEW)
    if int(residuals["n_segments"].max()) < 2:
        yield Result("ring", upper=0, remark=FEW)
        return
    rings = residuals["rings"].size
    yield Result("ring", rings, upper=0, passed=write_judgement(passed=rings == 0))


def find_chance_limit(residuals: xr.Dataset) -> float:
    """Find what the shared residual exceeds by chance.

    It does so in at most 5 % of all campaigns.

    A ratio of one mean to its standard error follows Student's t; more moments only steady it. The
    5 % are shared among joints and changes of load. Infinite for a single trial.
    """
    looks = residuals.sizes["joint"] * residuals.sizes["change"]
    freedom = int(residuals["n_segments"].min()) - 1
    return float(stdtrit(freedom, 1 - 0.025 / looks)) if freedom > 0 else np.inf


def measure_detectable(residuals: xr.Dataset, shared_max: float) -> float:
    """Measure the shared motion [rad] that fails the check.

    It is that of the noisiest joint.

    NaN for a single trial.
    """
    limit = max(shared_max, find_chance_limit(residuals))
    error = residuals["residual_se"].where(residuals["residual_se"] > 0)
    size = float(np.sqrt((error**2).mean("since_change")).max())
    return limit * size if np.isfinite(limit) else np.nan


def measure_shared_residual(residuals: xr.Dataset) -> float:
    """Measure the mean residual over its standard error.

    It is the rms, at the worst joint and change.

    Near 1 where the trials share nothing, whatever the noise's autocorrelation; NaN for a single
    trial, which has no mean.
    """
    known = residuals["residual_se"] > 0
    mean, error = (residuals[name].where(known) for name in ("mean_residual", "residual_se"))
    ratio = np.sqrt((mean**2).mean("since_change") / (error**2).mean("since_change"))
    return float(ratio.max())


def check_calibration(
    calibration: xr.Dataset | None, trials: int, tolerance: float
) -> Iterator[Result]:
    """Check that predictive bands contain what they claim.

    They claim a share of the recorded frames.

    Two standard errors of so few trials are excused, whatever the tolerance.
    """
    names = {"whole": "coverage", "first_second": "coverage_early"}
    if calibration is None:
        yield from (Result(name, remark=NO_BANDS) for name in names.values())
        return
    claimed = float(calibration["claimed"])
    reach = max(tolerance, 2 * float(calibration["expected_error"]))
    span = {"lower": claimed - reach, "upper": min(claimed + reach, 1.0)}
    for window, name in names.items():
        coverage = calibration["coverage"].sel(window=window)
        worst = coverage.isel(joint=int(np.abs(coverage - claimed).argmax("joint")))
        found, joint = float(worst), int(worst["joint"])
        if trials < 2:
            yield Result(name, **span, remark=FEW)
        else:
            passed = write_judgement(passed=abs(found - claimed) <= reach)
            powered = claimed + reach < 1
            yield Result(name, found, **span, passed=passed, joint=joint, powered=powered)
