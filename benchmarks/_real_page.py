"""The page of real recordings: tables of what was known or added, and answered."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from softfinger.report.blocks import Cell, Paragraph, Section, Table, Tile, number, text
from softfinger.report.formatting import fix, format_number, format_percent
from softfinger.report.page import render_page

HOW = (
    "Every recording on this page is measured, by others. An effect is added by what it does to a "
    "body of three elements that is fitted to each trial, simulated by the proof's own equations "
    "of motion: recorded angle + (with the effect − without). A delay shifts the time stamps. "
    "Noise, faults and unknown physics stay as they are."
)
WEIGHED = (
    "The evidence of an added effect is what the model and measurement of the plain recordings' "
    "diagnosis lose when they are fitted to those with the effect: the mean of adding it and of "
    "taking it off. From 15 nats on a case counts; it is right where the verdict gains the "
    "effect's id: among its effects, in a set that it cannot tell apart, or first among what is "
    "explained. Where it does not, the lead is what the plain model has, the effect taken off "
    "again, over the model that was answered: below 15 nats no one could name the effect."
)
GOALS = {
    "real_accepted_share": ("Answers that a fair expert accepts", 0.85),
    "real_added_named_share": ("Added effects that the verdict gains", 0.9),
    "real_added_named_share_of_nameable": ("The same, of those that lead any other answer", 0.9),
}


def write_page(
    plain: Sequence[Mapping], added: Sequence[Mapping], figures: Mapping[str, float], out: Path
) -> None:
    """Write OUT/report.html."""
    tiles = [
        Tile(
            meaning,
            format_percent(figures[key]) if key in figures else "not measured",
            bool(figures[key] >= goal) if key in figures else None,
            f"of {figures[of]}; the goal is ≥ {format_percent(goal)}",
            "plain" if of == "real_campaigns" else "added",
        )
        for (key, (meaning, goal)), of in zip(
            GOALS.items(), ("real_campaigns", *2 * ["real_added_cases"]), strict=True
        )
    ]
    wrong = figures["real_confident_wrong"]
    tiles.append(Tile("Confident and wrong", str(wrong), wrong == 0, "the goal is 0", "plain"))
    hidden = sum(one["right"] is None for one in added)
    unseen = f"{hidden} further additions reach no 15 nats at any believable size."
    sections = [
        Section(
            "plain",
            "Real recordings as they are",
            (Paragraph(HOW), _tabulate("plain", "Every campaign (measured)", plain)),
        ),
        Section(
            "added",
            "Effects added to real recordings",
            (
                Paragraph(WEIGHED),
                Paragraph(unseen, "note"),
                _tabulate(
                    "added",
                    "Every added effect (measured, effect added)",
                    [one for one in added if one["right"] is not None],
                ),
            ),
        ),
    ]
    page = render_page(
        title=f"Real recordings: {len(plain)} campaigns, {len(added)} added effects",
        kind="Soft finger proof",
        ask="What is answered where an expert knows, or an effect was added?",
        source="measured",
        tiles=tiles,
        sections=sections,
    )
    (out / "report.html").write_text(page, encoding="utf-8")


COLUMNS = {
    "campaign": "campaign", "known": "accepted or added", "nats": "evidence [nats]",
    "answer": "answered", "right": "right", "lead": "lead [nats]", "left": "residual / noise",
    "seconds": "wall [s]", "cpu_seconds": "CPU [s]", "reason": "reason",
}  # fmt: skip


def _tabulate(name: str, title: str, found: Sequence[Mapping]) -> Table:
    rows = [_describe(one) for one in found]
    used = {k: head for k, head in COLUMNS.items() if any(row.get(k) is not None for row in rows)}
    return Table(
        name,
        title,
        "Answers of `softfinger diagnose`, one process each; `python -m benchmarks._real`.",
        tuple(used.values()),
        tuple(tuple(_cell(row.get(key)) for key in used) for row in rows),
    )


def _describe(one: Mapping) -> dict[str, Any]:
    remaining = (one["verdict"] or {}).get("remaining") or {}
    known = one["added"] or " or ".join(one["accept"])
    keys = ("campaign", "nats", "answer", "right", "lead", "seconds", "cpu_seconds", "reason")
    row = {key: one.get(key) for key in keys}
    return row | {"known": known, "left": remaining.get("rms_over_noise")}


def _cell(value: object) -> Cell:
    if isinstance(value, bool):
        return text("yes" if value else "no")
    if isinstance(value, int | float):
        return number(fix(value, 0) if abs(value) >= 100 else format_number(value), value)
    return text("" if value is None else value)
