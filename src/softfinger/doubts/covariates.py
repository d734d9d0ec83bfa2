"""Covariates out of range."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from softfinger.doubts.doubt import FACTORS, Doubt, name_trials

Array = NDArray[np.float64]
RANGES = {
    "_c": (-80.0, 200.0, "°C"),
    "_k": (150.0, 600.0, "K"),
    "_pct": (0.0, 100.0, "%"),
    "_kg": (0.0, 50.0, "kg"),
    "_hpa": (300.0, 1200.0, "hPa"),
}
ALONE = 0.25  # share of trials, at most
SPREADS = 8.0


def doubt_covariates(
    names: Sequence[str], covariates: Sequence[str], value: Array
) -> Iterator[Doubt]:
    """Doubt the covariates (trial, covariate)."""
    for column, values in zip(covariates, value.T, strict=True):
        wrong = _find_out_of_range(column, values)
        low, high, unit = _get_range(column)
        if wrong.any():
            yield _describe(names, column, values, wrong, f"expected {low:g} to {high:g} {unit}")
            continue
        slip = _find_slip(values)
        if slip.any():
            usual = float(np.nanmedian(values[~slip]))
            yield _describe(names, column, values, slip, f"the others have about {usual:.4g}")


def _describe(
    names: Sequence[str], column: str, values: Array, wrong: NDArray[np.bool_], expected: str
) -> Doubt:
    which = [name for name, w in zip(names, wrong, strict=True) if w]
    return Doubt(
        "covariate",
        f"{column} is {values[wrong][0]:.4g} in {name_trials(which, len(names))}; {expected}; "
        "likely another unit or a lost decimal point; check trials.csv",
        tuple(which),
    )


def _get_range(column: str) -> tuple[float, float, str]:
    return next((r for end, r in RANGES.items() if column.endswith(end)), (-np.inf, np.inf, ""))


def _find_out_of_range(column: str, values: Array) -> NDArray[np.bool_]:
    low, high, _ = _get_range(column)
    return np.isfinite(values) & ((values < low) | (values > high))


def _find_slip(values: Array) -> NDArray[np.bool_]:
    """Values that a slip of the unit explains.

    They lie far from all the others, and the slip makes them of these.
    """
    known = np.isfinite(values)
    wrong = np.zeros(values.size, bool)
    usual = np.median(values[known]) if known.any() else 0.0
    if known.sum() < 4 or usual == 0.0:
        return wrong
    spread = max(1.4826 * np.median(np.abs(values[known] - usual)), 0.03 * abs(usual))
    slips = [usual * f for f in FACTORS if f >= 10.0] + [usual / f for f in FACTORS if f >= 10.0]
    slips += [1.8 * usual + 32.0, usual + 273.15, -usual]
    for k in np.flatnonzero(known & (np.abs(values - usual) > SPREADS * spread)):
        wrong[k] = any(abs(values[k] - slip) < 0.15 * abs(slip) for slip in slips)
    return wrong if wrong.sum() <= max(1, ALONE * known.sum()) else np.zeros_like(wrong)
