"""The shape of what no listed effect explains."""

import xarray as xr
from matplotlib.figure import Figure

from softfinger.figures.style import (
    BLUE,
    DOUBLE_COLUMN,
    GREEN,
    GREY,
    ORANGE,
    PARAMETER_LABELS,
    RED,
    SINGLE_COLUMN,
    get_source,
    new_figure,
    styled,
)

JOINT_STYLES = ((BLUE, "-"), (RED, "--"), (GREEN, "-."), (ORANGE, ":"))
ARGUMENT_LABELS = {
    "time_s": "time [s]",
    "time_since_change_s": "time since the load changed [s]",
    "angle_rad": "joint angle [rad]",
    "rate_rad_per_s": "rate of the joint angle [rad/s]",
    "trial_number": "trials before [1]",
    "rest_s": "rest before the trial [s]",
}


@styled
def draw_free_form(free_form: xr.Dataset, load_unit: str) -> Figure:
    """Draw a free-form term with twice its posterior sd.

    A panel for each kind of quantity, the joint angle or parameters of the trials; a line for each
    joint.

    Parameters
    ----------
    free_form
        The artifact `free_form`: value, sd (quantity, place).
    load_unit
        Of the load, where the term depends on that.
    """
    split = [str(name).rsplit("_", 1) for name in free_form["quantity"].values]
    kinds = list(dict.fromkeys(kind for kind, _ in split))
    width = DOUBLE_COLUMN if len(kinds) > 1 else SINGLE_COLUMN
    figure = new_figure(get_source(free_form), 2.4, width)
    axes = dict(zip(kinds, figure.subplots(1, len(kinds), squeeze=False)[0], strict=True))
    place = free_form["place"].values
    for row, (kind, joint) in enumerate(split):
        value, sd = (free_form[name].values[row] for name in ("value", "sd"))
        colour, line = JOINT_STYLES[(int(joint) - 1) % len(JOINT_STYLES)]
        band = value - 2 * sd, value + 2 * sd
        axes[kind].fill_between(
            place, *band, color=colour, alpha=0.2, lw=0, label=f"_joint {joint}"
        )
        axes[kind].plot(place, value, line, color=colour, label=f"joint {joint}")
    for kind, ax in axes.items():
        ax.axhline(0.0, color=GREY, lw=0.6, label="_")
        ax.set_xlabel(label_argument(str(free_form.attrs["argument"]), load_unit))
        ax.set_ylabel(label_quantity(kind))
        if free_form.attrs["argument"] == "time_since_change_s":
            ax.set_xscale("symlog", linthresh=float(place[-1]) / 1000)
        ax.set_xlim(place[0], place[-1])
    handles = next(iter(axes.values())).get_legend_handles_labels()
    figure.legend(*handles, loc="outside upper left", ncols=4)
    return figure


def label_argument(argument: str, load_unit: str) -> str:
    """Label a free-form term's argument, with its unit.

    >>> label_argument("largest_load_before", "N m")
    'largest load before [N m]'
    """
    if argument in ("load", "largest_load", "largest_load_before"):
        return f"{argument.replace('_', ' ')} [{load_unit}]"
    return ARGUMENT_LABELS.get(argument, argument.replace("_", " "))


def label_quantity(kind: str) -> str:
    """Label what a free-form term adds to.

    >>> label_quantity("joint_angle"), label_quantity("log_c_v")
    ('added to the angle [rad]', 'added to log $c_v$ [1]')
    """
    if kind == "joint_angle":
        return "added to the angle [rad]"
    return f"added to log {PARAMETER_LABELS[kind.removeprefix('log_')]} [1]"
