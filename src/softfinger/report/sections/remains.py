"""What the final model leaves.

It states where and when, and on what it depends.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from softfinger.report.blocks import Block, Paragraph, Section, keep_blocks
from softfinger.report.formatting import (
    count_things,
    fix,
    format_measure,
    format_number,
    format_percent,
    join_words,
)
from softfinger.report.material import Material
from softfinger.report.pictures.free_form import picture_free_form
from softfinger.report.pictures.mismatch import picture_location
from softfinger.report.verdict import NOT_RUN

ARGUMENTS = {
    "time_s": "time",
    "time_since_change_s": "the time since the load changed",
    "load": "the load",
    "angle_rad": "the joint's angle",
    "rate_rad_per_s": "the rate at which the joint moves, which the angle follows late",
    "trial_number": "the number of trials before",
    "rest_s": "the rest before the trial",
    "largest_load": "the trial's largest load",
    "largest_load_before": "the largest load of the trial before",
}


SMALL = 1e-3
"""p-values below are written as such."""


def build_remains(material: Material) -> Section:
    """Section on what is left: where, when, on what it depends."""
    title = "What remains"
    if "verdict" not in material:
        return Section("remains", title, (Paragraph(NOT_RUN, "note"),))
    verdict = material.artifacts["verdict"]
    words = [state_remaining(verdict["remaining"])] if verdict.get("remaining") else []
    blocks = keep_blocks(
        *(Paragraph(sentence) for sentence in words),
        *describe_unlisted(material),
        picture_location(material),
    )
    return Section("remains", title, blocks, (("mismatch", "fit before and after"),))


def state_remaining(left: Mapping[str, Any]) -> str:
    """State how much is left, and where most of it is."""
    p = left["p_value"]
    often = "less than 0.1 %" if p < SMALL else format_percent(p, 0 if p > 0.1 else 1)
    size = fix(left["rms_over_noise"], 2)
    return (
        f"Under the final model what remains within trials is {size} times what the measurement "
        f"allows; chance alone leaves as much in {often} of campaigns. Where it shows most: "
        f"{left['where']}."
    )


def describe_unlisted(material: Material) -> list[Block]:
    """Describe an `unlisted` misfit and draw its shape.

    It states where the misfit shows and on what it depends.
    """
    verdict = material.artifacts["verdict"]
    if verdict["decision"] != "unlisted":
        return []
    found = material.find("location")
    sentences = [state_location(verdict["location"], found)] if verdict["location"] else []
    if found["line_shows"]:
        sentences.append(state_line(material.get("location")))
    picture = picture_free_form(material)
    if picture is not None:
        joints = verdict["free_form"]["joints"] if verdict["free_form"] else []
        sentences.append(state_free_form(material.get("free_form"), joints))
    blocks: list[Block] = [Paragraph(sentence) for sentence in sentences]
    return blocks if picture is None else [*blocks, picture]


def state_location(location: Mapping[str, Any], found: xr.Dataset) -> str:
    """State where a misfit shows.

    `found` has the joints in which it does.
    """
    where = name_joints(found["joint"].values[found["shows"].values].tolist())
    if location["level"] == "between_trials":
        return f"It shows between trials{where}, with {name_argument(location['covariate'])}."
    if location["trials"]:
        names = join_words(location["trials"])
        count = count_things(len(location["trials"]), "trial")
        return f"It shows as jumps of the recording{where}, in {count}: {names}."
    if location["times_s"]:
        first, last = (format_number(time) for time in location["times_s"])
        return f"It shows within trials{where}, {first} s to {last} s after the load changed."
    return f"It shows within trials{where}."


def state_line(location: xr.Dataset) -> str:
    """State the spectral line among the residuals."""
    joint = int(location["line_joint"])
    where = f"joint {joint}" if joint else "all joints, as the load moves them"
    frequency = format_number(float(location["line_frequency"]))
    return f"A spectral line at {frequency} Hz is far above the rest of what is left, in {where}."


def state_free_form(free_form: xr.Dataset, joints: list[int]) -> str:
    """State on what the misfit depends.

    It adds what the free-form term does for the fit.

    `joints` are those in which its curve clearly differs from zero.
    """
    before, after = (float(free_form[name]) for name in ("excess_without", "excess"))
    difference, se = (float(free_form[name]) for name in ("elpd_difference", "elpd_se"))
    gain = format_number(float(free_form.attrs["gain_nats"]))
    score = (
        ""
        if np.isnan(difference)
        else " Leave-one-trial-out log score, with it minus without: "
        f"{format_measure(difference, se)} nats."
    )
    return (
        f"It depends on {name_argument(str(free_form.attrs['argument']))}: a free-form curve of "
        f"that{name_joints(joints)} gains {gain} nats.{score} What is left within trials exceeds "
        f"the noise's variance by {format_percent(after)} with it and by {format_percent(before)} "
        "without. The curve is in the next figure, and as numbers in the artifact free_form: a "
        "start for an effect of your own."
    )


def name_joints(joints: list[int]) -> str:
    """Name joints in words that follow others.

    >>> name_joints([2]), name_joints([1, 3]), name_joints([])
    (' in joint 2', ' in joints 1 and 3', '')
    """
    words = join_words([str(joint) for joint in joints])
    return f" in {'joint' if len(joints) == 1 else 'joints'} {words}" if joints else ""


def name_argument(argument: str) -> str:
    """Name what a free-form term depends on, in words.

    >>> name_argument("humidity_pct")
    'humidity pct'
    """
    return ARGUMENTS.get(argument, argument.replace("_", " "))
