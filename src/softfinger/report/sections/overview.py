"""The first layer of the report.

The head of a lab reads it in two minutes.
"""

from __future__ import annotations

from softfinger.figures.style import label_parameter_unit, label_thousandth
from softfinger.report.blocks import Block, Listing, Paragraph, Section, Table, number, text
from softfinger.report.checks import FIT, combine_checks, list_checks, list_rings
from softfinger.report.formatting import (
    count_things,
    format_interval,
    format_number,
    format_percent,
    join_words,
)
from softfinger.report.material import Material
from softfinger.report.pictures.fit import picture_bands
from softfinger.report.pictures.mismatch import picture_repair
from softfinger.report.pictures.spread import picture_sobol
from softfinger.report.sections.data import describe_flags
from softfinger.report.sections.mismatch import NOT_RUN, describe_next, state_verdict
from softfinger.report.sections.outlook import list_data_limits, list_unsure
from softfinger.report.sections.parameters import each_parameter


def build_verdict(material: Material) -> Section:
    """The verdict in a sentence, with its figure."""
    more = (("mismatch", "left-out physics"), ("outlook", "what would change the conclusion"))
    doubts = warn(list_doubts(material))
    if "verdict" not in material:
        blocks = (*doubts, Paragraph(NOT_RUN, "note"))
        return Section("verdict", "What was found", blocks, more)
    first, *rest = state_verdict(material.artifacts["verdict"])
    blocks = (
        *doubts,
        Paragraph(first, "lead"),
        Listing(tuple(rest)) if rest else None,
        picture_repair(material),
    )
    return Section("verdict", "What was found", _there(*blocks), more)


MOST_WARNINGS = 2


def list_doubts(material: Material) -> list[str]:
    """List what looks wrong in the recordings."""
    if "doubts" not in material:
        return []
    return [f"{said}." for said in material.artifacts["doubts"]["statement"].values.astype(str)]


def warn(doubts: list[str]) -> tuple[Paragraph, ...]:
    """Warn of what looks wrong before anything is claimed."""
    hidden = len(doubts) - MOST_WARNINGS
    more = f" {count_things(hidden, 'warning')} more: see what the recordings suffer from."
    words = " ".join(doubts[:MOST_WARNINGS]) + (more if hidden > 0 else "")
    return (Paragraph(f"Warning: {words}", "warning"),) if doubts else ()


def build_motion(material: Material) -> Section:
    """Build the recordings beside the model."""
    sentences = [say_campaign(material), *describe_misfit(material)]
    return Section(
        "motion",
        "Recordings and model",
        _there(Paragraph(" ".join(sentences)), picture_bands(material, early=False)),
        (("data", "the recordings"), ("predictive", "residuals"), ("calibration", "calibration")),
    )


def build_spread(material: Material) -> Section:
    """Build the table of the parameters and their spread."""
    more = (("parameters", "other estimates"), ("model", "the model and its priors"))
    title = "Parameters and their spread"
    summary = material.find("population")
    if summary is None:
        return Section("spread", title, (Paragraph("The fit was not run.", "warning"),), more)
    share = format_percent(material.ci_prob)
    rows = []
    for parameter, joint, here in each_parameter(summary):
        sigma = here["quantile_value"].sel(statistic="sigma").values
        centre = here["centre_quantile"].values
        rows.append(
            (
                text(parameter),
                number(str(joint), joint),
                text(label_parameter_unit(parameter, material.load_unit, material.motion_unit)),
                number(format_interval(centre[0], centre[-1]), float(here["centre"])),
                number(format_interval(sigma[0], sigma[-1]), float(sigma[2])),
            )
        )
    caption = (
        f"{share} intervals of the median over trials and of the spread between trials: standard "
        f"deviation of the logarithm, of q_ini in {material.motion_unit}."
    )
    columns = ("parameter", "joint", "unit", "centre", "spread")
    table = Table("in_short", "Centre and spread", caption, columns, tuple(rows))
    alone = ALONE if material.is_alone else None
    return Section("spread", title, _there(table, alone), more)


ALONE = Paragraph(
    "One trial cannot tell how much trials differ: every spread in this report, and every share "
    "of it, is what was assumed before.",
    "warning",
)


def build_causes(material: Material) -> Section:
    """Build what causes the spread of the motion."""
    more = (("sensitivity", "shares in numbers, and parameters that go together"),)
    sentences = describe_causes(material)
    blocks = (*(Paragraph(sentence) for sentence in sentences), picture_sobol(material))
    found = _there(*blocks) or (Paragraph("The sensitivity was not computed.", "note"),)
    return Section("causes", "What causes the spread", found, more)


def build_measurement(material: Material) -> Section:
    """Build what the recordings themselves suffer from."""
    verdict = material.artifacts.get("verdict") or {}
    measured = [str(part["statement"]) for part in verdict.get("measurement") or ()]
    items = [*list_doubts(material), *measured]
    items.append(describe_flags(material))
    aside = material.angles["set_aside_trial"].size
    if aside:
        items.append(f"{count_things(aside, 'trial')} set aside, each with its reason.")
    more = (("measured", "in numbers"), ("data", "every trial, and those set aside"))
    title = "What the recordings suffer from"
    return Section("measurement", title, (Listing(tuple(items)),), more)


def build_next(material: Material) -> Section:
    """Build what to record next."""
    proposed = describe_next(material.artifacts.get("verdict") or {})
    items = [*proposed, *list_unsure(material), *list_data_limits(material)[:1]]
    more = (("outlook", "what would change the conclusion"), ("origin", "how to rerun this"))
    return Section("next", "What to record next", (Listing(tuple(items)),), more)


def _there(*blocks: Block | None) -> tuple[Block, ...]:
    return tuple(block for block in blocks if block is not None)


def say_campaign(material: Material) -> str:
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


def describe_misfit(material: Material) -> list[str]:
    """Tell what motion that trials share the model leaves."""
    residuals = material.find("residuals")
    if residuals is None:
        return ["The fit was not run."]
    sentences = []
    if combine_checks(list_checks(material, FIT)) is False:
        largest, share = float(residuals["largest_mean"].max()), residuals["largest_share"]
        sentences.append(
            "The model misses motion that the trials share: up to "
            f"{format_number(1e3 * largest, 2)} {label_thousandth(material.motion_unit)} in the "
            "mean over trials, "
            f"{format_percent(float(share), 1)} of the range of the recorded angles."
        )
    rings = list_rings(material)
    if rings:
        sentences.append(
            f"After a change of load the finger rings at {join_words(rings)}, which the fitted "
            "model does not."
        )
    return sentences


def describe_causes(material: Material) -> list[str]:
    """State which parameter causes most of the spread.

    The time is that at which the spread is widest.
    """
    found = material.find("causes")
    if found is None or material.is_alone:
        return []
    parts = []
    for joint in found["joint"].values:
        here = found.sel(joint=joint)
        share, when = float(here["share"]), float(here["widest"])
        share_then = f"{format_percent(share)} after {format_number(when)} s"
        parts.append(f"{here['cause'].item()} at joint {joint} ({share_then})")
    return [f"Where the spread between trials is widest, it is mostly that of {join_words(parts)}."]
