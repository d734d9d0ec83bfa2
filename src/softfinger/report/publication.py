"""Figures and tables for a paper.

Vector files by name, and a LaTeX document with them.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from softfinger.faults import Fault
from softfinger.figures.data import write_data
from softfinger.figures.style import label_parameter_unit, save_figure
from softfinger.report.blocks import Picture
from softfinger.report.formatting import format_measure, format_number, format_percent
from softfinger.report.material import Artifact, Material
from softfinger.report.pictures import fit, mismatch, population, recordings, repair, spread
from softfinger.report.pictures.assumptions import picture_assumptions
from softfinger.report.pictures.free_form import picture_free_form
from softfinger.report.pictures.measurement import picture_laws, picture_measurement
from softfinger.report.sections.parameters import each_parameter, explain_rivals, list_rivals

PICTURES: dict[str, Callable[[Material], Picture | None]] = {
    "finger": recordings.picture_finger,
    "joint_model": recordings.picture_joint_model,
    "recordings": recordings.picture_recordings,
    "tracking": recordings.picture_tracking,
    "histograms": partial(population.picture_histograms, initial=False),
    "initial_angles": partial(population.picture_histograms, initial=True),
    "densities": spread.picture_densities,
    "bands": partial(fit.picture_bands, early=False),
    "bands_early": partial(fit.picture_bands, early=True),
    "sobol": spread.picture_sobol,
    "shapley": spread.picture_shapley,
    "hyperparameters": population.picture_hyperparameters,
    "residuals": fit.picture_residuals,
    "repair": repair.picture_repair,
    "evidence": repair.picture_evidence,
    "ranking": repair.picture_ranking,
    "location": mismatch.picture_location,
    "masking": mismatch.picture_masking,
    "free_form": picture_free_form,
    "laws": picture_laws,
    "measurement": picture_measurement,
    "prior_predictive": fit.picture_prior,
    "sampling": fit.picture_sampling,
    "assumptions": picture_assumptions,
}
"""Every figure by name, in the order of the paper, then ours."""

TABLE = "parameters"
"""Name of the paper's table."""

TEX = {
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "&": r"\&",
    "%": r"\%",
    "$": r"\$",
    "#": r"\#",
    "_": r"\_",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "±": r"$\pm$",
    "−": "$-$",
    "–": "--",
    "×": r"$\times$",
    "μ": r"$\mu$",
    "σ": r"$\sigma$",
    "τ": r"$\tau$",
    "∞": r"$\infty$",
} | {mark: f"$^{{{place}}}$" for place, mark in enumerate("⁰¹²³⁴⁵⁶⁷⁸⁹")}
TEX["⁻"] = "$^{-}$"


def build_picture(name: str, artifacts: Mapping[str, Artifact]) -> Picture:
    """Build one figure by name.

    Raises
    ------
    Fault
        If there is no such figure, or an artifact that it shows is missing.
    """
    if name not in PICTURES:
        raise Fault(f"there is no figure '{name}'; there are: {', '.join(PICTURES)}")
    picture = PICTURES[name](Material(artifacts, {}))
    if picture is None:
        raise Fault(
            f"figure '{name}' has nothing to show: its artifact is empty, or was not made; then "
            "run its rule first"
        )
    return picture


def write_figure(
    name: str,
    artifacts: Mapping[str, Artifact],
    paths: Sequence[Path | str],
) -> None:
    """Write one figure, its data and its caption.

    The path's suffix decides: .pdf, .png or .svg is the figure, .csv its data (``COLUMNS`` of
    `figures.data`), .txt its caption. Each path is written once.

    Raises
    ------
    Fault
        As `build_picture`.
    """
    picture = build_picture(name, artifacts)
    for path in map(Path, paths):
        if path.suffix == ".csv":
            path.write_text(write_data(picture.figure), encoding="utf-8")
        elif path.suffix == ".txt":
            path.write_text(f"{picture.title}. {picture.caption}\n", encoding="utf-8")
        else:
            save_figure(picture.figure, path)


def write_parameter_table(artifacts: Mapping[str, Artifact], path: Path | str) -> None:
    """Write the paper's table as LaTeX.

    It contains μ and σ of every parameter at every joint.

    Raises
    ------
    Fault
        If the posterior is missing.
    """
    material = Material(artifacts, {})
    Path(path).write_text(render_parameter_table(material), encoding="utf-8")


def render_parameter_table(material: Material) -> str:
    """Render the paper's table."""
    summary = material.find("population")
    if summary is None:
        raise Fault("the table of parameters needs the posterior; run the rule fit first")
    rivals = list_rivals(summary)
    rows = []
    for parameter, joint, here in each_parameter(summary):
        cells = [
            parameter,
            str(joint),
            label_parameter_unit(parameter, material.load_unit, material.motion_unit),
        ]
        for statistic in ("mu", "sigma"):
            one = here.sel(statistic=statistic)
            cells.append(format_measure(float(one["quantile_value"][2]), float(one["sd"])))
            cells += [
                format_number(float(one["rival_value"].sel(rival=name)), 4) for name in rivals
            ]
        rows.append(" & ".join(escape_tex(cell) for cell in cells) + r" \\")
    heads = ["parameter", "joint", "unit"]
    for symbol in ("μ", "σ"):
        heads += [symbol, *(f"{symbol}, {name.replace('_', '-')}" for name in rivals)]
    caption = (
        f"Centre μ and spread σ over n = {material.angles['trial'].size} trials ({material.source} "
        "data), of the natural logarithm but for q_ini: posterior median ± posterior standard "
        f"deviation{explain_rivals(summary)}."
    )
    lines = [
        r"\begin{table*}",
        rf"\caption{{{escape_tex(caption)}}}",
        r"\small",
        rf"\begin{{tabular}}{{ll l{'r' * (len(heads) - 3)}}}",
        r"\hline",
        " & ".join(escape_tex(head) for head in heads) + r" \\",
        r"\hline",
        *rows,
        r"\hline",
        r"\end{tabular}",
        r"\end{table*}",
    ]
    return "\n".join(lines) + "\n"


def write_document(
    names: Sequence[str],
    artifacts: Mapping[str, Artifact],
    path: Path | str,
) -> None:
    """Write a LaTeX document with figures and table.

    They lie beside it.

    Raises
    ------
    Fault
        As `build_picture`.
    """
    material = Material(artifacts, {})
    parts = [build_picture(name, artifacts) for name in names]
    body = [render_float(part) for part in parts]
    title = escape_tex(f"{material.campaign}: figures ({material.source} data)")
    interval = format_percent(material.ci_prob)
    lines = [
        r"\documentclass[twocolumn]{article}",
        r"\usepackage[T1]{fontenc}",
        r"\usepackage[utf8]{inputenc}",
        r"\usepackage{graphicx}",
        rf"\title{{{title}}}",
        r"\date{}",
        r"\begin{document}",
        r"\maketitle",
        rf"Intervals are equal-tailed, {escape_tex(interval)} unless said otherwise.",
        *body,
        rf"\input{{{TABLE}.tex}}",
        r"\end{document}",
    ]
    Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8")


def render_float(picture: Picture) -> str:
    """Render one figure's environment, over one column or two."""
    wide = picture.figure.get_size_inches()[0] > 5
    kind, width = ("figure*", "textwidth") if wide else ("figure", "columnwidth")
    return "\n".join(
        [
            rf"\begin{{{kind}}}",
            r"\centering",
            rf"\includegraphics[width=\{width}]{{{picture.name}.pdf}}",
            rf"\caption{{\textbf{{{escape_tex(picture.title)}.}} {escape_tex(picture.caption)}}}",
            rf"\end{{{kind}}}",
        ]
    )


def escape_tex(words: str) -> str:
    r"""Escape words for LaTeX.

    The model's symbols are set as symbols; foreign letters stay.

    >>> print(escape_tex("k_v is 5 ± 1 % of c_p_x"))
    $k_{v}$ is 5 $\pm$ 1 \% of c\_p\_x
    """
    parts = re.split(r"\b([kcq]_(?:v|p|ini))\b", words)
    plain = ["".join(TEX.get(letter, letter) for letter in part) for part in parts]
    plain[1::2] = [f"${symbol[0]}_{{{symbol[2:]}}}$" for symbol in parts[1::2]]
    return "".join(plain)
