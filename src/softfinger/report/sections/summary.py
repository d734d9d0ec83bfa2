"""The head of the page: the question, the verdicts, and the answer in a few sentences."""

from __future__ import annotations

import numpy as np

from softfinger.report.blocks import Check, Listing, Section, Tile
from softfinger.report.checks import (
    PARETO,
    check_calibration,
    check_computation,
    check_fit,
    combine,
)
from softfinger.report.formatting import (
    count_things,
    format_number,
    format_percent,
    join_words,
)
from softfinger.report.material import Material
from softfinger.report.sections.mismatch import judge_mismatch, state_verdict
from softfinger.report.sections.sensitivity import find_main_cause


def judge(material: Material) -> tuple[Tile, ...]:
    """Judge computation, fit and calibration; a single failed check makes a tile red."""
    computation = check_computation(material)
    only_pareto = {check.name for check in computation if check.failed} == {PARETO}
    bad = "leans on single trials" if only_pareto else "not sound"
    return (
        judge_checks("Computation", ("sound", bad), computation, "computation"),
        judge_checks(
            "Calibration", ("as claimed", "off"), check_calibration(material), "calibration"
        ),
        judge_checks(
            "Model against recordings", ("agree", "differ"), check_fit(material), "predictive"
        ),
        judge_mismatch(material),
    )


def judge_checks(
    question: str, answers: tuple[str, str], checks: tuple[Check, ...], anchor: str
) -> Tile:
    """Sum checks up in one tile that names what failed."""
    passed = combine(checks)
    failed = [f"{check.name}: {check.found}" for check in checks if check.failed]
    made = sum(check.passed is not None for check in checks)
    detail = "; ".join(failed) if failed else f"{made} of {len(checks)} checks made, none failed"
    answer = "not judged" if passed is None else answers[0] if passed else answers[1]
    return Tile(question, answer, passed, detail, anchor)


def build_question(material: Material) -> Section:
    """Build the answer in short."""
    sentences = [describe_campaign(material), *describe_fit(material), *describe_causes(material)]
    if "verdict" in material:
        found = state_verdict(material.artifacts["verdict"])
        sentences.append(f"Left-out physics: {' '.join(found)}")
    return Section(
        "question", "The question, and the answer in short", (Listing(tuple(sentences)),)
    )


def describe_campaign(material: Material) -> str:
    """Say what was recorded."""
    angles = material.angles
    aside = angles["set_aside_trial"].size
    verb = "is" if angles["trial"].size == 1 else "are"
    return (
        f"{count_things(angles['trial'].size, 'trial')} of one finger of "
        f"{count_things(angles['joint'].size, 'joint')} {verb} used, "
        f"{f'{aside} set aside' if aside else 'none was set aside'}; "
        f"the data are {material.source}."
    )


def describe_fit(material: Material) -> list[str]:
    """Say how stiff the joints are, how much they vary, and what the model leaves."""
    summary, residuals = material.hyperparameters, material.residuals
    if summary is None or residuals is None:
        return ["The fit was not run."]
    stiff = summary.sel(parameter="k_v")
    alone = material.angles.sizes["trial"] == 1
    spread = stiff["quantile_value"].sel(statistic="sigma", quantile=0.5)
    parts = [
        f"{format_number(float(centre))}{'' if alone else f' (± {format_percent(float(sigma))})'} "
        f"at joint {joint}"
        for joint, centre, sigma in zip(
            stiff["joint"].values, stiff["centre"].values, spread.values, strict=True
        )
    ]
    words = f"Stiffness k_v [{material.load_unit}/rad]"
    words += "" if alone else ", with its spread between trials"
    sentences = [f"{words}: {join_words(parts)}."]
    if alone:
        sentences.append(
            "One trial cannot tell how much trials differ: every spread in this report, and every "
            "share of it, is what was assumed before."
        )
    if judge(material)[2].passed is False:
        largest = float(np.abs(residuals["mean_residual"]).max())
        seen = material.angles["joint_angle"].where(material.angles["angle_flag"] == 0)
        share = largest / float(seen.max() - seen.min())
        sentences.append(
            "The model misses motion that the trials share: up to "
            f"{format_number(1e3 * largest, 2)} mrad in the mean over trials, "
            f"{format_percent(share, 1)} of the range of the recorded angles."
        )
    peaks = residuals["peak_frequency"].values
    rings = sorted({f"{peak:.1f} Hz" for peak in peaks[np.isfinite(peaks)]})
    if rings:
        sentences.append(
            f"After a change of load the finger rings at {join_words(rings)}, which the model, "
            "having no inertia, cannot do."
        )
    return sentences


def describe_causes(material: Material) -> list[str]:
    """Say which parameter causes most of the spread where it is widest."""
    if "sobol" not in material or material.angles.sizes["trial"] == 1:
        return []
    parts = []
    for joint in material.angles["joint"].values:
        name, share, when = find_main_cause(material.get("sobol"), int(joint))
        share_then = f"{format_percent(share)} after {format_number(when)} s"
        parts.append(f"{name} at joint {joint} ({share_then})")
    return [f"Where the spread between trials is widest, it is mostly that of {join_words(parts)}."]
