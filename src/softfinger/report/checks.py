"""The artifact's checks in words."""

from collections.abc import Callable

import xarray as xr

from softfinger.report.blocks import Check
from softfinger.report.formatting import format_number, format_percent, format_shares, join_words
from softfinger.report.material import Material

PARETO = "largest Pareto k, leaving one trial out"
ENOUGH = "Enough independent draws for the {} of every hyperparameter."
SHARED = (
    "The mean over trials of recording minus model is no larger than what independent trials leave "
    "by chance."
)
COVERED = (
    "The predictive bands contain the share of recorded frames that they claim, but for what so "
    "few trials leave open."
)
MEANINGS = {
    "r_hat": "Independent chains found the same distribution.",
    "ess_bulk": ENOUGH.format("centre"),
    "ess_tail": ENOUGH.format("tails"),
    "divergences": "The sampler met no region that it could not follow.",
    "pareto_k": "No single trial decides the population, so leave-one-trial-out scores are sound.",
    "shared_residual": SHARED,
    "shared_residual_early": SHARED,
    "ring": "No oscillation that most trials share is missing in the model.",
    "coverage": COVERED,
    "coverage_early": COVERED,
}
"""Check → what it means when it is passed."""
NAMES = {
    "r_hat": "largest R-hat",
    "ess_bulk": "fewest effective draws, bulk",
    "ess_tail": "fewest effective draws, tail",
    "divergences": "divergent transitions",
    "pareto_k": PARETO,
    "shared_residual": "shared residual, all of it",
    "shared_residual_early": "shared residual, first second",
    "ring": "ring in the residual",
    "coverage": "coverage of the {} bands, whole recording",
    "coverage_early": "coverage of the {} bands, first second",
}
COMPUTATION = ("r_hat", "ess_bulk", "ess_tail", "divergences", "pareto_k")
FIT = ("shared_residual", "shared_residual_early", "ring")
CALIBRATION = ("coverage", "coverage_early")


def list_checks(material: Material, names: tuple[str, ...]) -> tuple[Check, ...]:
    """List checks of the artifact `checks` in words."""
    found = material.find("checks")
    return tuple(_word_check(material, found.sel(check=name)) for name in names)


def _word_check(material: Material, found: xr.Dataset) -> Check:
    name = str(found["check"].item())
    passed = {1: True, 0: False}.get(int(found["passed"]))
    said = str(found["remark"].item()) if passed is None else FOUND[name](material, found)
    title = NAMES[name].format(_claimed(material))
    powered = bool(found["powered"])
    return Check(title, said, _word_limit(name, found), passed, MEANINGS[name], powered)


def _claimed(material: Material) -> str:
    calibration = material.find("calibration")
    return "predictive" if calibration is None else format_percent(float(calibration["claimed"]))


def _word_limit(name: str, found: xr.Dataset) -> str:
    lower, upper = float(found["lower"]), float(found["upper"])
    if name in CALIBRATION:
        return format_shares(lower, upper, 1)
    if name == "ring":
        return "none"
    if name == "divergences":
        return f"at most {format_number(upper)}"
    if lower == -float("inf") and upper == float("inf"):
        return "–"
    if name.startswith("shared"):
        return f"below {upper:.1f} times"
    return f"above {lower:.0f}" if lower > -float("inf") else f"below {format_number(upper, 4)}"


def list_rings(material: Material) -> list[str]:
    """List the rings in the residual, as words."""
    residuals = material.find("residuals")
    return [] if residuals is None else [f"{ring:.1f} Hz" for ring in residuals["rings"].values]


def _word_pareto(material: Material, found: xr.Dataset) -> str:
    beyond, n = int(found["trials"]), material.angles.sizes["trial"]
    said = f"{float(found['value']):.2f}; {beyond} of {n} trials too large"
    return ", ".join(filter(None, (said, str(found["remark"].item()))))


def _word_coverage(material: Material, found: xr.Dataset) -> str:
    del material
    return f"{format_percent(float(found['value']), 1)} (joint {int(found['joint'])})"


FOUND: dict[str, Callable[[Material, xr.Dataset], str]] = {
    "r_hat": lambda _, found: format_number(float(found["value"]), 4),
    "ess_bulk": lambda _, found: f"{float(found['value']):.0f}",
    "ess_tail": lambda _, found: f"{float(found['value']):.0f}",
    "divergences": lambda _, found: f"{float(found['value']):.0f}",
    "pareto_k": _word_pareto,
    "shared_residual": lambda _, found: f"{float(found['value']):.1f} times chance",
    "shared_residual_early": lambda _, found: f"{float(found['value']):.1f} times chance",
    "ring": lambda material, _: join_words(list_rings(material)) or "none",
    "coverage": _word_coverage,
    "coverage_early": _word_coverage,
}
"""Check → what was found, in words."""


def combine_checks(checks: tuple[Check, ...]) -> bool | None:
    """Combine checks into True, False or None.

    False if any failed, True if the rest has at least one pass, else None.

    >>> combine_checks(())
    """
    results = {check.passed for check in checks}
    return False if False in results else True if True in results else None
