"""Recordings are set right by what is known to be wrong with them."""

import re

import numpy as np
import pytest
import xarray as xr

from softfinger.faults import Fault
from softfinger.measurement.mend import READINGS, mend_recordings
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
            "load_time": (("trial", "knot"), TIME[:, : len(TORQUE)]),
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


def test_frames_are_later_in_the_trials_that_are_named(still):
    mended = mend_recordings(still, MeasurementEntry(clock_offsets_s={"b": 0.02, "other": 1.0}))
    np.testing.assert_allclose(mended["time"].values - TIME, [[0.0] * 50, [0.02] * 50, [0.0] * 50])
    assert mended["time"].dims == still["time"].dims


@pytest.fixture
def stepped(still):
    """A step in trials a and b, none in c."""
    time = np.tile([0.0, 0.56, 0.6, 0.6, 2.0], (3, 1))
    torque = np.array([[0.0, 0.0, 0.0, 0.04, 0.04]] * 2 + [[0.0] * 5])
    dims = ("trial", "knot")
    return still.assign(load_time=(dims, time), load_torque=(dims, torque))


def test_a_step_comes_sooner_by_its_own_share(stepped):
    known = MeasurementEntry(step_shares={"b": [0.25]})
    mended = mend_recordings(stepped, known)["load_time"].values
    np.testing.assert_allclose(mended[:, 2], [0.6, 0.59, 0.6])


def test_a_log_whose_rows_last_has_other_steps(stepped):
    """A ramp that the log states by its ends is a step then, and has no share of its own."""
    slow = stepped.assign(load_torque=stepped["load_torque"] * [1.0, 1.0, 1.0, 1.0, 0.5])
    known = MeasurementEntry(steady_load=True, step_shares={"a": [0.25], "b": [0.75]})
    mended = mend_recordings(slow, READINGS["ramps_held"](known))
    once = known.model_copy(update={"step_shares": {}, "steps_early": 0.5, "ramps_held": True})
    xr.testing.assert_identical(mended, mend_recordings(slow, once))


@pytest.mark.parametrize(
    ("trial", "shares", "message"),
    [
        ("b", [0.25, 0.5], "measurement.step_shares.b: 2 listed, expected at most 1,"),
        ("c", [0.25], "measurement.step_shares.c: 1 listed, expected at most 0,"),
    ],
)
def test_shares_of_steps_that_are_not_are_refused(stepped, trial, shares, message):
    with pytest.raises(Fault, match=f"^{re.escape(message)}"):
        mend_recordings(stepped, MeasurementEntry(step_shares={trial: shares}))


def test_a_hum_of_another_finger_is_refused(still):
    hum = HumEntry(frequency_hz=3.1, cosine_rad={"a": [0.1] * 3}, sine_rad={"a": [0.1] * 3})
    with pytest.raises(Fault, match="3 amplitudes in trial a, expected 2, one a joint"):
        mend_recordings(still, MeasurementEntry(hums=[hum]))
