import numpy as np
import xarray as xr

from softfinger.figures.effects import plot_effect


def build_shown(level):
    angle = np.zeros((2, 4, 3, 5))
    angle[:, :, 1] = np.arange(5.0)
    angle[1, 2, 1] += 7.0  # trial 3, joint 2
    return xr.Dataset(
        {
            "joint_angle": (("model", "trial", "joint", "frame"), angle),
            "load": ("frame", np.ones(5)),
        },
        {
            "model": ["without", "with"],
            "trial": np.arange(1, 5),
            "time": ("frame", 0.1 * np.arange(5.0)),
        },
        {"level": level},
    )


def test_the_joint_and_the_trial_that_move_most_are_drawn_against_time():
    axes = plot_effect(build_shown("within_trial")).axes[0]
    without, moved = (line.get_ydata() for line in axes.get_lines())
    np.testing.assert_array_equal(without, np.arange(5.0))
    np.testing.assert_array_equal(moved, np.arange(7.0, 12.0))
    assert axes.get_xlabel() == "time [s]"


def test_an_effect_between_trials_is_drawn_against_the_trial():
    axes = plot_effect(build_shown("between_trials")).axes[0]
    without, moved = (line.get_ydata() for line in axes.get_lines())
    np.testing.assert_array_equal(without, [4.0] * 4)
    np.testing.assert_array_equal(moved, [4.0, 4.0, 11.0, 4.0])
    assert axes.get_xlabel() == "trial"
