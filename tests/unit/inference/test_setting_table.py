"""What a fit saves of its campaign is what it knew."""

from dataclasses import fields

import numpy as np
import pytest
import xarray as xr

from softfinger.faults import Fault
from softfinger.inference.setting_table import read_setting, tabulate_setting
from softfinger.mechanics.effects.effect import Setting
from softfinger.mechanics.forward.simulate import describe_finger, describe_unknown_finger
from softfinger.mechanics.geometry import FingerGeometry

TRIALS = ["first", "second", "third"]
SETTING = Setting(
    trials=3,
    joints=2,
    interval=1 / 30,
    duration=12.0,
    torque=0.04,
    reversals=True,
    levels=True,
    rests=False,
    load_known=True,
    tension=False,
    stiffness=np.array([0.1, 0.2]),
    reach=np.array([0.5, 0.4]),
    number=np.array([0.0, 1.0, 4.0]),
    memory=np.arange(6.0).reshape(3, 2),
    largest_torque=np.array([0.04, 0.04, 0.02]),
    rest_time=np.array([np.inf, 100.0, np.nan]),
    covariates={"temperature_c": np.array([20.0, 21.0, 25.0])},
    geometry=True,
    masses=True,
    step_gap=0.01,
)
GEOMETRY = FingerGeometry.uniform(np.array([0.02, 0.03]), np.array([0.005, 0.004]), 0.008, 0.005)


@pytest.mark.parametrize("finger", [describe_finger(GEOMETRY), describe_unknown_finger(2)])
def test_a_setting_comes_back_from_the_file(tmp_path, finger):
    table = tabulate_setting(SETTING, finger, TRIALS)
    table.to_netcdf(tmp_path / "table.nc", engine="h5netcdf")
    loaded = xr.load_dataset(tmp_path / "table.nc", engine="h5netcdf")
    setting, same, trial = read_setting(loaded)
    assert trial.values.tolist() == TRIALS
    for field in fields(Setting):
        if field.name != "covariates":
            before, after = getattr(SETTING, field.name), getattr(setting, field.name)
            assert type(after) is type(before)
            np.testing.assert_array_equal(after, before)
    np.testing.assert_array_equal(setting.covariates["temperature_c"], [20.0, 21.0, 25.0])
    for before, after in zip(finger, same, strict=True):
        np.testing.assert_array_equal(after, before)


def test_without_covariates_there_are_none(tmp_path):
    setting = Setting(**{**vars(SETTING), "covariates": {}})
    table = tabulate_setting(setting, describe_unknown_finger(2), TRIALS)
    table.to_netcdf(tmp_path / "table.nc", engine="h5netcdf")
    loaded = xr.load_dataset(tmp_path / "table.nc", engine="h5netcdf")
    assert read_setting(loaded)[0].covariates == {}


def test_a_fit_that_saved_nothing_is_named():
    with pytest.raises(Fault, match="no setting_interval"):
        read_setting(xr.Dataset())
