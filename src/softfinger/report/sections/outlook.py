"""What would change the conclusion."""

import re

from softfinger.report.blocks import Listing, Paragraph, Section, keep_blocks
from softfinger.report.checks import CALIBRATION, COMPUTATION, FIT, PARETO, list_checks
from softfinger.report.formatting import (
    count_things,
    format_number,
    format_percent,
    join_words,
)
from softfinger.report.material import Material
from softfinger.report.pictures.assumptions import picture_assumptions
from softfinger.report.sections.parameters import list_fitted_effects

QUOTE_NOTHING = "until it passes, no interval of this report should be quoted"
PARETO_FAILS = (
    "single trials decide much, so scores that leave one out by weighting are unreliable; the "
    "posterior itself is not touched by this"
)


def build_outlook(material: Material) -> Section:
    """List of what the conclusion depends on.

    Each entry is read from this campaign.
    """
    items = [
        *list_failed(material),
        *list_data_limits(material),
        *list_unsure(material),
        *list_assumptions(material),
    ]
    lead = Paragraph("The conclusion depends on the following. If one is wrong, it changes.")
    blocks = (lead, Listing(tuple(items)), picture_assumptions(material))
    return Section("outlook", "What would change the conclusion?", keep_blocks(*blocks))


def list_failed(material: Material) -> list[str]:
    """List failed checks as reasons for doubt."""
    consequence = {
        COMPUTATION: QUOTE_NOTHING,
        CALIBRATION: "the bands are too narrow or too wide for a new trial",
        FIT: "physics is missing, and the parameters may have absorbed a part of it",
    }
    return [
        f"Failed: {check.name} is {check.found} (limit: {check.limit}): "
        f"{PARETO_FAILS if check.name == PARETO else meaning}."
        for names, meaning in consequence.items()
        for check in list_checks(material, names)
        if check.failed
    ]


def list_data_limits(material: Material) -> list[str]:
    """What the amount and kind of data leave open."""
    angles, found = material.angles, material.recordings
    n = angles["trial"].size
    told = "shows nothing of the spread between trials"
    if not material.is_alone:
        told = f"determine the spread to ± {format_percent(float(found['spread_error']))} at best"
    items = [f"The number of trials: {count_things(n, 'trial')} {told}."]
    if found["one_load"]:
        items.append(
            "The protocol: one constant load per trial. Effects that depend on the load or show "
            "when it is released (friction, thresholds, stiffening) cannot be seen and would be "
            "taken for parameters; levels with release would show them."
        )
    if "assumed" in angles["load_kind"].values.astype(str):
        items.append("The load of some trials was assumed, not logged.")
    if angles["set_aside_trial"].size:
        items.append(
            f"{count_things(angles['set_aside_trial'].size, 'trial')} set aside: if the reason has "
            "to do with how the finger moved, what is left is no fair sample."
        )
    return items


def list_unsure(material: Material) -> list[str]:
    """List spreads that the recordings hardly determine."""
    unsure = name_unsure(material)
    if not unsure:
        return []
    sentence = (
        f"Hardly determined spreads, which the prior decides as much as the data: "
        f"{', '.join(unsure)} (posterior sd above half of the spread). Longer recordings would "
        "help for c_p, faster ones for c_v."
    )
    return [sentence]


def count_unsure(material: Material) -> list[str]:
    """Count the spreads that the recordings hardly determine."""
    unsure, found = name_unsure(material), material.find("population")
    if not unsure:
        return []
    share = f"{len(unsure)} of {found['unsure'].size} spreads are hardly determined"
    return [f"Longer recordings for c_p, faster ones for c_v: {share}."]


def name_unsure(material: Material) -> list[str]:
    """Name the parameters of hardly determined spreads."""
    found = material.find("population")
    if found is None:
        return []
    return [
        f"{parameter} at joint {joint}"
        for parameter in found["parameter"].values
        for joint in found["joint"].values
        if found["unsure"].sel(parameter=parameter, joint=joint)
    ]


def list_assumptions(material: Material) -> list[str]:
    """List what the model takes for granted."""
    duration = format_number(float(material.recordings["trial_duration"].max()))
    effects = list_fitted_effects(material)
    left_out = "inertia is left out, the torque does not depend on the angle, and"
    if effects:
        left_out = f"it has no physics but that of its joint and {join_words(effects)}; and"
    model = (
        f"The model itself: {left_out} under a constant load c_p flows at a constant rate for all "
        f"of the {duration} s; nothing is claimed beyond them."
    )
    items = [
        model,
        "Trials are taken as exchangeable: no trend with trial number, temperature or rest.",
    ]
    if "assumptions" in material:
        sentences = material.artifacts["assumptions"]["statement"].values
        signed = [re.sub(r"(?<=\s)-(?=\d)", "−", str(sentence)) for sentence in sentences]
        items += [f"Simulated fingers of the paper's table: {sentence}" for sentence in signed]
    return items
