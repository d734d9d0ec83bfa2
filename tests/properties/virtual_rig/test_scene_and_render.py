import numpy as np
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from softfinger.virtual_rig.config import VirtualRigConfig
from softfinger.virtual_rig.example import EXAMPLE_CONFIG
from softfinger.virtual_rig.render import (
    build_canvas,
    build_noise_table,
    draw_finger,
    expose_array,
)
from softfinger.virtual_rig.scene import compute_marker_position

BAR = np.array([[200.0, 250.0, 400.0, 250.0, 60.0]])
angles = arrays(float, (5, 3), elements=st.floats(-1.5, 1.5))


@settings(deadline=None, max_examples=50)
@given(angles)
def test_angles_come_back_from_the_marks(joint_angle):
    """Directions base to tip, by the marks' differences; rows count downwards."""
    rig = VirtualRigConfig(**EXAMPLE_CONFIG)
    marks = compute_marker_position(xr.DataArray(joint_angle, dims=("frame", "joint")), rig)
    pairs = marks.values.reshape(5, 4, 2, 2)
    along = pairs[:, :, 1] - pairs[:, :, 0]
    direction = np.arctan2(-along[..., 1], along[..., 0])
    turned = np.diff(direction, axis=1)
    np.testing.assert_allclose(np.sin(turned), np.sin(joint_angle), atol=1e-9)
    np.testing.assert_allclose(np.cos(turned), np.cos(joint_angle), atol=1e-9)
    length = np.hypot(along[..., 0], along[..., 1]) * rig.metres_per_pixel
    np.testing.assert_allclose(length, np.broadcast_to([0.012, 0.013, 0.013, 0.013], (5, 4)))


@settings(deadline=None, max_examples=50)
@given(
    x=st.floats(290, 310),
    y=st.floats(240, 260),
    diameter_m=st.floats(0.0023, 0.0038),
    blur_px=st.floats(0.4, 1.5),
)
def test_the_centroid_of_a_noise_free_disc_is_its_centre(x, y, diameter_m, blur_px):
    """Whatever the sub-pixel phase, the radius (5 to 8 px) and the blur."""
    change = {"marker_diameter_m": diameter_m, "blur_px": blur_px, "light_unevenness": 0.0}
    canvas = build_canvas(VirtualRigConfig(**(EXAMPLE_CONFIG | change)), BAR)
    picture = canvas.still.copy()
    draw_finger(picture, canvas, np.empty((0, 5)), np.array([[x, y]]))
    frame = np.empty(picture.shape, np.uint8)
    expose_array(picture, build_noise_table(0.0), np.uint64(0), frame)
    row, column = np.mgrid[:480, :640]
    for seen, close in ((picture.astype(float), 0.001), (frame.astype(float), 0.01)):
        dark = np.where(np.hypot(column - x, row - y) < 30, 205.0 - seen, 0.0)
        centre = np.array([(dark * column).sum(), (dark * row).sum()]) / dark.sum()
        np.testing.assert_allclose(centre, [x, y], atol=close)
