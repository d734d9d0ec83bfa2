"""What the fit took for granted: one population, its parameters' correlations, and its priors."""

from __future__ import annotations

import numpy as np
import xarray as xr

from softfinger.report.blocks import Block, Paragraph, Table, number, text
from softfinger.report.formatting import capital, format_number
from softfinger.report.material import Material

UNLIKELY = 0.05
SENSITIVE = 0.05
"""Power-scaling sensitivity above which ArviZ speaks of it."""
MOST_PAIRS = 20
DISAGREE = "prior and recordings may disagree"
LITTLE = "the recordings say little"


def show_independence(material: Material) -> tuple[Block, ...]:
    """Say whether a trial's parameters are independent: as fitted, else as the data agree."""
    if material.posterior is not None and "parameter_correlation" in material.posterior:
        return () if is_alone(material) else show_correlations(material)
    found = find_group(material, "independence")
    if found is None or is_alone(material):
        return ()
    own = [name_own(str(label)) for label in found["own"].values]
    p_value, product = found["p_value"].values, found["mean_product"].values
    pairs = sorted(zip(*np.tril_indices(len(own), -1), strict=True), key=lambda at: p_value[at])
    rows = tuple(
        (
            text(own[j]),
            text(own[i]),
            number(format_number(product[i, j]), product[i, j]),
            number(format_number(p_value[i, j]), p_value[i, j]),
        )
        for i, j in pairs[:MOST_PAIRS]
    )
    smallest = float(found["smallest_p"])
    answer = "contradict this" if smallest < UNLIKELY else "do not contradict this"
    sentence = (
        "The model takes a trial's parameters as independent of one another, as the paper does. "
        f"The recordings {answer}: the smallest p of the {len(pairs)} pairs, corrected for their "
        f"number, is {format_number(smallest)}."
    )
    caption = (
        f"The {len(rows)} of {len(pairs)} pairs with the smallest p. Mean product: of both "
        "parameters less their centre over their spread, over trials and draws; about the "
        "correlation where trials are well known. p: two-sided, of this one pair. "
        f"{capital(material.cite('posterior'))}."
    )
    columns = ("parameter", "with", "mean product", "p")
    title = "Whether parameters go together"
    tone = "note" if smallest < UNLIKELY else "plain"
    return (
        Paragraph(sentence, tone),
        Table("independence", title, caption, columns, rows, folded=True),
    )


def show_correlations(material: Material) -> tuple[Block, ...]:
    """Show the fitted correlations of a trial's parameters, the surest first."""
    drawn = material.posterior["parameter_correlation"].stack(sample=("chain", "draw"))
    own = [name_own(str(label)) for label in drawn["own"].values]
    prob = material.limits.ci_prob
    tails = ((1 - prob) / 2, 0.5, (1 + prob) / 2)
    low, middle, high = drawn.quantile(tails, "sample").transpose("quantile", "own", "other_own")
    lower = zip(*np.tril_indices(len(own), -1), strict=True)
    free = [at for at in lower if float(high[at]) > float(low[at])]
    clear = sum(float(low[at]) > 0 or float(high[at]) < 0 for at in free)
    free.sort(key=lambda at: -abs(float(middle[at])) / (float(high[at]) - float(low[at])))
    rows = tuple(
        (
            text(own[j]),
            text(own[i]),
            number(format_number(middle[i, j].item(), 2), middle[i, j].item()),
            text(f"{format_number(low[i, j].item(), 2)} to {format_number(high[i, j].item(), 2)}"),
        )
        for i, j in free[:MOST_PAIRS]
    )
    sentence = (
        f"The model lets {len(free)} pairs of a trial's parameters go together. At "
        f"{100 * prob:g} %, {clear} of them do; chance alone would give about "
        f"{format_number((1 - prob) * len(free), 2)}."
    )
    caption = (
        f"The {len(rows)} of {len(free)} pairs whose correlation over trials is largest against "
        f"its uncertainty: median and {100 * prob:g} % equal-tailed interval. "
        f"{capital(material.cite('posterior'))}."
    )
    columns = ("parameter", "with", "correlation", f"{100 * prob:g} % interval")
    title = "Correlations in the fitted population"
    return (
        Paragraph(sentence),
        Table("parameter_correlation", title, caption, columns, rows, folded=True),
    )


def show_loo_pit(material: Material) -> tuple[Block, ...]:
    """Say whether trials lie where the others predict them, at a few moments of every joint."""
    found = find_group(material, "loo_pit")
    if found is None or is_alone(material):
        return ()
    smallest, tests = float(found["smallest_p"]), found["p_value"].size
    answer = "are not" if smallest < UNLIKELY else "are"
    sentence = (
        "Predicted by the other trials alone, the shares of predictions that lie below the "
        f"recorded angles {answer} spread as evenly as they should: the smallest p of {tests} "
        f"tests, corrected for their number, is {format_number(smallest)}."
    )
    rows = []
    for joint, moment in np.ndindex(*found["p_value"].shape):
        here = found.isel(joint=joint, moment=moment)
        time, p = float(here["pit_time"].median()), float(here["p_value"])
        share = float(here["pit"].mean())
        rows.append(
            (
                number(str(here["joint"].item()), here["joint"].item()),
                number(format_number(time), time),
                number(format_number(share), share),
                number(format_number(p), p),
            )
        )
    caption = (
        f"Over n = {found['trial'].size} trials, each left out of what predicts it, its own "
        "parameters drawn from the population: time (median over trials), mean share of "
        "predictions below the recording (0.5 is even), p of uniformity (Kolmogorov and Smirnov). "
        f"{capital(material.cite('posterior'))}."
    )
    columns = ("joint", "time [s]", "mean share below", "p")
    title = "Where trials lie in what the others predict"
    return (
        Paragraph(sentence, "note" if smallest < UNLIKELY else "plain"),
        Table("loo_pit", title, caption, columns, tuple(rows), folded=True),
    )


def show_prior_sensitivity(material: Material) -> tuple[Block, ...]:
    """Say which hyperparameters hang on their prior, and whether the data disagree with it."""
    found = find_group(material, "prior_sensitivity")
    if found is None:
        return ()
    rows, said = [], []
    for level, parameter, joint in np.ndindex(*found["prior"].shape):
        here = found.isel(level=level, parameter=parameter, joint=joint)
        prior, likelihood = float(here["prior"]), float(here["likelihood"])
        said.append(judge_sensitivity(prior, likelihood))
        rows.append(
            (
                text("centre" if here["level"] == "mu" else "spread"),
                text(str(here["parameter"].item()).removeprefix("log_")),
                number(str(here["joint"].item()), here["joint"].item()),
                number(format_number(prior), prior),
                number(format_number(likelihood), likelihood),
                text(said[-1]),
            )
        )
    sentence = (
        f"Of the {len(said)} centres and spreads, prior and recordings may disagree on "
        f"{said.count(DISAGREE)}, and {said.count(LITTLE)} rest on their prior because the "
        "recordings say little."
    )
    caption = (
        "By how much the posterior moves when its prior, or the recordings' likelihood, counts a "
        f"little more or less (power scaling, ArviZ's psense); above {SENSITIVE:g} is sensitive. "
        f"{capital(material.cite('posterior'))}."
    )
    columns = ("of", "parameter", "joint", "to the prior", "to the recordings", "reading")
    title = "How far the parameters hang on their priors"
    return (
        Paragraph(sentence, "note" if DISAGREE in said else "plain"),
        Table("prior_sensitivity", title, caption, columns, tuple(rows), folded=True),
    )


def judge_sensitivity(prior: float, likelihood: float) -> str:
    """Read a pair of sensitivities as ArviZ does.

    >>> judge_sensitivity(0.01, 0.3), judge_sensitivity(0.3, 0.01)
    ('–', 'the recordings say little')
    """
    if not prior > SENSITIVE:
        return "–"
    return DISAGREE if likelihood > SENSITIVE else LITTLE


def is_alone(material: Material) -> bool:
    """Say whether there is but one trial, which nothing can be held against."""
    return material.angles.sizes["trial"] < 2


def find_group(material: Material, name: str) -> xr.Dataset | None:
    """Return a group of the posterior; a fit with a model file has none of these."""
    if "posterior" not in material or name not in material.artifacts["posterior"].children:
        return None
    return material.artifacts["posterior"][name].to_dataset()


def name_own(label: str) -> str:
    """Name a parameter of a joint in words.

    >>> name_own("log_c_p[2]")
    'c_p, joint 2'
    """
    parameter, joint = label.removesuffix("]").split("[")
    return f"{parameter.removeprefix('log_')}, joint {joint}"
