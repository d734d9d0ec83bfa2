import numpy as np
import pytest
import xarray as xr

from softfinger.virtual_rig.config import read_config


@pytest.fixture
def config() -> dict:
    """A rig of 5 trials and 7 frames, its links all of different length."""
    return {
        "n_trials": 5,
        "level": "video",
        "duration_s": 0.7,
        "fps": 10.0,
        "load_time_s": [0.0, 0.3, 0.3, 0.7],
        "load_tension_n": [8.0, 8.0, 2.0, 3.0],
        "wire_geometry": "constant_arm",
        "link_length_m": [0.025, 0.030, 0.020],
        "link_mass_kg": [0.005, 0.006, 0.004],
        "joint_length_m": 0.008,
        "wire_offset_m": 0.005,
        "trial_interval_s": 120.0,
        "metres_per_pixel": 0.000235,
        "marker_diameter_m": 0.004,
        "marker_contrast_grey": 130.0,
        "blur_px": 0.6,
        "light_unevenness": 0.25,
        "camera_noise_grey": 3.0,
        "video_quality": 90,
        "angle_noise_sd_rad": 0.003,
        "angle_noise_autocorrelation": 0.3,
    }


@pytest.fixture
def rig(config):
    return read_config(config)


@pytest.fixture
def truth(config) -> xr.Dataset:
    """Smooth made-up angles of 5 trials, so that filming is tested without the dynamics."""
    frame = np.arange(7)
    angle = (
        0.1
        + 0.03 * np.arange(5)[:, None, None]
        + np.array([0.06, 0.05, 0.04])[None, :, None] * frame
    )
    return xr.Dataset(
        {
            "joint_angle": (("trial", "joint", "frame"), angle),
            "time": ("frame", frame / config["fps"]),
            "load_time": ("knot", config["load_time_s"]),
            "load_tension": ("knot", config["load_tension_n"]),
        },
        coords={"trial": [f"trial_{i:03d}" for i in range(1, 6)], "joint": [1, 2, 3]},
    )
