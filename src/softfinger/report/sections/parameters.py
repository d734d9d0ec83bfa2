"""The population's parameters.

Units, intervals, and what else is known of them are given.
"""

import xarray as xr

from softfinger.figures.style import label_parameter_unit
from softfinger.report.blocks import (
    Block,
    Cell,
    Paragraph,
    Section,
    Table,
    keep_blocks,
    number,
    text,
)
from softfinger.report.formatting import (
    capital,
    count_things,
    format_interval,
    format_measure,
    format_number,
    format_percent,
)
from softfinger.report.granted import show_independence, show_prior_sensitivity
from softfinger.report.material import Material
from softfinger.report.pictures.population import picture_histograms, picture_hyperparameters


def build_parameters(material: Material) -> Section:
    """Build the section on the hyperparameters."""
    if material.find("population") is None:
        blocks: list[Block | None] = [Paragraph("The fit was not run.", "warning")]
    else:
        blocks = [
            Paragraph(describe_scales(material)),
            Paragraph(material.note, "note") if material.note else None,
            build_centre_table(material),
            build_spread_table(material),
            build_fitted_effects(material),
            picture_hyperparameters(material),
            *show_independence(material),
            *show_prior_sensitivity(material),
        ]
    blocks += [
        picture_histograms(material, initial=False),
        picture_histograms(material, initial=True),
    ]
    return Section("parameters", "The parameters of the finger", keep_blocks(*blocks))


def describe_scales(material: Material) -> str:
    """State what centre and spread mean.

    Also whether the paper's table can be compared with them.
    """
    words = (
        "Each parameter varies from trial to trial. Its centre is the median over trials, on its "
        "own scale; its spread is the standard deviation over trials of its natural logarithm (0.2 "
        f"is about ± 20 %), and for q_ini, which is normal, in {material.motion_unit}. "
    )
    if "paper" in list_rivals(material.find("population")):
        return words + (
            "The paper's table is beside them. It describes the paper's own finger, by the "
            "two-stage way, so agreement is expected only of that finger."
        )
    return words + (
        "The paper's table is not shown: it describes three joints under a torque in N m, which "
        "this campaign does not have."
    )


def build_centre_table(material: Material) -> Table:
    """Tabulate the centre of every parameter at every joint."""
    summary = material.find("population")
    share = format_percent(material.ci_prob)
    rows = []
    for parameter, joint, here in each_parameter(summary):
        centre, sd = float(here["centre"]), float(here["centre_sd"])
        low, high = here["centre_quantile"].values[[0, -1]]
        row = [
            text(parameter),
            number(str(joint), joint),
            text(label_parameter_unit(parameter, material.load_unit, material.motion_unit)),
            number(format_measure(centre, sd), centre),
            text(format_interval(float(low), float(high))),
        ]
        row += [show_rival(here["rival_centre"], name) for name in list_rivals(summary)]
        rows.append(tuple(row))
    columns = ("parameter", "joint", "unit", "centre, median ± sd", f"{share} interval")
    caption = (
        f"Over n = {count_things(material.angles['trial'].size, 'trial')}: posterior "
        f"median ± posterior standard deviation, {share} equal-tailed interval"
        f"{explain_rivals(summary)}. {capital(material.cite('posterior', 'least_squares'))}."
    )
    return Table(
        "centres",
        "Centre of every parameter",
        caption,
        (*columns, *name_rivals(summary)),
        tuple(rows),
    )


def build_spread_table(material: Material) -> Table:
    """Tabulate the spread of every parameter at every joint."""
    summary = material.find("population")
    share = format_percent(material.ci_prob)
    rows = []
    for parameter, joint, here in each_parameter(summary):
        draws = here.sel(statistic="sigma")
        quantiles, sd = draws["quantile_value"].values, float(draws["sd"])
        row = [
            text(parameter),
            number(str(joint), joint),
            text(material.motion_unit if parameter == "q_ini" else "1 (of ln)"),
            number(format_measure(float(quantiles[2]), sd), float(quantiles[2])),
            text(format_interval(float(quantiles[0]), float(quantiles[-1]))),
        ]
        row += [show_rival(draws["rival_value"], name) for name in list_rivals(summary)]
        rows.append(tuple(row))
    columns = ("parameter", "joint", "unit", "spread σ, median ± sd", f"{share} interval")
    caption = (
        f"Over n = {count_things(material.angles['trial'].size, 'trial')}: posterior "
        f"median ± posterior standard deviation, {share} equal-tailed interval"
        f"{explain_rivals(summary)}. {capital(material.cite('posterior', 'least_squares'))}."
    )
    return Table(
        "spreads",
        "Spread of every parameter between trials",
        caption,
        (*columns, *name_rivals(summary)),
        tuple(rows),
    )


def each_parameter(summary: xr.Dataset) -> list[tuple[str, int, xr.Dataset]]:
    """List parameter, joint and what is known of them."""
    return [
        (str(parameter), int(joint), summary.sel(parameter=parameter, joint=joint))
        for parameter in summary["parameter"].values
        for joint in summary["joint"].values
    ]


RIVALS = {"two_stage": "two-stage", "paper": "the paper"}


def list_rivals(summary: xr.Dataset) -> list[str]:
    """List the estimates beside the posterior."""
    return [str(name) for name in summary["rival"].values] if "rival" in summary.dims else []


def name_rivals(summary: xr.Dataset) -> tuple[str, ...]:
    """Name the columns beside the posterior."""
    return tuple(RIVALS[name] for name in list_rivals(summary))


def explain_rivals(summary: xr.Dataset) -> str:
    """Explain the columns beside the posterior."""
    words = {
        "two_stage": "two-stage: least squares per trial, outliers dropped, then a distribution "
        "fitted to the estimates",
        "paper": "the paper: its printed table",
    }
    return "".join(f"; {words[name]}" for name in list_rivals(summary))


def show_rival(values: xr.DataArray, name: str) -> Cell:
    """Show another estimate on the scale of the table."""
    value = float(values.sel(rival=name))
    return number(format_number(value), value)


def list_fitted_effects(material: Material) -> list[str]:
    """The fitted model's effects, in words."""
    found = material.find("effects")
    names = [] if found is None else found["effect_parameter"].values.astype(str).tolist()
    return list(dict.fromkeys(name.split(".")[0].replace("_", " ") for name in names))


def build_fitted_effects(material: Material) -> Table | None:
    """Table of the fitted effects' parameters."""
    found = material.find("effects")
    if found is None:
        return None
    rows = []
    for name in found["effect_parameter"].values.astype(str):
        here = found.sel(effect_parameter=name)
        effect, _, parameter = name.partition(".")
        mean, sd = float(here["effect_mean"]), float(here["effect_sd"])
        low, high = here["effect_quantile"].values[[0, -1]]
        shown = number(format_measure(mean, sd), mean)
        interval = text(format_interval(float(low), float(high)))
        rows.append((text(effect.replace("_", " ")), text(parameter), shown, interval))
    caption = (
        "Of the model file, the same in every trial: posterior mean ± standard deviation and "
        f"equal-tailed interval; the unit is in the name. {capital(material.cite('posterior'))}."
    )
    columns = ("effect", "parameter", "mean ± sd", f"{format_percent(material.ci_prob)} interval")
    return Table("fitted_effects", "Effects that were fitted", caption, columns, tuple(rows))
