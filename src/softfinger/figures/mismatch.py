"""Where models miss, and what a protocol could show."""

import numpy as np
import xarray as xr
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from softfinger.figures.repair import MODEL_STYLES
from softfinger.figures.style import SKY, get_source, new_figure, styled

SMALLEST_Q = 1e-6


@styled
def draw_location(location: xr.Dataset) -> Figure:
    """Draw where the base and the final model miss.

    Each row is a joint; colour is the rate at which a cell counts as missed, 1e-6 or less darkest;
    empty cells contain too few angles.

    Parameters
    ----------
    location
        q_value (model, joint, phase, window).
    """
    for dim in ("phase", "window"):
        location = location.dropna(dim, how="all", subset=["q_value"])
    models = [str(name) for name in location["model"].values]
    joints = location["joint"].values
    figure = new_figure(get_source(location), height=max(1.9, 0.8 + 0.75 * joints.size))
    axes = figure.subplots(joints.size, len(models), squeeze=False, sharex=True, sharey=True)
    scale = LogNorm(SMALLEST_Q, 1.0)
    for row, joint in zip(axes, joints, strict=True):
        for ax, model in zip(row, models, strict=True):
            value = location["q_value"].sel(joint=joint, model=model).values
            drawn = ax.pcolormesh(
                np.maximum(value, SMALLEST_Q),
                norm=scale,
                cmap="cividis",
                label="_false-discovery rate",
            )
            ax.set_title(f"{MODEL_STYLES[model][2]}, joint {joint}")
            ax.set_yticks(np.arange(value.shape[0]) + 0.5, location["phase"].values.tolist())
            ax.grid(visible=False)
            ax.spines[["left", "bottom"]].set_visible(False)
    edges = [f"{w:g}" for w in location["window"].values]
    for ax in axes[-1]:
        ax.set_xticks(np.arange(len(edges)), edges)
        ax.set_xlabel("time since the load changed, from [s]")
    figure.colorbar(drawn, ax=axes, label="false-discovery rate", extend="min", aspect=30)
    return figure


@styled
def draw_masking(masking: xr.Dataset) -> Figure:
    """Draw what is left of every effect's signal.

    Parameters
    ----------
    masking
        share_left, expected_gain (effect), likeness (effect, other_effect).
    """
    order = np.argsort(-masking["share_left"].values, kind="stable")
    shown = masking.isel(effect=order, other_effect=order)
    names = [str(name).replace("_", " ") for name in shown["effect"].values]
    figure = new_figure(get_source(masking), height=0.9 + 0.19 * max(len(names), 4))
    left, right = figure.subplots(1, 2, width_ratios=[1, 1.25], sharey=True)
    rows = np.arange(len(names))
    left.barh(rows, 100 * shown["share_left"].values, color=SKY, height=0.7, label="_signal left")
    for row, gain in zip(rows, shown["expected_gain"].values, strict=True):
        left.annotate(write_gain(gain), (1, row), (34, 0), xycoords=("axes fraction", "data"),
                      textcoords="offset points", ha="right", va="center", fontsize=7)  # fmt: skip
    left.set_yticks(rows, names)
    left.set(xlabel="signal left after refitting [%]", xlim=(0, 100))
    left.set_title("signal left; right: gain to expect [nats]")
    left.grid(axis="y", visible=False)
    drawn = right.imshow(np.abs(shown["likeness"].values), cmap="cividis", vmin=0, vmax=1,
                         aspect="auto", label="_likeness")  # fmt: skip
    right.set_xticks(rows, names, rotation=90)
    right.set_title("likeness of what is left, |cosine|")
    right.grid(visible=False)
    figure.colorbar(drawn, ax=right)
    return figure


def write_gain(gain: float) -> str:
    """Write a log evidence in few characters.

    >>> write_gain(0.0102), write_gain(546.3), write_gain(6130.0), write_gain(4e7)
    ('0.01', '546', '6130', '> 10 000')
    """
    if gain >= 1e4:
        return "> 10 000"
    return f"{gain:.0f}" if gain >= 100 else f"{gain:.2g}"
