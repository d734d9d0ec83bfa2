"""The report's HTML page from one campaign's artifacts."""

import base64
import hashlib
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import jinja2
from markupsafe import Markup, escape

from softfinger.report.blocks import Section, Tile
from softfinger.report.material import Artifact, Material
from softfinger.report.overview.causes import build_causes
from softfinger.report.overview.following import build_next
from softfinger.report.overview.measurement import build_measurement
from softfinger.report.overview.motion import build_motion
from softfinger.report.overview.spread import build_spread
from softfinger.report.overview.verdict import build_verdict
from softfinger.report.sections.catalogue import build_catalogue
from softfinger.report.sections.data import build_data
from softfinger.report.sections.explained import build_explained
from softfinger.report.sections.measured import build_measured
from softfinger.report.sections.mismatch import build_mismatch
from softfinger.report.sections.model import build_model_section
from softfinger.report.sections.origin import build_origin
from softfinger.report.sections.outlook import build_outlook
from softfinger.report.sections.parameters import build_parameters
from softfinger.report.sections.quality import (
    build_calibration,
    build_computation,
    build_predictive,
)
from softfinger.report.sections.remains import build_remains
from softfinger.report.sections.sensitivity import build_sensitivity
from softfinger.report.sections.tiles import judge_tiles

HERE = Path(__file__).parent
Build = Callable[[Material], Section]


class PagePlan(NamedTuple):
    """What a page is, what it answers, and its two layers."""

    kind: str
    ask: str
    first: tuple[Build, ...]
    referee: tuple[Build, ...]


REPORT = PagePlan(
    "Soft finger report",
    "How do the joints move and vary from trial to trial, what causes it, and what is missing?",
    (build_verdict, build_motion, build_spread, build_causes, build_measurement, build_next),
    (
        build_data,
        build_measured,
        build_model_section,
        build_computation,
        build_calibration,
        build_predictive,
        build_parameters,
        build_sensitivity,
        build_mismatch,
        build_remains,
        build_explained,
        build_catalogue,
        build_outlook,
        build_origin,
    ),
)
"""Of a whole run: for the head of a lab, and folded for a referee."""
DIAGNOSIS = PagePlan(
    "Diagnosis",
    "Which physics does the model leave out, what remains, and what do the recordings suffer from?",
    (build_verdict, build_motion, build_remains, build_measurement, build_explained, build_next),
    (build_data, build_measured, build_mismatch, build_catalogue, build_origin),
)
"""Of a diagnosis without a fit."""


def choose_plan(material: Material) -> PagePlan:
    """Choose the page by what was run."""
    return REPORT if material.is_fitted else DIAGNOSIS


def write_report(
    artifacts: Mapping[str, Artifact],
    config: Mapping[str, Any],
    path: Path | str,
    commit: str | None = None,
) -> None:
    """Write one campaign's report as self-contained HTML.

    It needs no other file and no network. Without a fit it is a diagnosis's page.
    A failed check turns its verdict red; the report is written all the same.

    Parameters
    ----------
    artifacts
        By name: `angles` (needed); `markers` (one batch), `picture`, `tracking_quality`,
        `least_squares`, `posterior`, `bands`,
        `densities`, `sobol`, `truth`, and `verdict` (the mapping of verdict.json). The page
        states what is missing.
    config
        The whole configuration; its block `report` contains the limits of the checks.
    path
        The file to write.
    commit
        Commit of the code, for the provenance block.

    Raises
    ------
    Fault
        If `angles` is missing.
    ListedFault
        If the block `report` of the configuration has unknown keys or wrong values.
    """
    material = Material(artifacts, config, commit)
    Path(path).write_text(render_report(material), encoding="utf-8")


def render_report(material: Material) -> str:
    """Render the report's page."""
    plan = choose_plan(material)
    return render_page(
        title=material.campaign,
        kind=plan.kind,
        ask=plan.ask,
        source=material.source,
        tiles=judge_tiles(material),
        sections=[build(material) for build in plan.first],
        folded=[build(material) for build in plan.referee],
        load_unit=material.load_unit,
    )


def render_page(
    *,
    title: str,
    kind: str,
    ask: str,
    source: str,
    tiles: Sequence[Tile],
    sections: Sequence[Section],
    folded: Sequence[Section] = (),
    load_unit: str = "N m",
) -> str:
    """Render a page; all foreign words are escaped.

    Parameters
    ----------
    kind, ask
        What sort of page it is, and the question that it answers.
    source
        `synthetic` or `measured`.
    folded
        Sections of the second layer.
    """
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["symbols"] = set_symbols
    script = (HERE / "report.js").read_text(encoding="utf-8")
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return environment.get_template("report.html.j2").render(
        title=title,
        kind=kind,
        ask=ask,
        source=source,
        load_unit=load_unit,
        tiles=tiles,
        sections=sections,
        folded=folded,
        style=Markup((HERE / "report.css").read_text(encoding="utf-8")),
        script=Markup(script),
        script_hash=digest,
    )


SYMBOL = re.compile(r"\b(log_)?([kcq])_(v|p|ini)\b")


def set_symbols(words: str) -> Markup:
    """Escape words and set the model's symbols.

    Indices are low, logarithms are written ln.

    >>> set_symbols("k_v < log_c_p")
    Markup('<i>k</i><sub>v</sub> &lt; ln <i>c</i><sub>p</sub>')
    """
    return Markup(SYMBOL.sub(_set_symbol, str(escape(words))))


def _set_symbol(found: re.Match[str]) -> str:
    logarithm, letter, index = found.groups()
    return f"{'ln ' if logarithm else ''}<i>{letter}</i><sub>{index}</sub>"
