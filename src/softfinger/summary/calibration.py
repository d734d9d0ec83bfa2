"""Whether bands contain the share they claim."""

import numpy as np
import xarray as xr

from softfinger.summary.recordings import find_largest_load

WINDOWS = ("whole", "first_second")


def summarise_calibration(bands: xr.Dataset, angles: xr.Dataset, ci_prob: float) -> xr.Dataset:
    """Pool the coverage of the posterior's bands over protocols.

    Parameters
    ----------
    ci_prob
        The band looked at is the one of the nearest probability.

    Returns
    -------
    Dataset
        coverage (window, joint); claimed (); expected_error (), a bound of the error that so few
        trials leave if the claim is true;
        protocol_load, protocol_trials (protocol): median over its trials of the largest load, and
        their number.
    """
    window = xr.IndexVariable("window", list(WINDOWS))
    pooled = [pool_coverage(bands, ci_prob, name) for name in WINDOWS]
    claimed = float(bands["ci_prob"].sel(ci_prob=ci_prob, method="nearest"))
    peak = find_largest_load(angles.sel(trial=bands["trial"]))
    of_trial = bands["protocol_of_trial"].values
    return xr.Dataset(
        {
            "coverage": xr.concat(pooled, window, join="exact"),
            "claimed": ((), claimed),
            "expected_error": ((), bound_error(claimed, angles.sizes["trial"])),
            "protocol_load": (
                "protocol",
                [np.median(peak[of_trial == name]) for name in bands["protocol"].values],
            ),
            "protocol_trials": count_trials(bands).astype(int),
        }
    ).reset_coords(drop=True)


def count_trials(bands: xr.Dataset) -> xr.DataArray:
    """Count the recorded trials of each protocol."""
    return bands["recorded_n"].max([dim for dim in bands["recorded_n"].dims if dim != "protocol"])


def pool_coverage(bands: xr.Dataset, ci_prob: float, window: str) -> xr.DataArray:
    """Pool posterior coverage (joint), weighted by trials."""
    chosen = bands["coverage"].sel(estimate="posterior", window=window)
    chosen = chosen.sel(ci_prob=ci_prob, method="nearest")
    trials = count_trials(bands).astype(float)
    return (chosen * trials / trials.sum()).sum("protocol").reset_coords(drop=True)


def bound_error(claimed: float, trials: int) -> float:
    """Bound the standard error of n trials' coverage.

    The claim is taken as true.

    Frames of one trial lie inside together: the variance of a trial's share is largest, p (1 − p),
    where trials lie inside as a whole or not at all.

    >>> round(bound_error(0.9, 100), 3)
    0.03
    """
    return float(np.sqrt(claimed * (1 - claimed) / trials))
