"""What was left out, in numbers."""

from collections.abc import Mapping
from typing import Any

from softfinger.report.blocks import (
    Block,
    Paragraph,
    Section,
    Table,
    Tile,
    keep_blocks,
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
from softfinger.report.pictures.measurement import picture_laws
from softfinger.report.sections.repair import build_repair_tables
from softfinger.report.verdict import (
    IN_A_WORD,
    NOT_RUN,
    format_probability,
    spell,
    state_power,
    state_verdict,
)
from softfinger.units import label_thousandth


def build_mismatch(material: Material) -> Section:
    """Section on left-out physics, if there is a verdict."""
    title = "What physics was left out?"
    if "verdict" not in material:
        return Section("mismatch", title, (Paragraph(NOT_RUN, "note"),))
    verdict = material.artifacts["verdict"]
    blocks: list[Block | None] = [Paragraph(state_verdict(material))]
    blocks += [Paragraph(str(effect["statement"])) for effect in verdict["effects"]]
    blocks += build_effect_tables(verdict, label_thousandth(material.motion_unit))
    blocks.append(picture_laws(material))
    if "repair" in material and verdict["decision"] != "adequate":
        blocks += build_repair_tables(material.get("repair"))
    return Section("mismatch", title, keep_blocks(*blocks))


def build_effect_tables(verdict: Mapping[str, Any], small: str) -> list[Block]:
    """Tables of the effects' parameters and the fit.

    The fit is given before and after.
    """
    rows = []
    for effect in verdict["effects"]:
        for name, value in effect["parameters"].items():
            rows.append(
                (
                    text(spell(effect["id"])),
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
        if key != "final" or verdict["effects"]
    )
    gain = (
        ""
        if elpd is None
        else f" Leave-one-trial-out log score, repaired minus base: "
        f"{format_measure(elpd['difference'], elpd['se'])} nats."
    )
    caption = f"Residual rms, joints pooled.{gain} From the verdict."
    columns = ("what", f"residual rms [{small}]")
    title = "Fit before and after" if verdict["effects"] else "Fit and noise"
    return [
        *found,
        *build_form_table(verdict),
        Table("before_after", title, caption, columns, sizes),
    ]


def build_form_table(verdict: Mapping[str, Any]) -> list[Block]:
    """Table of textbook forms' distances from free laws."""
    rows = tuple(
        (text(spell(effect["id"])), text(spell(form)), number(format_number(nats), nats))
        for effect in verdict["effects"]
        for form, nats in ((effect.get("law") or {}).get("forms_nats") or {}).items()
    )
    if not rows:
        return []
    caption = "Log evidence of the textbook form less that of the free law. From the verdict."
    columns = ("effect", "textbook form", "evidence [nats]")
    return [Table("forms", "Textbook forms against the free law", caption, columns, rows)]


def judge_mismatch(material: Material) -> Tile:
    """Summary of the diagnosis for the page's head."""
    question = "Left-out physics"
    if "verdict" not in material:
        return Tile(question, "not diagnosed", None, "The diagnosis was not run.", "mismatch")
    verdict = material.artifacts["verdict"]
    names = [
        f"{spell(effect['id'])} (probability {format_probability(effect['probability'])})"
        for effect in verdict["effects"]
    ]
    if names and verdict["decision"] == "unlisted":
        names.append("more that no listed effect explains")
    detail = "; ".join(filter(None, (join_words(names), state_power(material, verdict))))
    adequate = verdict["decision"] == "adequate"
    return Tile(question, IN_A_WORD[verdict["decision"]], adequate, detail, "mismatch")
