"""The verdicts at the page's head.

Each states what was tested, and what the test would have seen. Two tests that look at the same
thing must not contradict each other: the sharper one decides.
"""

import math
from dataclasses import replace

from softfinger.report.blocks import Check, Tile
from softfinger.report.checks import (
    CALIBRATION,
    COMPUTATION,
    FIT,
    PARETO,
    combine_checks,
    list_checks,
)
from softfinger.report.formatting import (
    count_things,
    format_number,
    format_percent,
    format_shares,
)
from softfinger.report.material import Material
from softfinger.report.overview.measurement import list_warnings
from softfinger.report.sections.mismatch import judge_mismatch
from softfinger.report.verdict import state_left
from softfinger.units import label_thousandth


def judge_tiles(material: Material) -> tuple[Tile, ...]:
    """Judge computation, fit, calibration and physics.

    Of a diagnosis alone: physics, what remains, recordings.
    """
    if not material.is_fitted:
        return judge_mismatch(material), judge_remains(material), judge_recordings(material)
    return reconcile(judge_computation(material), *judge_fit(material), judge_mismatch(material))


def judge_computation(material: Material) -> Tile:
    """Judge the computation; a Pareto k alone is no fault of it."""
    checks = list_checks(material, COMPUTATION)
    only_pareto = {check.name for check in checks if check.failed} == {PARETO}
    bad = "depends on single trials" if only_pareto else "not sound"
    limit = material.find("checks")
    r_hat, draws = limit["upper"].sel(check="r_hat"), limit["lower"].sel(check="ess_bulk")
    power = f"an R-hat above {float(r_hat):g} or fewer than {float(draws):g} draws would fail"
    power = power if checks[0].passed is not None else ""
    return judge_checks("Computation", ("sound", bad), checks, "computation", power)


def judge_fit(material: Material) -> tuple[Tile, Tile]:
    """Judge the calibration of the bands, and what the fit leaves."""
    calibration, fit = list_checks(material, CALIBRATION), list_checks(material, FIT)
    return (
        judge_checks(
            "Calibration", ("as claimed", "off"), calibration, "calibration",
            state_coverage_limit(material),
        ),
        judge_checks(
            "Motion that trials share", ("none is left", "some is left"), fit, "predictive",
            state_detectable(material),
        ),
    )  # fmt: skip


def reconcile(computation: Tile, calibration: Tile, fit: Tile, physics: Tile) -> tuple[Tile, ...]:
    """Take back what a sharper test contradicts.

    No green tile rests on a computation that is not sound. The diagnosis looks within trials,
    the check of the fit at their mean: where one sees something, the other has only not seen it.
    """
    if computation.answer == "not sound":
        calibration, fit = (withdraw(tile, "not judged", UNSOUND) for tile in (calibration, fit))
    if physics.passed is False:
        fit = withdraw(fit, "too small for this test", "the diagnosis sees it within trials")
    if fit.passed is False:
        physics = withdraw(physics, "none listed is seen", "motion that trials share is left")
    return computation, calibration, fit, physics


UNSOUND = "the computation is not sound"


def withdraw(tile: Tile, answer: str, reason: str) -> Tile:
    """Leave open what was passed."""
    if not tile.passed:
        return tile
    return replace(tile, answer=answer, passed=None, detail=f"{tile.detail}; {reason}")


def judge_remains(material: Material) -> Tile:
    """Judge whether what remains is noise."""
    verdict = material.artifacts["verdict"]
    passed = verdict["decision"] != "unlisted"
    answer = "noise" if passed else "more than noise"
    detail = state_left(verdict) or "not measured"
    return Tile("What remains", answer, passed, detail, "remains")


def judge_recordings(material: Material) -> Tile:
    """Count what the recordings suffer from; none of it is a fault of the model."""
    found = len(material.artifacts["verdict"].get("measurement") or ())
    warnings = count_things(len(list_warnings(material)), "warning")
    aside = material.angles["set_aside_trial"].size
    used = count_things(material.angles["trial"].size, "trial")
    answer = count_things(found, "finding") if found else "nothing found"
    detail = f"{used} used, {aside} set aside; {warnings}"
    return Tile("The recordings", answer, None, detail, "measurement")


def state_coverage_limit(material: Material) -> str:
    """State which coverage would have failed."""
    limit = material.find("checks").sel(check="coverage")
    lower, upper = float(limit["lower"]), float(limit["upper"])
    if upper >= 1:
        return f"a coverage below {format_percent(lower, 1)} would fail"
    return f"a coverage outside {format_shares(lower, upper, 1)} would fail"


def state_detectable(material: Material) -> str:
    """State what shared motion the residual would have shown."""
    residuals = material.find("residuals")
    size = math.nan if residuals is None else 1e3 * float(residuals["detectable"])
    unit = label_thousandth(material.motion_unit)
    return (
        f"from {format_number(size, 2)} {unit} on it would be seen" if math.isfinite(size) else ""
    )


def judge_checks(
    question: str, answers: tuple[str, str], checks: tuple[Check, ...], anchor: str, power: str = ""
) -> Tile:
    """Summary of checks in one tile.

    It states what failed, or how many were made and what they would show.
    """
    passed = combine_checks(checks)
    failed = [f"{check.name}: {check.found}" for check in checks if check.failed]
    made = sum(check.passed is not None for check in checks)
    every = made == len(checks)
    count = f"all {made} checks passed" if every else f"{made} of {len(checks)} made, none failed"
    fine = [count, power]
    detail = "; ".join(failed or filter(None, fine))
    if passed and not any(check.passed and check.powered for check in checks):
        return Tile(question, "not contradicted", None, detail, anchor)
    answer = "not judged" if passed is None else answers[0] if passed else answers[1]
    return Tile(question, answer, passed, detail, anchor)
