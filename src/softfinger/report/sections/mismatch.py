"""The verdict of the mismatch diagnosis in words, or that it was not run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from softfinger.report.blocks import (
    Block,
    Listing,
    Paragraph,
    Section,
    Table,
    Tile,
    number,
    text,
)
from softfinger.report.formatting import (
    format_interval,
    format_measure,
    format_number,
    format_percent,
    join_words,
)
from softfinger.report.material import Material

DECISIONS = {
    "adequate": "Nothing is missing that these recordings could show.",
    "named": "One set of left-out physics explains what the base model misses.",
    "ambiguous": "Physics is missing, but these recordings cannot tell some candidates apart.",
    "unlisted": "Something is missing, and no listed effect explains it.",
}
NOT_RUN = (
    "The mismatch diagnosis was not run: this report says whether the model departs from the "
    "recordings, but not which physics was left out."
)


def build_mismatch(material: Material) -> Section:
    """Build the section on left-out physics from the verdict, if there is one."""
    title = "What physics was left out?"
    if "verdict" not in material:
        return Section("mismatch", title, (Paragraph(NOT_RUN, "note"),))
    verdict = material.artifacts["verdict"]
    blocks: list[Block] = [Paragraph(DECISIONS[verdict["decision"]])]
    blocks += [Paragraph(str(effect["statement"])) for effect in verdict["effects"]]
    blocks += build_effect_tables(verdict)
    blocks += describe_limits(verdict)
    return Section("mismatch", title, tuple(blocks))


def build_effect_tables(verdict: Mapping[str, Any]) -> list[Block]:
    """Tabulate the effects with their parameters, and the fit before and after."""
    rows = []
    for effect in verdict["effects"]:
        for name, value in effect["parameters"].items():
            rows.append(
                (
                    text(effect["id"]),
                    text(join_words([str(joint) for joint in effect["joints"]]) or "all"),
                    number(format_percent(effect["probability"]), effect["probability"]),
                    text(name),
                    number(format_measure(value["mean"], value["sd"]), value["mean"]),
                    text(format_interval(value["q05"], value["q95"])),
                )
            )
    columns = ("effect", "joints", "probability", "parameter", "mean ± sd", "90 % interval")
    caption = "Probability that an effect is needed, and its parameters. From the verdict."
    found = [Table("effects", "What was left out", caption, columns, tuple(rows))] if rows else []
    rms, elpd = verdict["residual_rms_rad"], verdict["elpd"]
    sizes = tuple(
        (text(label), number(f"{1e3 * rms[key]:.2f}", 1e3 * rms[key]))
        for key, label in (
            ("baseline", "base model"),
            ("final", "repaired model"),
            ("noise", "noise, measured without a model"),
        )
    )
    gain = (
        "Leave-one-trial-out score not computed."
        if elpd is None
        else f"Leave-one-trial-out log score, repaired minus base: "
        f"{format_measure(elpd['difference'], elpd['se'])} nats."
    )
    caption = f"Residual rms, joints pooled. {gain} From the verdict."
    return [
        *found,
        Table("before_after", "Fit before and after", caption, ("", "residual rms [mrad]"), sizes),
    ]


def describe_limits(verdict: Mapping[str, Any]) -> list[Block]:
    """Say what these recordings could not tell, and what to record next."""
    items = [
        f"Cannot be told apart by these recordings: {join_words(list(names))}."
        for names in verdict["equivalent"]
    ]
    if verdict["not_testable"]:
        names = join_words(list(verdict["not_testable"]))
        items.append(f"Could not show at any plausible strength: {names}.")
    if verdict["next_experiment"]:
        items.append(f"What to record next: {verdict['next_experiment']}")
    for name, shares in verdict.get("explained_spread", {}).items():
        parts = [f"{format_percent(s)} at joint {joint}" for joint, s in shares.items()]
        items.append(f"Spread of {name} between trials that was physics: {join_words(parts)}.")
    return [Listing(tuple(items))] if items else []


def judge_mismatch(material: Material) -> Tile:
    """Sum the diagnosis up for the head of the page."""
    question = "Left-out physics"
    if "verdict" not in material:
        return Tile(question, "not diagnosed", None, "The diagnosis was not run.", "mismatch")
    verdict = material.artifacts["verdict"]
    names = [f"{e['id']} ({format_number(e['probability'], 2)})" for e in verdict["effects"]]
    detail = join_words(names) or DECISIONS[verdict["decision"]]
    adequate = verdict["decision"] == "adequate"
    return Tile(question, verdict["decision"], adequate, detail, "mismatch")
