"""What listed effects explain, and what was not tried."""

from collections.abc import Mapping
from typing import Any

from softfinger.report.blocks import (
    Block,
    Listing,
    Paragraph,
    Section,
    Table,
    keep_blocks,
    number,
    text,
)
from softfinger.report.formatting import format_number, format_percent, join_words
from softfinger.report.material import Material
from softfinger.report.verdict import NOT_RUN, spell, state_explained, state_power


def build_explained(material: Material) -> Section:
    """Section on what listed effects explain, and what was not tried."""
    title = "What was explained, and what was not tried"
    if "verdict" not in material:
        return Section("explained", title, (Paragraph(NOT_RUN, "note"),))
    verdict = material.artifacts["verdict"]
    power = state_power(material, verdict)
    blocks: list[Block | None] = [Paragraph(sentence) for sentence in state_explained(verdict)]
    blocks += [Paragraph(f"Of the catalogue, {power}.") if power else None]
    blocks += [build_explained_table(verdict), build_limits(verdict)]
    more = (("catalogue", "every effect that was considered"),)
    return Section("explained", title, keep_blocks(*blocks), more)


def build_explained_table(verdict: Mapping[str, Any]) -> Table | None:
    """Table of the best sets of listed effects."""
    rows = tuple(
        (
            text(join_words([spell(name) for name in one["effects"]])),
            number(format_number(one["gain_nats"]), one["gain_nats"]),
            number(format_percent(one["share"]), one["share"]),
            text("no" if one["amplitudes_cover_zero"] else "yes"),
        )
        for one in verdict.get("explained", ())
    )
    if not rows:
        return None
    columns = ("effects", "gain [nats]", "share explained", "clearly off zero")
    caption = (
        "Gain: log evidence over the base model. Share: of the evidence that is missing, about. "
        "Off zero: whether the 90 % interval of a size excludes 0. From the verdict."
    )
    return Table("explained_sets", "What listed effects explain", caption, columns, rows)


def build_limits(verdict: Mapping[str, Any]) -> Listing | None:
    """List what the recordings could not show."""
    items = [
        f"Cannot be told apart by these recordings: {join_words([spell(n) for n in names])}."
        for names in verdict["equivalent"]
    ]
    reasons: dict[str, list[str]] = {}
    for one in verdict.get("not_tried", ()):
        reasons.setdefault(one["reason"].rstrip("."), []).append(one["id"])
    untried = {name for names in reasons.values() for name in names}
    blind = [spell(name) for name in verdict["not_testable"] if name not in untried]
    if blind:
        items.append(f"Could not show at any plausible strength: {join_words(blind)}.")
    items += [
        f"Not tried: {join_words([spell(name) for name in names])}; {reason}."
        for reason, names in reasons.items()
    ]
    return Listing(tuple(items)) if items else None
