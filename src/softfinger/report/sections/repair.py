"""What the omission did to parameters and predictions."""

import numpy as np
import xarray as xr

from softfinger.figures.style import get_motion_unit
from softfinger.report.blocks import Block, Table, number, text
from softfinger.report.formatting import (
    format_measure,
    format_number,
    format_percent,
    format_shares,
)
from softfinger.units import label_thousandth


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
        "Population means ± sd by the base and the repaired model (logarithms, q_ini in "
        f"{get_motion_unit(repair)}); the bias of a logarithm is about the relative error that the "
        "omission caused. Spread explained: share of the variance between trials that was physics; "
        "negative where the base model hid spread. Rule diagnose, artifact repair."
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
