"""The verdict of the diagnosis in words.

Without one it states that none was run.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from softfinger.figures.style import get_motion_unit, label_thousandth
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
    format_shares,
    join_words,
)
from softfinger.report.material import Material
from softfinger.report.pictures.measurement import picture_laws
from softfinger.report.pictures.mismatch import (
    picture_location,
    picture_masking,
    picture_ranking,
)
from softfinger.report.sections.unlisted import describe_unlisted

DECISIONS = {
    "adequate": "Nothing is missing that these recordings could show.",
    "named": "One set of left-out physics explains what the base model misses.",
    "ambiguous": "Physics is missing, but these recordings cannot tell some candidates apart.",
    "unlisted": "Something is missing, and no listed effect explains it.",
}
PARTLY = "Something is missing that no listed effect explains; what is named here is a part of it."
IN_A_WORD = {
    "adequate": "none seen",
    "named": "found",
    "ambiguous": "found, ambiguous",
    "unlisted": "found, not explained",
}
NOT_RUN = (
    "The mismatch diagnosis was not run: this report says whether the model departs from the "
    "recordings, but not which physics was left out."
)


def build_mismatch(material: Material) -> Section:
    """Section on left-out physics, if there is a verdict."""
    title = "What physics was left out?"
    if "verdict" not in material:
        return Section("mismatch", title, (Paragraph(NOT_RUN, "note"),))
    verdict = material.artifacts["verdict"]
    blocks: list[Block] = [Paragraph(sentence) for sentence in state_verdict(verdict)]
    blocks += describe_unlisted(material)
    evidence = picture_ranking(material)
    blocks += [] if evidence is None else [evidence]
    blocks += build_effect_tables(verdict, label_thousandth(material.motion_unit))
    law = picture_laws(material)
    blocks += [] if law is None else [law]
    if "ranking" in material:
        evidence = material.find("evidence")
        blocks.append(build_catalogue_table(material.get("ranking"), evidence))
    if "repair" in material and verdict["decision"] != "adequate":
        blocks += build_repair_tables(material.get("repair"))
    seen = [picture_location(material), picture_masking(material)]
    blocks += [picture for picture in seen if picture is not None]
    blocks += say_limits(verdict)
    return Section("mismatch", title, tuple(blocks))


def state_verdict(verdict: Mapping[str, Any]) -> list[str]:
    """Say in sentences what the diagnosis found."""
    partly = verdict["decision"] == "unlisted" and verdict["effects"]
    decision = PARTLY if partly else DECISIONS[verdict["decision"]]
    return [decision, *(str(effect["statement"]) for effect in verdict["effects"])]


def build_catalogue_table(ranking: xr.Dataset, evidence: xr.Dataset) -> Table:
    """Table of every effect that was tried.

    It marks those that this campaign cannot show.
    """
    sentences = evidence["sentence"].values.tolist() + evidence["refused_sentence"].values.tolist()
    rows = []
    for name in ranking["effect"].values:
        gain, needed = (float(ranking[v].sel(effect=name)) for v in ("best_gain", "inclusion"))
        cells = (number(format_number(gain), gain), number(format_percent(needed), needed))
        rows.append((name, *cells, text("fitted")))
    for name in ranking["refused_effect"].values:
        reason = str(ranking["refused_reason"].sel(refused_effect=name).item())
        rows.append((name, text("–"), text("–"), text(f"not tried: {reason}")))
    told = tuple(
        (text(spell(name)), text(sentence), *rest)
        for sentence, (name, *rest) in zip(sentences, rows, strict=True)
    )
    columns = ("effect", "what happens", "gain alone [nats]", "needed", "tried")
    caption = (
        "Gain: log evidence of its best form alone over the base model; 2.3 nats are odds of ten "
        "to one. Needed: probability that it belongs to the model, beside all others. What "
        "another effect explains better is not needed, whatever its own gain. Rule diagnose, "
        "artifact ranking."
    )
    return Table("catalogue", "Every effect that was considered", caption, columns, told, True)


def spell(effect: object) -> str:
    """Write an effect's id as words.

    >>> spell("wire_friction")
    'wire friction'
    """
    return str(effect).replace("_", " ")


def build_repair_tables(repair: xr.Dataset) -> list[Block]:
    """Tables of the omission's effect on parameters, predictions."""
    rows = []
    for joint in repair["joint"].values:
        for parameter in repair["parameter"].values:
            here = repair.sel(joint=joint, parameter=parameter)
            before, after = (
                format_measure(float(here["population_mean"].sel(model=model)),
                               float(here["population_mean_sd"].sel(model=model)))
                for model in ("base", "final")
            )  # fmt: skip
            bias, share = float(here["bias"]), float(here["explained_spread"])
            rows.append(
                (text(joint), text(parameter), text(before), text(after),
                 number(format_number(bias, 2), bias), number(format_percent(share), share))
            )  # fmt: skip
    columns = ("joint", "parameter", "base model", "repaired model", "bias", "spread explained")
    caption = (
        "Population means ± sd by the base and the repaired model (logarithms, q_ini in rad); the "
        "bias of a logarithm is about the relative error that the omission caused. Spread "
        "explained: share of the variance between trials that was physics; negative where the "
        "base model hid spread. Rule diagnose, artifact repair."
    )
    title = "What the omission did to the parameters"
    return [
        Table("parameter_bias", title, caption, columns, tuple(rows)),
        *build_prediction_tables(repair),
    ]


def build_prediction_tables(repair: xr.Dataset) -> list[Block]:
    """Tables of predictions of left-out trials and loads.

    They give the coverage of trials, and the prediction of load levels.
    """
    rows = []
    for joint in repair["joint"].values:
        shares = repair["coverage"].sel(joint=joint, ci_prob=0.9)
        bounds = repair["coverage_bound"].sel(joint=joint, ci_prob=0.9)
        for model, label in (("base", "base model"), ("final", "repaired model")):
            share, span = float(shares.sel(model=model)), bounds.sel(model=model).values
            if np.isfinite(share):
                interval = format_shares(span[0], span[1])
                cells = (text(joint), text(label), number(format_percent(share), share))
                rows.append((*cells, text(interval)))
    caption = (
        "Share of the recorded angles of trials that were left out, five times a fifth, inside the "
        "90 % band that the others predict, with its 90 % interval by bootstrap over trials. Rule "
        "diagnose, artifact repair."
    )
    columns = ("joint", "model", "inside", "90 % interval")
    title = "Coverage of left-out trials"
    found: list[Block] = []
    if rows:
        found.append(Table("left_out_trials", title, caption, columns, tuple(rows), folded=True))
    if repair["level"].size:
        found.append(build_level_table(repair))
    return found


def build_level_table(repair: xr.Dataset) -> Table:
    """Table of each load level's prediction from others."""
    rows = []
    for place, level in enumerate(repair["level"].values):
        for joint in repair["joint"].values:
            here = repair.isel(level=place).sel(joint=joint)
            cells = [text(f"{level:.3g} {repair.attrs['load_unit']}"), text(joint)]
            for model in ("base", "final"):
                error = 1e3 * float(here["level_error"].sel(model=model))
                inside = float(here["level_coverage"].sel(model=model))
                cells.append(number(f"{error:.3g}", error))
                cells.append(number(format_percent(inside), inside))
            rows.append(tuple(cells))
    small = label_thousandth(get_motion_unit(repair))
    columns = ("level left out", "joint", f"base: error [{small}]", "base: inside",
               f"repaired: error [{small}]", "repaired: inside")  # fmt: skip
    caption = (
        "Fitted without one load level and predicting it: rms over time of the mean recording "
        "minus the predicted median, and share of angles inside the predicted 90 % band. Rule "
        "diagnose, artifact repair."
    )
    title = "Loads that were not used in the fit"
    return Table("left_out_levels", title, caption, columns, tuple(rows), folded=True)


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


def say_limits(verdict: Mapping[str, Any]) -> list[Block]:
    """State what the recordings could not show.

    What to record next is added.
    """
    items = [
        f"Cannot be told apart by these recordings: {join_words([spell(n) for n in names])}."
        for names in verdict["equivalent"]
    ]
    if verdict["not_testable"]:
        names = join_words([spell(name) for name in verdict["not_testable"]])
        items.append(f"Could not show at any plausible strength: {names}.")
    items += describe_next(verdict)
    return [Listing(tuple(items))] if items else []


def describe_next(verdict: Mapping[str, Any]) -> list[str]:
    """State what to record next, if anything."""
    proposal = verdict.get("next_experiment")
    if not proposal:
        return []
    statement = str(proposal["statement"])
    for name in proposal.get("tells_apart", ()):
        statement = statement.replace(name, spell(name))
    return [f"{statement} Its load logs lie in the folder next_experiment beside this report."]


def say_power(material: Material, verdict: Mapping[str, Any]) -> str:
    """State how many effects could have shown here.

    The effects are those of the catalogue.
    """
    if "ranking" not in material:
        return DECISIONS[verdict["decision"]]
    refused = material.get("ranking")["refused_effect"].values.tolist()
    effects = [*material.get("ranking")["effect"].values.tolist(), *refused]
    blind = set(refused) | set(verdict["not_testable"])
    return f"{len(effects) - len(blind)} of {len(effects)} effects could have been seen"


def judge_mismatch(material: Material) -> Tile:
    """Summary of the diagnosis for the page's head."""
    question = "Left-out physics"
    if "verdict" not in material:
        return Tile(question, "not diagnosed", None, "The diagnosis was not run.", "mismatch")
    verdict = material.artifacts["verdict"]
    names = [
        f"{spell(effect['id'])} (probability {format_percent(effect['probability'])})"
        for effect in verdict["effects"]
    ]
    if names and verdict["decision"] == "unlisted":
        names.append("more that no listed effect explains")
    detail = join_words(names) or say_power(material, verdict)
    adequate = verdict["decision"] == "adequate"
    return Tile(question, IN_A_WORD[verdict["decision"]], adequate, detail, "mismatch")
