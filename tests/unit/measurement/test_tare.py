"""What a log reads while the finger rests is its zero."""

import numpy as np
import pytest
import xarray as xr

from softfinger.campaign.load_log import build_load_array
from softfinger.measurement.mend import mend_recordings
from softfinger.measurement.tare import find_zero, tare_log
from softfinger.mechanics.effects.measurement_file import MeasurementEntry

ROWS = np.arange(60) / 50
PULL = np.where(ROWS < 0.5, 0.0, 3.0)


def read(*loads):
    logs = [build_load_array(ROWS, load, 0.05) for load in loads]
    most = max(len(time) for time, _ in logs)
    padded = [[np.pad(part, (0, most - len(part)), "edge") for part in log] for log in logs]
    names = ("load_time", "load_torque")
    return xr.Dataset(
        {
            name: (("trial", "knot"), np.stack([p[k] for p in padded]))
            for k, name in enumerate(names)
        }
    )


def step_through(log, at):
    time = log["load_time"].values[0] + 1e-9 * np.arange(log.sizes["knot"])
    return np.interp(at, time, log["load_torque"].values[0])


@pytest.mark.parametrize("zero", [0.02, -0.05])
def test_the_zero_is_taken_off_everywhere(zero):
    tared, share = tare_log(read(PULL + zero))
    assert share == pytest.approx(abs(zero) / (3.0 + zero))
    dense = np.linspace(0.0, 1.15, 800)
    expected = np.where(dense < 0.5, 0.0, 3.0)
    np.testing.assert_allclose(step_through(tared, dense), expected, atol=1e-9)
    again, share = tare_log(tared)
    assert share == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(again["load_torque"], tared["load_torque"], atol=1e-12)


def test_the_zero_of_noisy_readings_is_their_mean():
    noise = 0.01 * np.random.default_rng(1).standard_normal(60)
    zero = find_zero(*build_load_array(ROWS, PULL + 0.04 + noise, 0.05))
    assert zero == pytest.approx(0.04, abs=0.006)


@pytest.mark.parametrize("load", [PULL, PULL + 0.4, np.full(60, 2.0), 3.0 - PULL])
def test_a_load_that_is_there_from_the_start_stays(load):
    log = read(load)
    xr.testing.assert_allclose(tare_log(log)[0], log)


def test_a_model_file_states_it():
    log = read(PULL + 0.02, PULL)
    mended = mend_recordings(log, MeasurementEntry(load_tared=True))
    xr.testing.assert_identical(mended, tare_log(log)[0])
    assert not mended.equals(log)
