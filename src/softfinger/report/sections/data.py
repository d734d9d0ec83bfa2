"""What was recorded, and what is unused."""

import numpy as np

from softfinger.report.blocks import Block, Paragraph, Section, Table, number, text
from softfinger.report.formatting import (
    capital,
    count_things,
    format_number,
    format_percent,
    join_words,
)
from softfinger.report.material import Material
from softfinger.report.pictures.recordings import picture_recordings, picture_tracking

SAID = {
    "missing": "missing",
    "stale": "stale (the camera repeated a frame)",
    "jump": "jumps (a marker was lost to another spot)",
}
TRACKING = {
    "share_seen": "seen",
    "share_suspect": "in doubt",
    "share_stale": "repeated frames",
    "sd": "sd [px]",
    "rigid_residual": "wander on its link [px]",
}
ALWAYS_SHOWN = 12
"""A longer table of trials is folded."""


def build_data(material: Material) -> Section:
    """Section with counts, pictures and unused trials."""
    blocks: list[Block | None] = [
        Paragraph(describe_recordings(material)),
        *describe_loads(material),
        picture_recordings(material),
        picture_tracking(material),
        build_tracking_table(material),
        *build_set_aside(material),
        build_trial_table(material),
    ]
    return Section("data", "What was recorded", tuple(block for block in blocks if block))


def describe_recordings(material: Material) -> str:
    """Describe how much was recorded and how finely."""
    angles, found = material.angles, material.recordings
    verb = "is" if angles["trial"].size == 1 else "are"
    return (
        f"{count_things(angles['trial'].size, 'trial')} of "
        f"{count_things(angles['joint'].size, 'joint')} {verb} used, "
        f"{int(found['frames'])} frames in all, "
        f"{describe_span(found['trial_duration'].values)} s long, "
        f"about {format_number(1 / float(found['frame_interval']))} frames a second. "
        f"{describe_flags(material)}"
    )


def describe_flags(material: Material) -> str:
    """Tell how many angles are missing or in doubt."""
    found = material.recordings
    shares = dict(zip(found["flag"].values.tolist(), found["flag_share"].values, strict=True))
    words = [
        f"{format_percent(share, 1)} are {SAID[name]}" for name, share in shares.items() if share
    ]
    if not words:
        return "No angle is missing or in doubt."
    return f"Of the angles, {join_words(words)}; they take no part in any fit."


def describe_span(values: np.ndarray) -> str:
    """The span of values, or their one value.

    >>> describe_span(np.array([30.0, 30.0])), describe_span(np.array([5.0, 30.0]))
    ('30', '5 to 30')
    """
    low, high = (format_number(float(end)) for end in (values.min(), values.max()))
    return low if low == high else f"{low} to {high}"


def describe_loads(material: Material) -> list[Block]:
    """State what loaded the finger.

    It warns where nobody wrote it down.
    """
    kinds = {str(kind) for kind in material.angles["load_kind"].values}
    blocks: list[Block] = []
    if "command" in kinds and "motion_unit" not in material.angles.attrs:
        blocks.append(
            Paragraph(
                "The load is a command without a physical unit (a PWM level, a pressure). "
                "Stiffness and damping are therefore per unit of that command and cannot be "
                "compared with other fingers.",
                "note",
            )
        )
    if "assumed" in kinds:
        blocks.append(
            Paragraph(
                "Some trials have no load log: a unit command from the first frame was assumed. "
                "Stiffness and damping are per unit of that assumption, and what needs the log "
                "(delays, friction, thresholds) cannot be tested.",
                "warning",
            )
        )
    return blocks


def build_tracking_table(material: Material) -> Table | None:
    """Table of each filmed trial's tracking quality.

    The worst marker counts.
    """
    found = material.find("tracking")
    if found is None:
        return None
    rows = []
    for name in found["trial"].values:
        values = [(label, float(found[v].sel(trial=name))) for v, label in TRACKING.items()]
        cells = [
            number(format_number(v, 2) if "px" in key else format_percent(v, 1), v)
            for key, v in values
        ]
        rows.append((text(name), *cells))
    limits = material.config["tracking"]
    caption = (
        "The worst marker of each filmed trial. A trial is set aside where a marker is seen in "
        f"less than {format_percent(limits['smallest_share_seen'])} of the frames, wanders by "
        f"more than {format_number(limits['largest_rigid_residual_px'])} px, or is placed with "
        f"a standard deviation above {format_number(limits['largest_sd_px'])} px. "
        f"{capital(material.cite('tracking_quality'))}."
    )
    return Table(
        "tracking_quality",
        "How well each trial was tracked",
        caption,
        ("trial", *TRACKING.values()),
        tuple(rows),
        folded=len(rows) > ALWAYS_SHOWN,
    )


def build_set_aside(material: Material) -> list[Block]:
    """Table of unused trials, with reasons."""
    names = material.angles["set_aside_trial"].values
    if not names.size:
        return [Paragraph("No trial was set aside.")]
    reasons = material.angles["set_aside_reason"].values
    rows = tuple((text(n), text(r)) for n, r in zip(names, reasons, strict=True))
    caption = f"Every one of them, with its reason. {capital(material.cite('angles'))}."
    return [Table("set_aside", "Trials set aside", caption, ("trial", "reason"), rows)]


def build_trial_table(material: Material) -> Table:
    """List every trial that is used."""
    rows, found = [], material.recordings
    for name in found["trial"].values:
        trial = found.sel(trial=name)
        frames, duration, load, flagged = (
            float(trial[f"trial_{part}"]) for part in ("frames", "duration", "load", "flagged")
        )
        rows.append(
            (
                text(name),
                number(f"{frames:.0f}", frames),
                number(format_number(duration), duration),
                number(format_number(load), load),
                number(format_percent(flagged, 1), flagged),
            )
        )
    columns = ("trial", "frames", "length [s]", f"largest load [{material.load_unit}]", "flagged")
    caption = (
        "One row per trial; flagged is the share of its angles that no fit uses. "
        f"{capital(material.cite('angles'))}."
    )
    return Table(
        "trials",
        "Trials that are used",
        caption,
        columns,
        tuple(rows),
        folded=len(rows) > ALWAYS_SHOWN,
    )
