"""The motion that the priors alone expect."""

import xarray as xr
from matplotlib.figure import Figure

from softfinger.figures.style import (
    BLACK,
    SKY,
    build_joint_axes,
    get_source,
    label_motion,
    measure_joint_rows,
    new_figure,
    styled,
)


@styled
def draw_prior_predictive(prior: xr.Dataset) -> Figure:
    """Draw the joint angle that the priors expect.

    Parameters
    ----------
    prior
        `joint_angle_quantile` (quantile, joint, time) [rad] of the prior predictive, quantiles
        ascending and symmetric; `recorded_low`, `recorded_high` (joint, time) [rad].
    """
    joints = prior["joint"]
    figure = new_figure(
        get_source(prior), height=0.7 + 1.7 * measure_joint_rows(joints.size, n_row=1)
    )
    axes = build_joint_axes(figure, joints.size)[0]
    time, pairs = prior["time"].values, prior["quantile"].size // 2
    for ax, joint in zip(axes, joints.values, strict=True):
        here = prior.sel(joint=joint)
        for place in range(pairs):
            low, high = (here["joint_angle_quantile"].isel(quantile=i) for i in (place, -1 - place))
            share = float(high["quantile"] - low["quantile"])
            label = f"prior, {100 * share:.0f} %"
            ax.fill_between(
                time, low, high, color=SKY, alpha=0.25 + 0.3 * place, linewidth=0, label=label
            )
        recorded = here["recorded_low"].values, here["recorded_high"].values
        ax.fill_between(time, *recorded, color=BLACK, alpha=0.6, linewidth=0.8, label="recorded")
        ax.set(title=f"joint {joint}", xlabel="time [s]")
    figure.supylabel(label_motion(prior), size=7)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper left", ncols=4)
    return figure
