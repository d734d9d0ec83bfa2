"""The verdicts at the page's head.

Each states what its test could have seen.
"""

from __future__ import annotations

import math

from softfinger.figures.style import label_thousandth
from softfinger.report.blocks import Check, Tile
from softfinger.report.checks import (
    CALIBRATION,
    COMPUTATION,
    FIT,
    PARETO,
    combine_checks,
    list_checks,
)
from softfinger.report.formatting import format_number
from softfinger.report.material import Material
from softfinger.report.sections.mismatch import judge_mismatch


def judge_tiles(material: Material) -> tuple[Tile, ...]:
    """Judge computation, fit and calibration.

    A single failed check makes a tile red.
    """
    computation = list_checks(material, COMPUTATION)
    only_pareto = {check.name for check in computation if check.failed} == {PARETO}
    bad = "depends on single trials" if only_pareto else "not sound"
    calibration, fit = list_checks(material, CALIBRATION), list_checks(material, FIT)
    return (
        judge_checks("Computation", ("sound", bad), computation, "computation"),
        judge_checks(
            "Calibration", ("as claimed", "off"), calibration, "calibration",
            f"a coverage outside {calibration[0].limit} would fail",
        ),
        judge_checks(
            "Motion that trials share", ("none is left", "some is left"), fit, "predictive",
            say_detectable(material),
        ),
        judge_mismatch(material),
    )  # fmt: skip


def say_detectable(material: Material) -> str:
    """Tell what shared motion the residual would have shown."""
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
    fine = [f"{made} of {len(checks)} checks made, none failed", power]
    detail = "; ".join(failed or filter(None, fine))
    if passed and not any(check.passed and check.powered for check in checks):
        return Tile(question, "not contradicted", None, detail, anchor)
    answer = "not judged" if passed is None else answers[0] if passed else answers[1]
    return Tile(question, answer, passed, detail, anchor)
