"""What must not depend on how a campaign is written down."""

import numpy as np
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from softfinger.summary.residuals import compute_residuals


def make(seed, n_trial=4, n_joint=2, n_frame=60):
    rng = np.random.default_rng(seed)
    dims, shape = ("trial", "joint", "frame"), (n_trial, n_joint, n_frame)
    angles = xr.Dataset(
        {
            "time": (("trial", "frame"), np.tile(np.arange(n_frame) * 0.05, (n_trial, 1))),
            "joint_angle": (dims, 0.4 + 0.01 * rng.standard_normal(shape)),
            "angle_flag": (dims, (rng.random(shape) < 0.05).astype(np.uint8)),
            "load_time": (("trial", "knot"), np.tile([0.0, 3.0], (n_trial, 1))),
            "load_torque": (("trial", "knot"), np.full((n_trial, 2), 0.04)),
        },
        coords={"trial": [f"t{i}" for i in range(n_trial)], "joint": np.arange(n_joint) + 1},
        attrs={"source": "measured"},
    )
    return angles, (angles["joint_angle"] - 0.4).where(angles["angle_flag"] == 0)


@settings(deadline=None, max_examples=15)
@given(seed=st.integers(0, 2**16), order=st.permutations(range(4)))
def test_the_order_of_trials_does_not_matter(seed, order):
    angles, residual = make(seed)
    first = compute_residuals(angles, residual)
    second = compute_residuals(angles.isel(trial=order), residual.isel(trial=order))
    for name in ("mean_residual", "residual_se", "residual_power"):
        np.testing.assert_allclose(first[name], second[name], rtol=1e-9, atol=1e-15)


@settings(deadline=None, max_examples=15)
@given(seed=st.integers(0, 2**16), shift=st.floats(-0.1, 0.1))
def test_a_shift_shows_in_the_mean_and_nowhere_else(seed, shift):
    angles, residual = make(seed)
    first = compute_residuals(angles, residual)
    second = compute_residuals(angles, residual + shift)
    change = second["mean_residual"] - first["mean_residual"]
    np.testing.assert_allclose(change.values[change.notnull()], shift, atol=1e-12)
    assert change.notnull().mean() > 0.9  # a moment that fewer than two trials saw has no mean
    np.testing.assert_allclose(second["residual_se"], first["residual_se"], atol=1e-12)
    np.testing.assert_allclose(second["residual_power"], first["residual_power"], atol=1e-15)
