"""Recordings are set right by what is known to be wrong with them."""

import numpy as np
import pytest
import xarray as xr

from softfinger.measurement.mend import mend_recordings
from softfinger.measurement.steady import steady_load_array
from softfinger.mechanics.effects.measurement_file import HumEntry, MeasurementEntry

TIME = np.tile(np.arange(50) / 25.0, (3, 1))
TORQUE = np.array([0.0, 0.0, 0.040, 0.0404, 0.0396])
NAMES = ["a", "b", "c"]


@pytest.fixture
def still():
    return xr.Dataset(
        {
            "time": (("trial", "frame"), TIME),
            "joint_angle": (("trial", "joint", "frame"), np.full((3, 2, 50), 0.3)),
            "load_torque": (("trial", "knot"), np.tile(TORQUE, (3, 1))),
        },
        {"trial": NAMES, "joint": [1, 2]},
        {"campaign": "still"},
    )


def test_sound_recordings_stay_as_they_are(still):
    xr.testing.assert_identical(mend_recordings(still, MeasurementEntry()), still)


def test_readings_of_a_load_at_rest_count_as_one(still):
    mended = mend_recordings(still, MeasurementEntry(steady_load=True))
    np.testing.assert_allclose(mended["load_torque"].values[1], [0.0, 0.0, 0.04, 0.04, 0.04])


def test_a_hum_is_taken_off_at_the_times_that_were_set_right(still):
    right = 1.004 * TIME
    phase = 2.0 * np.pi * 3.1 * right
    hum = HumEntry(
        frequency_hz=3.1,
        cosine_rad={"c": [0.01, 0.02], "a": [0.03, 0.04]},
        sine_rad={"c": [0.05, 0.06], "a": [0.07, 0.08]},
    )
    loud = still["joint_angle"].values.copy()
    loud[2, 1] += 0.02 * np.cos(phase[2]) + 0.06 * np.sin(phase[2])
    loud[0, 0] += 0.03 * np.cos(phase[0]) + 0.07 * np.sin(phase[0])
    recorded = still.assign(joint_angle=(still["joint_angle"].dims, loud))
    mended = mend_recordings(recorded, MeasurementEntry(clock_rate=0.004, hums=[hum]))
    np.testing.assert_allclose(mended["time"].values, right)
    angle = mended["joint_angle"].values
    np.testing.assert_allclose(angle[[2, 0], [1, 0]], 0.3)
    np.testing.assert_array_equal(angle[1], 0.3)
    assert np.ptp(angle[2, 0]) > 0.05
    assert mended.attrs == {"campaign": "still"}


def test_a_ramp_ends_in_a_plateau_that_is_steadied():
    ramp, noise = np.array([0.0, 0.3, 0.6, 0.93, 0.965]), 0.003 * np.sin(np.arange(200.0))
    steady = steady_load_array(np.concatenate([ramp, 1.0 + noise]))
    assert np.ptp(steady[5:]) == 0.0
    np.testing.assert_array_equal(steady[:4], ramp[:4])
    drifts = np.concatenate([ramp, np.linspace(1.0, 1.2, 200)])
    np.testing.assert_array_equal(steady_load_array(drifts), drifts)


@pytest.mark.parametrize("held", [1, 2])
def test_plateaus_that_no_row_separates_are_steadied_alone(held):
    noise = 0.004 * np.random.default_rng(1).normal(size=(3, 300))
    rise, fall = np.linspace(0.6, 0.76, 6)[1:-1], np.linspace(0.76, 0.68, 4)[1:-1]
    parts = [0.6 + noise[0], rise, 0.76 + noise[1], fall, 0.68 + noise[2]]
    steady = steady_load_array(np.repeat(np.concatenate(parts), held))[::held]
    for start, level in ((0, 0.6), (304, 0.76), (606, 0.68)):
        inside = steady[start : start + 300]
        assert np.mean(inside == inside[150]) > 0.99
        np.testing.assert_allclose(inside[150], level, atol=0.001)


@pytest.mark.parametrize("scatter", [0.0, 0.002])
def test_a_slow_ramp_is_no_stair(scatter):
    noise = scatter * np.random.default_rng(2).normal(size=1000)
    triangle = np.concatenate([np.linspace(0.0, 1.0, 500), np.linspace(1.0, 0.0, 500)]) + noise
    np.testing.assert_array_equal(steady_load_array(triangle), triangle)


def test_a_ramp_of_few_rows_is_no_stair():
    ramp = np.linspace(0.0, 1.0, 50)
    np.testing.assert_array_equal(steady_load_array(ramp), ramp)


@pytest.mark.parametrize("held", [1, 2])
def test_small_steps_are_kept_and_a_drift_is_not(held):
    noise = 0.004 * np.random.default_rng(3).normal(size=(3, 300))
    levels = np.concatenate([1.0 + noise[0], 0.97 + noise[1], 1.0 + noise[2]])
    steady = steady_load_array(np.repeat(levels, held))[::held]
    for part, level in zip(np.split(steady, 3), (1.0, 0.97, 1.0), strict=True):
        np.testing.assert_allclose(part[5:-5], level, atol=0.001)
    drift = np.linspace(1.0, 1.03, 900) + noise.ravel()
    assert np.ptp(steady_load_array(np.repeat(drift, held))) == 0.0
