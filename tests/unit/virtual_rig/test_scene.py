import numpy as np
import xarray as xr

from softfinger.virtual_rig.config import read_config
from softfinger.virtual_rig.scene import (
    FIRST_JOINT_PX,
    build_marker_places,
    compute_base_capsule,
    compute_capsules,
    compute_marker_position,
)


def test_marks_of_a_bent_finger_are_where_the_hand_puts_them(config):
    """A staircase: up, right, up; a pixel is a millimetre."""
    rig = read_config(
        config | {"link_length_m": [0.025, 0.05, 0.1], "metres_per_pixel": 0.001, "n_trials": 1}
    )
    angle = xr.DataArray([[np.pi / 2, -np.pi / 2, np.pi / 2]], dims=("frame", "joint"))
    position = compute_marker_position(angle, rig).isel(frame=0)
    to_the_right_and_up_mm = {
        "base_1": (-18, 0),
        "base_2": (-6, 0),
        "link_1_1": (0, 6),
        "link_1_2": (0, 19),
        "link_2_1": (12, 25),
        "link_2_2": (38, 25),
        "link_3_1": (50, 25 + 24),
        "link_3_2": (50, 25 + 76),
    }
    assert list(position.marker.values) == list(to_the_right_and_up_mm)
    for name, (right, up) in to_the_right_and_up_mm.items():
        expected = [FIRST_JOINT_PX[0] + right, FIRST_JOINT_PX[1] - up]
        np.testing.assert_allclose(position.sel(marker=name), expected, atol=1e-9)


def test_marker_position_keeps_the_dims_that_it_is_given(truth, rig):
    position = compute_marker_position(truth.joint_angle, rig)
    assert dict(position.sizes) == {"trial": 5, "frame": 7, "marker": 8, "axis": 2}
    assert list(position.axis.values) == ["x", "y"]


def test_marks_of_the_default_finger_are_those_of_the_format(config):
    places = build_marker_places(read_config(config | {"link_length_m": [0.025] * 3}))
    assert places == {"base": [-0.018, -0.006]} | {f"link_{i}": [0.006, 0.019] for i in (1, 2, 3)}


def test_the_body_lies_under_every_mark_with_room_to_spare(rig):
    """Marks on the edge of the body would not be dark discs on light ground."""
    angle = xr.DataArray([[0.02, 0.9, -0.4], [0.5, 1.5, 1.1]], dims=("frame", "joint"))
    position = compute_marker_position(angle, rig).values
    radius = rig.marker_diameter_m / rig.metres_per_pixel / 2
    for frame, capsules in enumerate(compute_capsules(angle.values, rig)):
        parts = np.concatenate([compute_base_capsule(rig), capsules])
        for mark in position[frame]:
            start, end, half_thickness = parts[:, :2], parts[:, 2:4], parts[:, 4]
            axis = end - start
            share = ((mark - start) * axis).sum(1) / (axis**2).sum(1)
            foot = start + np.clip(share, 0, 1)[:, None] * axis
            depth = half_thickness - np.hypot(*(mark - foot).T)
            assert depth.max() > radius + 3.5
