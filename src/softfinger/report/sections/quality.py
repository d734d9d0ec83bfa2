"""Whether the numbers can be trusted.

It covers computation, calibration and fit to the recordings.
"""

import numpy as np

from softfinger.report.blocks import (
    Block,
    Checks,
    Paragraph,
    Section,
    Table,
    keep_blocks,
    number,
    text,
)
from softfinger.report.checks import CALIBRATION, COMPUTATION, FIT, list_checks
from softfinger.report.formatting import (
    capital,
    format_measure,
    format_percent,
    format_shares,
)
from softfinger.report.granted import show_loo_pit
from softfinger.report.material import Material
from softfinger.report.pictures.fit import picture_bands, picture_residuals, picture_sampling
from softfinger.units import label_thousandth


def build_computation(material: Material) -> Section:
    """Build the verdict on the computation."""
    caption = (
        "Each against its limit. A failed one means that intervals and "
        "means of this report may be wrong; a large Pareto k, only scores that leave a trial out. "
        f"{capital(material.cite('sampling', 'posterior'))}."
    )
    blocks = (
        Checks(
            "computation_checks",
            "Checks of the computation",
            caption,
            list_checks(material, COMPUTATION),
        ),
        picture_sampling(material),
    )
    return Section("computation", "Is the computation sound?", keep_blocks(*blocks))


def build_calibration(material: Material) -> Section:
    """Section on calibration.

    Whether intervals contain the truth as often as they claim.
    """
    caption = (
        "Coverage is the share of recorded frames inside a band, "
        f"averaged per trial. {capital(material.cite('bands'))}."
    )
    blocks: list[Block | None] = [
        Checks(
            "calibration_checks",
            "Checks of the calibration",
            caption,
            list_checks(material, CALIBRATION),
        ),
        build_coverage_table(material),
    ]
    if not material.is_alone and "bands" in material and "bands_are" in material.bands.attrs:
        blocks.insert(1, Paragraph(f"{capital(material.get('bands').attrs['bands_are'])}.", "note"))
    return Section("calibration", "Do intervals contain what they claim?", keep_blocks(*blocks))


def build_coverage_table(material: Material) -> Table | None:
    """Table of coverage, none for a single trial.

    Each estimate, protocol, window and joint has a row.
    """
    if "bands" not in material or material.is_alone:
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


def build_predictive(material: Material) -> Section:
    """Section on fit and bands against the recordings."""
    caption = (
        "Each against its limit. A failed one means that physics is missing "
        f"from the model, however sound the computation. {capital(material.cite('posterior'))}."
    )
    blocks = (
        Checks(
            "fit_checks",
            "Checks of the model against the recordings",
            caption,
            list_checks(material, FIT),
        ),
        picture_bands(material, early=False) if "repair" in material else None,
        picture_bands(material, early=True),
        picture_residuals(material),
        build_residual_table(material),
        *show_loo_pit(material),
    )
    return Section("predictive", "Does the model describe the recordings?", keep_blocks(*blocks))


def build_residual_table(material: Material) -> Table | None:
    """Table of residuals beside the noise, per joint."""
    found = material.find("residuals")
    if found is None:
        return None
    declared, small = 1e3 * float(found["noise_declared"]), label_thousandth(material.motion_unit)
    rows = []
    for joint in found["joint"].values:
        here = found.sel(joint=joint)
        rms, mean, sd, largest = (
            1e3 * float(here[name])
            for name in ("residual_rms", "noise_mean", "noise_sd", "largest_mean")
        )
        rows.append(
            (
                number(str(joint), joint),
                number(f"{rms:.2f}", rms),
                number(format_measure(mean, sd), mean),
                number(f"{declared:.2f}" if np.isfinite(declared) else "–", declared),
                number(f"{largest:.2f}" if np.isfinite(largest) else "–", largest),
            )
        )
    columns = (
        "joint",
        f"residual rms [{small}]",
        f"noise by the fit, mean ± sd [{small}]",
        f"noise declared [{small}]",
        f"largest mean residual [{small}]",
    )
    caption = (
        "All trials pooled. The fit calls whatever it cannot "
        "describe noise: a fitted noise well above the declared one is misfit. "
        f"{capital(material.cite('posterior', 'angles'))}."
    )
    return Table("residual_size", "Size of what the model leaves", caption, columns, tuple(rows))
