"""Can the numbers be trusted: computation, calibration, fit to the recordings."""

from __future__ import annotations

import numpy as np

from softfinger.report.blocks import (
    Block,
    Cell,
    Checks,
    Paragraph,
    Section,
    Table,
    number,
    text,
)
from softfinger.report.checks import check_calibration, check_computation, check_fit
from softfinger.report.formatting import (
    capital,
    format_interval,
    format_measure,
    format_percent,
    format_shares,
)
from softfinger.report.granted import show_loo_pit
from softfinger.report.material import Material
from softfinger.report.pictures.fit import picture_bands, picture_residuals, picture_sampling


def build_computation(material: Material) -> Section:
    """Build the verdict on the computation."""
    caption = (
        "Each against its limit. A failed one means that intervals and "
        "means of this report may be wrong; a large Pareto k, only scores that leave a trial out. "
        f"{capital(material.cite('sampling', 'posterior'))}."
    )
    blocks = (
        Checks(
            "computation_checks", "Checks of the computation", caption, check_computation(material)
        ),
        picture_sampling(material),
    )
    return Section("computation", "Is the computation sound?", tuple(b for b in blocks if b))


def build_calibration(material: Material) -> Section:
    """Build the section on calibration: whether intervals hold what they claim."""
    caption = (
        "Coverage is the share of recorded frames inside a band, "
        f"averaged per trial. {capital(material.cite('bands'))}."
    )
    blocks: list[Block | None] = [
        Checks(
            "calibration_checks", "Checks of the calibration", caption, check_calibration(material)
        ),
        build_coverage_table(material),
        build_truth_table(material),
    ]
    several = material.angles.sizes["trial"] > 1
    if several and "bands" in material and "bands_are" in material.bands.attrs:
        blocks.insert(1, Paragraph(f"{capital(material.get('bands').attrs['bands_are'])}.", "note"))
    return Section("calibration", "Do intervals hold what they claim?", tuple(filter(None, blocks)))


def build_coverage_table(material: Material) -> Table | None:
    """Tabulate coverage per estimate, protocol, window and joint; a single trial has none."""
    if "bands" not in material or material.angles.sizes["trial"] < 2:
        return None
    bands = material.bands
    rows = []
    order = ("protocol", "window", "joint", "ci_prob", "estimate")
    coverage = bands["coverage"].transpose(*order)
    bound = bands["coverage_bound"].transpose(*order, "bound")
    for place in np.ndindex(coverage.shape):
        labels = [coverage[dim].values[i] for dim, i in zip(order, place, strict=True)]
        value = float(coverage.values[place])
        low, high = bound.values[place]
        if np.isfinite(value):
            rows.append(
                (
                    text(labels[0]),
                    text(str(labels[1]).replace("_", " ")),
                    number(str(labels[2]), labels[2]),
                    number(format_percent(labels[3]), labels[3]),
                    text(str(labels[4]).replace("_", "-")),
                    number(format_percent(value, 1), value),
                    text(format_shares(low, high, 1)),
                )
            )
    columns = ("protocol", "window", "joint", "claimed", "estimate", "held", "90 % interval")
    caption = (
        "Share of recorded frames inside the predictive bands, averaged per trial, its interval "
        f"by bootstrap over trials. {capital(material.cite('bands'))}."
    )
    return Table(
        "coverage",
        "Coverage of the predictive bands",
        caption,
        columns,
        tuple(rows),
        folded=len(rows) > 12,
    )


def build_truth_table(material: Material) -> Table | None:
    """Tabulate whether the intervals hold the truth, where a simulation told it."""
    summary = material.hyperparameters
    if summary is None or "truth" not in summary:
        return None
    rows, held = [], []
    for statistic in summary["statistic"].values:
        for parameter in summary["parameter"].values:
            for joint in summary["joint"].values:
                here = summary.sel(statistic=statistic, parameter=parameter, joint=joint)
                low, high = here["quantile_value"].values[[0, -1]]
                middle, true = float(here["quantile_value"][2]), float(here["truth"])
                held.append(bool(low <= true <= high))
                rows.append(
                    (
                        text(f"{statistic} of {parameter}"),
                        number(str(joint), joint),
                        number(f"{true:.3f}", true),
                        number(format_measure(middle, float(here["sd"])), middle),
                        text(format_interval(low, high)),
                        Cell("yes" if held[-1] else "no", float(held[-1])),
                    )
                )
    share = format_percent(material.limits.ci_prob)
    caption = (
        f"The truth of the simulation beside the posterior: {sum(held)} of {len(held)} "
        f"equal-tailed {share} intervals hold it. mu and sigma are mean and standard deviation "
        "over trials, of "
        f"the natural logarithm but for q_ini. {capital(material.cite('posterior', 'truth'))}."
    )
    columns = ("hyperparameter", "joint", "truth", "posterior", f"{share} interval", "held")
    return Table(
        "truth", "Truth of the simulation", caption, columns, tuple(rows), folded=len(rows) > 12
    )


def build_predictive(material: Material) -> Section:
    """Build the section on fit and bands against the recordings."""
    caption = (
        "Each against its limit. A failed one means that physics is missing "
        f"from the model, however sound the computation. {capital(material.cite('posterior'))}."
    )
    blocks = (
        Checks(
            "fit_checks", "Checks of the model against the recordings", caption, check_fit(material)
        ),
        picture_bands(material, early=False),
        picture_bands(material, early=True),
        picture_residuals(material),
        build_residual_table(material),
        *show_loo_pit(material),
    )
    return Section(
        "predictive", "Does the model describe the recordings?", tuple(b for b in blocks if b)
    )


def build_residual_table(material: Material) -> Table | None:
    """Tabulate the size of the residual beside the noise, per joint."""
    residuals = material.residuals
    if residuals is None:
        return None
    declared = float(material.angles.attrs.get("noise_sd_rad", np.nan))
    rows = []
    for joint in residuals["joint"].values:
        rms = float(np.sqrt((residuals["residual"].sel(joint=joint) ** 2).mean()))
        noise = material.posterior["noise_sd"].sel(joint=joint)
        shared = residuals["mean_residual"].sel(joint=joint)
        largest = float(np.abs(shared).max())
        mean, sd = float(noise.mean()), float(noise.std())
        rows.append(
            (
                number(str(joint), joint),
                number(f"{1e3 * rms:.2f}", 1e3 * rms),
                number(format_measure(1e3 * mean, 1e3 * sd), 1e3 * mean),
                number(f"{1e3 * declared:.2f}" if np.isfinite(declared) else "–", 1e3 * declared),
                number(f"{1e3 * largest:.2f}" if np.isfinite(largest) else "–", 1e3 * largest),
            )
        )
    columns = (
        "joint",
        "residual rms [mrad]",
        "noise by the fit, mean ± sd [mrad]",
        "noise declared [mrad]",
        "largest mean residual [mrad]",
    )
    caption = (
        "All trials pooled. The fit calls whatever it cannot "
        "describe noise: a fitted noise well above the declared one is misfit. "
        f"{capital(material.cite('posterior', 'angles'))}."
    )
    return Table("residual_size", "Size of what the model leaves", caption, columns, tuple(rows))
