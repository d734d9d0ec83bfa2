"""Which parameter's spread causes the spread of the motion."""

import xarray as xr

from softfinger.report.blocks import Block, Paragraph, Section, Table, keep_blocks, number, text
from softfinger.report.formatting import (
    capital,
    format_number,
    format_percent,
    join_words,
)
from softfinger.report.granted import show_correlation
from softfinger.report.material import Material
from softfinger.report.pictures.spread import picture_densities, picture_shapley

ALONE = (
    "One trial cannot show how much trials differ: all shares of the spread that follow are those "
    "of the prior."
)


def build_sensitivity(material: Material) -> Section:
    """Section on the motion's spread and its causes."""
    if "sobol" not in material:
        blocks: tuple = (Paragraph("The sensitivity was not computed.", "note"),)
    else:
        sobol = material.get("sobol").attrs
        words = f"{capital(sobol['definition'])}. Truncation of c_p: {sobol['truncation']}."
        blocks = (
            Paragraph(words),
            Paragraph(ALONE, "warning") if material.is_alone else None,
            build_sobol_table(material),
            build_design_table(material),
        )
    more = (*build_correlations(material), picture_densities(material))
    return Section("sensitivity", "What causes the spread?", keep_blocks(*blocks, *more))


def choose_shown_times(sobol: xr.Dataset) -> list[float]:
    """Moments to tabulate: early, middle and end.

    Only where the artifact has them.
    """
    end = float(sobol["time"].max())
    return sorted({float(t) for t in (0.1, 1.0, end / 3, end) if t <= end})


def build_sobol_table(material: Material) -> Table:
    """Table of first-order indices with bounds.

    A few moments are shown.
    """
    sobol = material.get("sobol").sel(estimate="posterior")
    rows = []
    for moment in choose_shown_times(sobol):
        now = sobol.sel(time=moment, method="nearest")
        for joint in now["joint"].values:
            for parameter in now["parameter"].values:
                here = now.sel(joint=joint, parameter=parameter)
                first, total = float(here["first_order"]), float(here["total"])
                low, high = here["first_order_quantile"].values[[0, -1]]
                rows.append(
                    (
                        number(format_number(float(now["time"])), float(now["time"])),
                        number(str(joint), joint),
                        text(parameter),
                        number(format_percent(first, 1), first),
                        text(f"{format_percent(low, 1)} to {format_percent(high, 1)}"),
                        number(format_percent(total, 1), total),
                    )
                )
    columns = ("time [s]", "joint", "parameter", "first order", "90 % interval", "total")
    caption = (
        "Share of the variance between trials that knowing a parameter explains (first order), and "
        "that is left when all others are known (total): means over the posterior, 90 % "
        f"equal-tailed interval over its draws. {capital(material.cite('sobol'))}."
    )
    return Table(
        "sobol", "Shares of the variance", caption, columns, tuple(rows), folded=len(rows) > 16
    )


def build_correlations(material: Material) -> list[Block | None]:
    """Show which parameters vary together.

    From trial to trial, and what that does.
    """
    if "shapley" not in material:
        return []
    shapley = material.get("shapley")
    pairs = material.find("pairs")
    rows, clear = [], []
    for place in range(pairs.sizes["pair"]):
        here = pairs.isel(pair=place)
        joint, one, other = (here[name].item() for name in ("pair_joint", "one", "other"))
        shown, interval = show_correlation(here["correlation"].values)
        rows.append((number(str(joint), joint), text(f"{one}, {other}"), shown, interval))
        if here["clear"]:
            clear.append(f"{one} with {other} at joint {joint}")
    verb = "are" if len(clear) > 1 else "is"
    found = f"{join_words(clear)} {verb}" if clear else "no pair is"
    words = (
        f"Are the parameters correlated? At 90 %, {found} correlated between trials: {len(clear)} "
        f"of {len(rows)} pairs, where chance alone would give about "
        f"{format_number(float(pairs['by_chance']), 2)}. {capital(shapley.attrs['definition'])}."
    )
    caption = (
        "Correlation between trials of the logs of k_v, c_v, c_p and of q_ini: median and 90 % "
        f"equal-tailed interval. {capital(material.cite('shapley'))}."
    )
    columns = ("joint", "pair", "correlation", "90 % interval")
    title = "Correlated parameters"
    return [
        Paragraph(words),
        Table("correlations", title, caption, columns, tuple(rows), folded=len(rows) > 6),
        picture_shapley(material),
    ]


def build_design_table(material: Material) -> Table | None:
    """Table of the spread's decrease by design.

    In each row the spread of one parameter is halved.
    """
    sobol = material.get("sobol")
    if "spread_shrinkage" not in sobol:
        return None
    shrinkage = sobol["spread_shrinkage"].sel(estimate="posterior", change="halved")
    bounds = sobol["spread_shrinkage_quantile"].sel(change="halved")
    rows = []
    times = sobol["running_time"].values
    recorded = times[times <= float(material.recordings["duration"])]
    for run in recorded if recorded.size else times[:1]:
        for joint in sobol["joint"].values:
            for parameter in sobol["parameter"].values:
                place = {"running_time": run, "joint": joint, "parameter": parameter}
                value = float(shrinkage.sel(place))
                low, high = bounds.sel(place).values[[0, -1]]
                rows.append(
                    (
                        number(format_number(float(run)), run),
                        number(str(joint), joint),
                        text(parameter),
                        number(format_percent(value, 1), value),
                        text(f"{format_percent(low, 1)} to {format_percent(high, 1)}"),
                    )
                )
    columns = ("running time [s]", "joint", "parameter", "spread shrinks by", "90 % interval")
    caption = (
        "By how much the angle's spread over a running time would shrink if one "
        "parameter varied half as much from trial to trial. "
        f"{capital(material.cite('sobol'))}."
    )
    return Table(
        "design",
        "For design: whose spread to reduce",
        caption,
        columns,
        tuple(rows),
        folded=len(rows) > 16,
    )
