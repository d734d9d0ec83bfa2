"""What the fit took for granted.

That is one population, its parameters' correlations, and its priors.
"""

import numpy as np
import xarray as xr

from softfinger.report.blocks import Block, Cell, Paragraph, Table, number, text
from softfinger.report.formatting import capital, format_number
from softfinger.report.material import Material

MOST_PAIRS = 20


def show_independence(material: Material) -> tuple[Block, ...]:
    """Show whether a trial's parameters are independent.

    Where correlations are fitted they are shown, else how well the data agree with none.
    """
    if material.find("correlations") is not None:
        return show_correlations(material, material.find("correlations"))
    found = material.find("independence")
    if found is None:
        return ()
    pairs, smallest = found.sizes["pair"], float(found["smallest_p"])
    shown = found.isel(pair=slice(MOST_PAIRS))
    rows = tuple(
        (
            text(name_own(str(one))),
            text(name_own(str(other))),
            number(format_number(product), product),
            number(format_number(p), p),
        )
        for one, other, product, p in zip(
            *(shown[name].values for name in ("one", "other", "mean_product", "p_value")),
            strict=True,
        )
    )
    answer = "contradict this" if found["doubted"] else "do not contradict this"
    sentence = (
        "The model takes a trial's parameters as independent of one another, as the paper does. "
        f"The recordings {answer}: the smallest p of the {pairs} pairs, corrected for their "
        f"number, is {format_number(smallest)}."
    )
    caption = (
        f"The {len(rows)} of {pairs} pairs with the smallest p. Mean product: of both "
        "parameters less their centre over their spread, over trials and draws; about the "
        "correlation where trials are well known. p: two-sided, of this one pair. "
        f"{capital(material.cite('posterior'))}."
    )
    columns = ("parameter", "with", "mean product", "p")
    title = "Whether parameters are correlated"
    return (
        Paragraph(sentence, "note" if found["doubted"] else "plain"),
        Table("independence", title, caption, columns, rows, folded=True),
    )


def show_correlations(material: Material, found: xr.Dataset) -> tuple[Block, ...]:
    """Show fitted correlations of a trial's parameters.

    The surest come first.
    """
    shown, pairs, prob = found.isel(pair=slice(MOST_PAIRS)), found.sizes["pair"], material.ci_prob
    rows = tuple(
        (text(name_own(str(one))), text(name_own(str(other))), *show_correlation(value))
        for one, other, value in zip(
            *(shown[name].values for name in ("one", "other", "correlation")), strict=True
        )
    )
    sentence = (
        f"The model lets {pairs} pairs of a trial's parameters be correlated. At "
        f"{100 * prob:g} %, {int(found['clear'].sum())} are shown; chance alone would give about "
        f"{format_number(float(found['by_chance']), 2)}."
    )
    caption = (
        f"The {len(rows)} of {pairs} pairs whose correlation over trials is largest against "
        f"its uncertainty: median and {100 * prob:g} % equal-tailed interval. "
        f"{capital(material.cite('posterior'))}."
    )
    columns = ("parameter", "with", "correlation", f"{100 * prob:g} % interval")
    title = "Correlations in the fitted population"
    return (
        Paragraph(sentence),
        Table("parameter_correlation", title, caption, columns, rows, folded=True),
    )


def show_correlation(quantiles: np.ndarray) -> tuple[Cell, Cell]:
    """Show median and interval of a correlation."""
    low, middle, high = (float(value) for value in quantiles)
    interval = text(f"{format_number(low, 2)} to {format_number(high, 2)}")
    return number(format_number(middle, 2), middle), interval


def show_loo_pit(material: Material) -> tuple[Block, ...]:
    """Show whether trials lie where others predict them.

    A few moments of every joint are shown.
    """
    found = material.find("loo_pit")
    if found is None:
        return ()
    answer = "are not" if found["doubted"] else "are"
    sentence = (
        "Predicted by the other trials alone, the shares of predictions that lie below the "
        f"recorded angles {answer} spread as evenly as they should: the smallest p of "
        f"{found['p_value'].size} tests, corrected for their number, is "
        f"{format_number(float(found['smallest_p']))}."
    )
    rows = []
    for joint, moment in np.ndindex(*found["p_value"].shape):
        here = found.isel(joint=joint, moment=moment)
        values = [float(here[name]) for name in ("time", "mean_share", "p_value")]
        label = here["joint"].item()
        cells = (number(format_number(value), value) for value in values)
        rows.append((number(str(label), label), *cells))
    caption = (
        f"Over n = {material.angles['trial'].size} trials, each left out of what predicts it, its "
        "own parameters drawn from the population: time (median over trials), mean share of "
        "predictions below the recording (0.5 is even), p of uniformity (Kolmogorov and Smirnov). "
        f"{capital(material.cite('posterior'))}."
    )
    columns = ("joint", "time [s]", "mean share below", "p")
    title = "Where trials lie in what the others predict"
    return (
        Paragraph(sentence, "note" if found["doubted"] else "plain"),
        Table("loo_pit", title, caption, columns, tuple(rows), folded=True),
    )


def _show_sensitivity(*found: xr.DataArray) -> tuple[Cell, ...]:
    """Cells of the sensitivities to prior and recordings.

    Their reading is added.
    """
    *sizes, reading = found
    numbers = [number(format_number(float(size)), float(size)) for size in sizes]
    return (*numbers, text(reading.item()))


def show_prior_sensitivity(material: Material) -> tuple[Block, ...]:
    """Show which hyperparameters depend on their prior.

    It also shows where the data disagree with it.
    """
    found = material.find("prior_sensitivity")
    if found is None:
        return ()
    rows = []
    for place in np.ndindex(*found["prior"].shape):
        here = found.isel(dict(zip(found["prior"].dims, place, strict=True)))
        name = (
            text("centre" if here["level"] == "mu" else "spread"),
            text(str(here["parameter"].item()).removeprefix("log_")),
            number(str(here["joint"].item()), here["joint"].item()),
        )
        rows.append((*name, *_show_sensitivity(here["prior"], here["likelihood"], here["reading"])))
    for label in found["effect_parameter"].values:
        here = found.sel(effect_parameter=label)
        shown = (here[f"effect_{name}"] for name in ("prior", "likelihood", "reading"))
        rows.append((text("effect"), text(str(label)), text("–"), *_show_sensitivity(*shown)))
    readings = [row[-1].text for row in rows]
    disagree = readings.count("prior and recordings may disagree")
    of = "centres and spreads" if not found["effect_parameter"].size else "shared parameters"
    sentence = (
        f"Of the {len(rows)} {of}, prior and recordings may disagree on {disagree}, and "
        f"{readings.count('the recordings determine little')} depend on their prior because the "
        "recordings determine little."
    )
    caption = (
        "By how much the posterior moves when its prior, or the recordings' likelihood, counts a "
        "little more or less (power scaling, ArviZ's psense); above 0.05 is sensitive. "
        f"{capital(material.cite('posterior'))}."
    )
    columns = ("of", "parameter", "joint", "to the prior", "to the recordings", "reading")
    title = "How far the parameters depend on their priors"
    return (
        Paragraph(sentence, "note" if disagree else "plain"),
        Table("prior_sensitivity", title, caption, columns, tuple(rows), folded=True),
    )


def name_own(label: str) -> str:
    """Name a parameter of a joint in words.

    >>> name_own("log_c_p[2]")
    'c_p, joint 2'
    """
    parameter, joint = label.removesuffix("]").split("[")
    return f"{parameter.removeprefix('log_')}, joint {joint}"
