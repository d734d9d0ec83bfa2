"""Jitter of the frames' times, told from noise of each joint."""

import numpy as np
import pytest
import xarray as xr

from softfinger.measurement.jitter import is_jitter
from softfinger.measurement.noise import NoiseFit
from softfinger.measurement.reml import Windows

ROWS, LENGTH = 60, 40
GROWTH = np.array([[3.0, -2.0, 4.0]]).T * np.linspace(0.0, 1.0, ROWS * LENGTH)


def fit(values):
    """What windows (joint, n) show, each joint's in units of its sd."""
    joints, rows = values.shape
    place = np.arange(rows)
    start = np.arange(0, rows + 1, LENGTH)
    position = np.tile(np.linspace(-1.0, 1.0, LENGTH), ROWS)
    gap = np.where(place % LENGTH, 1.0, np.inf)
    rest = np.ones(ROWS, bool)
    noise = xr.Dataset(
        {
            "noise_autocorrelation": ("joint", np.zeros(joints)),
            "noise_white": ("joint", np.zeros(joints)),
        }
    )
    return NoiseFit(noise, [Windows(position, row, gap, start, place, rest) for row in values])


@pytest.mark.parametrize("correlation", [0.0, 0.6])
@pytest.mark.parametrize("together", [True, False])
def test_what_joints_share_is_an_error_of_time(together, correlation):
    """Joints that are correlated at rest are no sign of it."""
    rng = np.random.default_rng(3)
    shape = GROWTH.shape
    rest = np.sqrt(1 - correlation) * rng.standard_normal(shape)
    rest += np.sqrt(correlation) * rng.standard_normal(shape[1])
    grown = GROWTH * rng.standard_normal(shape[1] if together else shape)
    values = (rest + grown) / np.sqrt(1.0 + GROWTH**2)
    assert is_jitter(fit(values), GROWTH[None]) is together


def test_a_joint_alone_shows_neither_and_is_taken_for_jitter():
    values = np.random.default_rng(4).standard_normal((1, ROWS * LENGTH))
    assert is_jitter(fit(values), GROWTH[None, :1])
