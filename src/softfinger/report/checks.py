"""The checks that decide what the report may claim, each against a stated limit."""

from __future__ import annotations

import numpy as np
import xarray as xr
from scipy.special import stdtrit

from softfinger.report.blocks import Check
from softfinger.report.formatting import format_number, format_percent, format_shares, join_words
from softfinger.report.material import Material

NOT_RUN = "the fit was not run"
FEW = "needs two trials"
PARETO = "largest Pareto k, leaving one trial out"
RING = "ring in the residual"
NO_RING = "No oscillation that most trials share is missing in the model."
EARLY = 1.0
"""End of the early look at the residuals [s]; what inertia or a lag does is over soon."""


def check_computation(material: Material) -> tuple[Check, ...]:
    """Check that the draws represent the posterior, against the limits of the fit."""
    sampling = material.sampling
    if sampling is None:
        meaning = "Without draws and their diagnostics there is no posterior to judge."
        return (Check("posterior", NOT_RUN, "a sampled posterior", None, meaning),)
    limits, worst = sampling.attrs, float(sampling["r_hat"].max())
    checks = [
        Check(
            "largest R-hat",
            format_number(worst, 4),
            f"below {format_number(limits['r_hat_max'], 4)}",
            bool(worst < limits["r_hat_max"]),
            "Independent chains found the same distribution.",
        )
    ]
    for kind, where in (("bulk", "centre"), ("tail", "tails")):
        least = float(sampling[f"ess_{kind}"].min())
        checks.append(
            Check(
                f"fewest effective draws, {kind}",
                f"{least:.0f}",
                f"above {limits['ess_min']:.0f}",
                bool(least > limits["ess_min"]),
                f"Enough independent draws for the {where} of every hyperparameter.",
            )
        )
    count = int(sampling["divergences"])
    checks.append(
        Check(
            "divergent transitions",
            str(count),
            f"at most {limits['divergences_max']}",
            bool(count <= limits["divergences_max"]),
            "The sampler met no region that it could not follow.",
        )
    )
    return (*checks, check_pareto(material))


def check_pareto(material: Material) -> Check:
    """Check that leaving one trial out could be estimated, where the fit kept what that needs."""
    limit = material.limits.pareto_k_max
    meaning = "No single trial decides the population, so leave-one-trial-out scores hold."
    found, passed = "no log-likelihood per trial was kept", None
    tree = material.artifacts["posterior"]
    if "leave_one_out" in tree.children:
        scores = tree["leave_one_out"].dataset
        left, k = scores["refitted"].to_numpy(), scores["pareto_k"].to_numpy()
        if k.size < 2:
            return Check(PARETO, FEW, f"below {format_number(limit)}", None, meaning)
        k = np.where(left, 0.0, k)  # sampled anew without the trial: nothing to weigh
        found = f"{k.max():.2f}; {int((k >= limit).sum())} of {k.size} trials too large"
        found += f", {int(left.sum())} sampled anew" if left.any() else ""
        passed = bool(k.max() < limit)
    return Check(PARETO, found, f"below {format_number(limit)}", passed, meaning)


def check_fit(material: Material) -> tuple[Check, ...]:
    """Check that what the model leaves is noise, and not shared by the trials."""
    residuals = material.residuals
    if residuals is None:
        meaning = "Residuals need fitted parameters."
        return (Check("residuals", NOT_RUN, "a fitted model", None, meaning),)
    limit = max(material.limits.shared_residual_max, find_chance_limit(residuals))
    checks = []
    for words, end in (("all of it", None), ("first second", EARLY)):
        excess = measure_shared_residual(residuals.sel(since_change=slice(None, end)))
        checks.append(
            Check(
                f"shared residual, {words}",
                f"{excess:.1f} times chance" if np.isfinite(excess) else FEW,
                f"below {limit:.1f} times" if np.isfinite(limit) else "–",
                bool(excess < limit) if np.isfinite(excess) else None,
                "The mean over trials of recording minus model is no larger than what independent "
                "trials leave by chance.",
            )
        )
    return (*checks, check_ring(residuals))


def find_chance_limit(residuals: xr.Dataset) -> float:
    """Return what the shared residual exceeds by chance in at most 5 % of all campaigns.

    A ratio of one mean to its standard error follows Student's t; more moments only steady it. The
    5 % are shared among joints and changes of load. Infinite for a single trial.
    """
    looks = residuals.sizes["joint"] * residuals.sizes["change"]
    freedom = int(residuals["n_segments"].min()) - 1
    return float(stdtrit(freedom, 1 - 0.025 / looks)) if freedom > 0 else np.inf


def measure_shared_residual(residuals: xr.Dataset) -> float:
    """Return the rms of the mean residual over its standard error's, the worst joint and change.

    Near 1 where the trials share nothing, whatever the noise's autocorrelation; NaN for a single
    trial, which has no mean.
    """
    known = residuals["residual_se"] > 0
    mean, error = (residuals[name].where(known) for name in ("mean_residual", "residual_se"))
    ratio = np.sqrt((mean**2).mean("since_change") / (error**2).mean("since_change"))
    return float(ratio.max())


def check_ring(residuals: xr.Dataset) -> Check:
    """Check that no narrow line stands out of the residual's spectrum."""
    if int(residuals["n_segments"].max()) < 2:
        return Check(RING, FEW, "none", None, NO_RING)
    peaks = residuals["peak_frequency"].values
    rings = sorted({f"{peak:.1f} Hz" for peak in peaks[np.isfinite(peaks)]})
    return Check(
        RING,
        join_words(rings) or "none",
        "none",
        not rings,
        NO_RING,
    )


def check_calibration(material: Material) -> tuple[Check, ...]:
    """Check that the predictive bands hold as many recorded frames as they claim."""
    if "bands" not in material:
        meaning = "Bands come from the rule propagate."
        return (Check("coverage", "the bands were not computed", "bands", None, meaning),)
    limits, n = material.limits, material.angles.sizes["trial"]
    enough = n > 1
    checks = []
    for window, words in (("whole", "whole recording"), ("first_second", "first second")):
        pooled = pool_coverage(material.bands, limits.ci_prob, window)
        claimed = float(pooled["ci_prob"])
        gap = np.abs(pooled["coverage"] - claimed)
        worst = pooled.isel(joint=int(gap.argmax("joint")))
        error = expect_error(pooled, claimed, n)
        allowed = np.maximum(limits.coverage_tolerance, 2 * error)
        joint, found = worst["joint"].item(), float(worst["coverage"])
        reach = float(allowed.max())
        low, high = claimed - reach, min(claimed + reach, 1.0)
        checks.append(
            Check(
                f"coverage of the {format_percent(claimed)} bands, {words}",
                f"{format_percent(found, 1)} (joint {joint})" if enough else FEW,
                format_shares(low, high, 1),
                bool((gap <= allowed).all()) if enough else None,
                "The predictive bands hold the share of recorded frames that they claim, but for "
                "what so few trials leave open.",
            )
        )
    return tuple(checks)


def expect_error(pooled: xr.Dataset, claimed: float, n_trials: int) -> xr.DataArray:
    """Return the standard error (joint) that the coverage of n trials has if the claim is true.

    That of the bootstrap, sqrt(s² / n), is of the coverage that was found; it is 0 where all trials
    lie inside, and not known of a protocol of one trial. The variance of shares goes with
    p (1 − p), and is never more than that of trials that lie inside as a whole or not at all.

    Examples
    --------
    Two trials that lie inside a 90 % band tell little:

    >>> found = xr.Dataset({"coverage": ("joint", [1.0]), "coverage_se": ("joint", [0.0])})
    >>> expect_error(found, 0.9, 2).values.round(3)
    array([0.212])
    """
    held = pooled["coverage"]
    variance, most = held * (1 - held), claimed * (1 - claimed)
    scale = np.sqrt(most / variance.where(variance > 0))
    error = (pooled["coverage_se"] * scale).where(pooled["coverage_se"] > 0, np.inf)
    return np.minimum(error, np.sqrt(most / n_trials))


def pool_coverage(bands: xr.Dataset, ci_prob: float, window: str) -> xr.Dataset:
    """Pool the posterior's coverage and its standard error (joint) over protocols by trials."""
    chosen = bands[["coverage", "coverage_bound"]].sel(estimate="posterior", window=window)
    chosen = chosen.sel(ci_prob=ci_prob, method="nearest")
    n = bands["recorded_n"].max(["time", "joint"]).astype(float)
    share = n / n.sum()
    bound = chosen["coverage_bound"]
    # the artifact's bounds hold 90 %, which is 3.29 standard errors of a normal
    error = (bound.sel(bound="upper") - bound.sel(bound="lower")) / 3.29
    pooled = (chosen["coverage"] * share).sum("protocol")
    return xr.Dataset(
        {"coverage": pooled, "coverage_se": np.sqrt((error**2 * share**2).sum("protocol"))}
    ).assign_coords(ci_prob=chosen["ci_prob"])


def combine(checks: tuple[Check, ...]) -> bool | None:
    """Combine checks: False if any failed, True if the rest holds at least one pass, else None.

    >>> combine(())
    """
    results = {check.passed for check in checks}
    return False if False in results else True if True in results else None
