"""What must not depend on how a campaign is written down."""

import numpy as np
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from softfinger.report.residuals import compute_residuals


def make(seed, n_trial=4, n_joint=2, n_frame=60):
    rng = np.random.default_rng(seed)
    dims, shape = ("trial", "joint", "frame"), (n_trial, n_joint, n_frame)
    own = {"k_v": 0.1, "c_v": 0.03, "c_p": 20.0, "q_ini": 0.02}
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
    parameters = xr.Dataset(
        {name: (("trial", "joint"), np.full((n_trial, n_joint), v)) for name, v in own.items()},
        coords={"trial": angles["trial"], "joint": angles["joint"]},
    )
    return angles, parameters


@settings(deadline=None, max_examples=15)
@given(seed=st.integers(0, 2**16), order=st.permutations(range(4)))
def test_the_order_of_trials_does_not_matter(seed, order):
    angles, parameters = make(seed)
    first = compute_residuals(angles, parameters)
    second = compute_residuals(angles.isel(trial=order), parameters)
    for name in ("mean_residual", "residual_se", "residual_power"):
        np.testing.assert_allclose(first[name], second[name], rtol=1e-9, atol=1e-15)


@settings(deadline=None, max_examples=15)
@given(seed=st.integers(0, 2**16), shift=st.floats(-0.1, 0.1))
def test_a_shift_shows_in_the_mean_and_nowhere_else(seed, shift):
    angles, parameters = make(seed)
    first = compute_residuals(angles, parameters)
    moved = angles.assign(joint_angle=angles["joint_angle"] + shift)
    second = compute_residuals(moved, parameters)
    change = second["mean_residual"] - first["mean_residual"]
    np.testing.assert_allclose(change.values[change.notnull()], shift, atol=1e-12)
    assert change.notnull().mean() > 0.9  # a moment that fewer than two trials saw has no mean
    np.testing.assert_allclose(second["residual_se"], first["residual_se"], atol=1e-12)
    np.testing.assert_allclose(second["residual_power"], first["residual_power"], atol=1e-15)
