"""A model file sets right the recordings that it was fitted to, and no other ones."""

import numpy as np
import pytest
import xarray as xr

from softfinger.faults import Fault
from softfinger.stages.modelled import read_modelled

TEXT = """\
version: 1
joint: three_element
torque: constant_arm
effects: []
fitted_to: {campaign: a rig, sha256: %s}
measurement: {clock_rate: 0.01, disturbances: {drift: 0.5}}
""" % ("ab" * 32)


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "model.yaml"
    path.write_text(TEXT)
    return path


@pytest.fixture
def recorded():
    return xr.Dataset({"time": (("trial", "frame"), np.array([[0.0, 1.0, 2.0]]))})


def test_its_own_recordings_are_set_right(recorded, model):
    known = read_modelled(recorded, "ab" * 32, model)
    np.testing.assert_allclose(known.angles["time"].values, [[0.0, 1.01, 2.02]])
    assert known.content.measurement.disturbances == {"drift": 0.5}
    assert not known.priors


def test_other_recordings_stay_as_they_are(recorded, model):
    known = read_modelled(recorded, "cd" * 32, model)
    assert known.angles is recorded
    assert known.content.measurement is None
    assert known.priors


def test_without_a_file_there_is_the_base_model(recorded):
    assert read_modelled(recorded, "ab" * 32, None) == (recorded, None, True)


def test_a_measurement_of_other_recordings_names_the_file(recorded, model):
    model.write_text(TEXT.replace("clock_rate: 0.01", "step_shares: {a: [0.5]}"))
    load = xr.DataArray([[0.0, 1.0]], dims=("trial", "knot"))
    still = recorded.assign_coords(trial=["a"]).assign(load_time=load, load_torque=0.0 * load)
    with pytest.raises(Fault) as refused:
        read_modelled(still, "ab" * 32, model)
    assert str(refused.value).startswith(
        f"{model}: measurement.step_shares.a: 1 listed, expected at most 0,"
    )
