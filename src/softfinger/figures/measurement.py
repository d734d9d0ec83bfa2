"""Noise and useless frames of the recordings."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from softfinger.figures.style import BLUE, GREEN, GREY, ORANGE, RED, get_source, new_figure, styled

JOINT_STYLES = ((BLUE, "o", "-"), (RED, "s", "--"), (GREEN, "^", "-."), (ORANGE, "d", ":"))


@styled
def draw_measurement(noise: xr.Dataset, unit: str) -> Figure:
    """Draw noise and useless frames of every trial.

    Parameters
    ----------
    noise
        The group `noise` of the summary.
    unit
        A thousandth of the motion's.
    """
    figure = new_figure(get_source(noise), 2.3)
    grows = bool((noise["fast_sd"].isel(speed=-1) > noise["fast_sd"].isel(speed=0)).any())
    ratio, frames, growth, *fast = figure.subplots(1, 3 + grows)
    number = np.arange(1, noise.sizes["trial"] + 1)
    for k, joint in enumerate(noise["joint"].values):
        colour, mark, line = JOINT_STYLES[k % len(JOINT_STYLES)]
        here, label = noise.sel(joint=joint), f"joint {joint}"
        beside = number + 0.15 * (k - (noise.sizes["joint"] - 1) / 2)
        ratio.plot(beside, here["noise_ratio"], mark, ms=2.5, color=colour, label=label)
        growth.plot(noise["deflection"], 1e3 * here["grown_sd"], line, color=colour, label=label)
        for ax in fast:
            ax.plot(noise["speed"], 1e3 * here["fast_sd"], line, color=colour, label=label)
    ratio.axhline(1.0, color=GREY, lw=0.6, label="_")
    ratio.set(xlabel="trial [1]", ylabel="noise over the campaign's [1]", ylim=(0, None))
    _draw_shares(frames, number, noise)
    growth.set(xlabel="deflection [rad]", ylabel=f"sd of the noise [{unit}]", ylim=(0, None))
    for ax in fast:
        ax.set(xlabel="speed [rad/s]", ylabel=f"sd of the noise [{unit}]", ylim=(0, None))
    figure.legend(*ratio.get_legend_handles_labels(), loc="outside upper left", ncols=4)
    return figure


def _draw_shares(ax: Axes, number: np.ndarray, noise: xr.Dataset) -> None:
    kinds = (
        ("gross_share", BLUE, "x", "gross errors"),
        ("repeated_share", RED, "+", "repeated"),
        ("saturated_share", GREEN, "1", "at a sensor's limit"),
    )
    for name, colour, mark, label in kinds:
        ax.plot(number, 100 * noise[name], mark, ms=4, color=colour, label=label)
    ax.set(xlabel="trial [1]", ylabel="frames left out [%]", ylim=(0, None))
    ax.legend()
