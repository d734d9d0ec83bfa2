"""The free laws that the recordings ask for."""

import xarray as xr
from matplotlib.figure import Figure

from softfinger.figures.style import (
    BLUE,
    DOUBLE_COLUMN,
    GREEN,
    GREY,
    ORANGE,
    RED,
    SINGLE_COLUMN,
    get_source,
    new_figure,
    styled,
)
from softfinger.units import RADIANS, Units, read_units, split_unit

STYLES = ((BLUE, "-"), (RED, "--"), (GREEN, "-."), (ORANGE, ":"))
NULL = {"factor": 1.0, "exponential": 1.0, "sum": 0.0}


@styled
def draw_laws(laws: xr.Dataset) -> Figure:
    """Draw every free law with its band."""
    effects = list(dict.fromkeys(laws["effect"].values.astype(str).tolist()))
    width = DOUBLE_COLUMN if len(effects) > 1 else SINGLE_COLUMN
    figure = new_figure(get_source(laws), 2.4, width)
    axes = dict(zip(effects, figure.subplots(1, len(effects), squeeze=False)[0], strict=True))
    drawn, units = dict.fromkeys(effects, 0), read_units(laws.attrs)
    for row in range(laws.sizes["law"]):
        here = laws.isel(law=row)
        name, joint = str(here["effect"].values), int(here["joint"])
        colour, line = STYLES[drawn[name] % len(STYLES)]
        drawn[name] += 1
        place, label = here["argument"].values, f"joint {joint}" if joint else "all joints"
        band = {"color": colour, "alpha": 0.2, "lw": 0, "label": f"_{label}"}
        axes[name].fill_between(place, here["low"], here["high"], **band)
        axes[name].plot(place, here["value"], line, color=colour, label=label)
        axes[name].axhline(NULL[str(here["kind"].values)], color=GREY, lw=0.6, label="_")
        axes[name].set(
            title=name.replace("_", " "),
            xlabel=label_argument(str(here["argument_name"].values), units),
            ylabel="sum [1]" if str(here["kind"].values) == "sum" else "factor [1]",
            xlim=(place[0], place[-1]),
        )
    for ax in axes.values() if not units.specimen else ():
        ax.legend()
    return figure


def label_argument(name: str, units: Units = RADIANS) -> str:
    """Label an argument whose name ends in its unit.

    >>> label_argument("angle_rad"), label_argument("torque_nm"), label_argument("trial_number")
    ('angle [rad]', 'torque [N m]', 'trial number [1]')
    >>> label_argument("damper_rate_rad_per_s")
    'damper rate [rad/s]'
    """
    words, unit, _ = split_unit(name, units)
    return f"{words} [{unit or 1}]"
