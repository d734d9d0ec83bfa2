"""Every effect of the catalogue, and what could have shown."""

import xarray as xr

from softfinger.report.blocks import Paragraph, Section, Table, keep_blocks, number, text
from softfinger.report.formatting import format_number, format_percent
from softfinger.report.material import Material
from softfinger.report.pictures.mismatch import picture_masking
from softfinger.report.pictures.repair import picture_ranking
from softfinger.report.verdict import NOT_RUN, spell


def build_catalogue(material: Material) -> Section:
    """Section on every effect that was considered."""
    title = "Every effect of the catalogue"
    if "ranking" not in material:
        return Section("catalogue", title, (Paragraph(NOT_RUN, "note"),))
    table = build_catalogue_table(material.get("ranking"), material.find("evidence"))
    blocks = keep_blocks(picture_ranking(material), table, picture_masking(material))
    return Section("catalogue", title, blocks)


def build_catalogue_table(ranking: xr.Dataset, evidence: xr.Dataset) -> Table:
    """Table of every effect that was tried.

    It marks those that this campaign cannot show.
    """
    rows = []
    for name in ranking["effect"].values:
        gain, needed = (float(ranking[v].sel(effect=name)) for v in ("best_gain", "inclusion"))
        shown = (number(format_number(gain), gain), number(format_percent(needed), needed))
        rows.append((name, "effect", *shown, text("fitted")))
    nothing = (text("–"), text("–"))
    little = (*nothing, text("first estimate: too little gain"))
    rows += [(name, "unfitted_effect", *little) for name in evidence["unfitted_effect"].values]
    for name in ranking["refused_effect"].values:
        reason = str(ranking["refused_reason"].sel(refused_effect=name).item())
        rows.append((name, "refused_effect", *nothing, text(f"not tried: {reason}")))
    told = tuple(
        (text(spell(name)), text(_find_sentence(evidence, kind, name)), *rest)
        for name, kind, *rest in rows
    )
    columns = ("effect", "what happens", "gain alone [nats]", "needed", "tried")
    caption = (
        "Gain: log evidence of its best form alone over the base model; 2.3 nats are odds of ten "
        "to one. Needed: probability that it belongs to the model, beside all others. What "
        "another effect explains better is not needed, whatever its own gain. Rule diagnose, "
        "artifact ranking."
    )
    return Table("catalogue", "Every effect that was considered", caption, columns, told, True)


def _find_sentence(evidence: xr.Dataset, kind: str, name: str) -> str:
    return str(evidence[kind.replace("effect", "sentence")].sel({kind: name}).item())
