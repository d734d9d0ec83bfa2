"""A right campaign in memory: seven trials of three joints, a step up and down."""

import numpy as np
import pytest
import xarray as xr

from softfinger.doubts.response import compute_terms

TIME = np.arange(0.0, 8.0, 1 / 30)
LOAD_TIME = np.array([0.0, 1.0, 1.0, 5.0, 5.0, 8.0])
LOAD = 0.04 * np.array([0.0, 0.0, 1.0, 1.0, 0.3, 0.3])
GAIN = np.array([6.0, 9.0, 4.0])


@pytest.fixture
def angles() -> xr.Dataset:
    return build_angles()


def build_angles(trials=7, seed=3):
    rng = np.random.default_rng(seed)
    terms = compute_terms(TIME, LOAD_TIME, LOAD, np.array([0.0, 0.2, 2.0]))
    angle = np.empty((trials, 3, TIME.size))
    for trial in angle:
        own = GAIN[:, None] * np.exp(0.1 * rng.standard_normal((3, 3)))
        error = 0.002 * rng.standard_normal((4, TIME.size)) / np.sqrt(2)
        trial[:] = own @ terms.T + 0.02 * rng.standard_normal((3, 1)) + np.diff(error, axis=0)
    names = [f"t{k}" for k in range(trials)]
    return xr.Dataset(
        {
            "time": (("trial", "frame"), np.tile(TIME, (trials, 1))),
            "joint_angle": (("trial", "joint", "frame"), angle),
            "angle_flag": (("trial", "joint", "frame"), np.zeros(angle.shape, np.uint8)),
            "load_time": (("trial", "knot"), np.tile(LOAD_TIME, (trials, 1))),
            "load_torque": (("trial", "knot"), np.tile(LOAD, (trials, 1))),
            "load_kind": ("trial", np.array(["tension_n"] * trials, dtype=object)),
            "started_at": ("trial", 60.0 * np.arange(trials)),
            "covariate_value": (("trial", "covariate"), 23.0 + 0.1 * rng.random((trials, 1))),
            "link_length": ("joint", np.full(3, 0.025)),
            "link_mass": ("joint", np.full(3, 0.005)),
            "joint_length": ((), 0.008),
            "wire_offset": ((), 0.005),
        },
        coords={
            "trial": names,
            "joint": [1, 2, 3],
            "covariate": np.array(["temperature_c"], dtype=object),
        },
        attrs={"noise_sd_rad": np.nan, "campaign": "a", "source": "synthetic"},
    )
