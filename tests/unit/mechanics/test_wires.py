import numpy as np
import pytest
import xarray as xr

from softfinger.mechanics.geometry import FingerGeometry
from softfinger.mechanics.wires import (
    compute_moment_arm_array,
    compute_wire_excursion,
    compute_wire_jacobian,
    moment_arm_slope,
)

GEOMETRY = FingerGeometry.uniform([0.025] * 3, [0.005] * 3, 0.008, 0.005)


@pytest.fixture
def angle():
    return xr.DataArray(np.random.default_rng(2).normal(size=(5, 3)), dims=("trial", "joint"))


def test_excursion_is_the_papers_wire_length(angle):
    reach = np.hypot(0.004, 0.005)
    tilt = np.arctan(2 * 0.005 / 0.008)
    for wire, sign in (("flexion", 1), ("extension", -1)):
        length = 0.008 - 2 * reach * np.cos(angle / 2 + sign * tilt)
        straight = 0.008 - 2 * reach * np.cos(tilt)
        expected = (length - straight).sum("joint")
        found = compute_wire_excursion(angle, GEOMETRY).sel(wire=wire)
        np.testing.assert_allclose(found, expected, atol=1e-16)


def test_jacobian_is_the_derivative_of_the_excursion(angle):
    jacobian = compute_wire_jacobian(angle, GEOMETRY)
    assert jacobian.dims == ("wire", "trial", "joint")
    for joint in range(3):
        step = xr.DataArray(1e-5 * np.eye(3)[joint], dims="joint")
        ahead, behind = (compute_wire_excursion(angle + s, GEOMETRY) for s in (step, -step))
        np.testing.assert_allclose(jacobian.isel(joint=joint), (ahead - behind) / 2e-5, atol=1e-12)


def test_arm_of_the_straight_finger_is_the_wire_offset_and_grows_by_a_sixth_at_half_a_radian():
    arm = compute_moment_arm_array([0.0, 0.5], 0.008, 0.005)
    assert arm[0] == 0.005
    np.testing.assert_allclose(arm[1] / arm[0], 1.1668, atol=1e-4)


def test_arm_slope_is_the_limit_of_differences():
    arm = compute_moment_arm_array([0.3 - 1e-5, 0.3 + 1e-5], 0.008, 0.005)
    np.testing.assert_allclose(
        moment_arm_slope(0.3, 0.004, 0.005), np.diff(arm)[0] / 2e-5, rtol=1e-9
    )
