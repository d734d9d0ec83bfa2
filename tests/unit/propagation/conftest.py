"""A small synthetic campaign with every dim of another size, and fits to it."""

import numpy as np
import pytest
import xarray as xr

from softfinger.mechanics import PARAMETERS
from softfinger.mechanics.three_element import compute_joint_angle_array

MU = np.array([[-2.4441, -3.6635, 2.8538, 0.02], [-1.88, -3.8777, 3.3, 0.03]])
SIGMA = np.array([[0.1973, 0.5232, 0.7011, 0.01], [0.3957, 0.8223, 0.9, 0.02]])
NOISE_SD = 0.003
CONFIG = {
    "draws": 11,
    "sampled_draws": 5,
    "draw_samples": 256,
    "band_samples": 512,
    "band_times": 61,
    "sobol_time_step_s": 0.5,
    "running_times_s": [1.0, 5.0, 30.0],
    "density_times_s": [0.0, 0.1, 1.0, 6.0],
    "density_angles": 64,
    "c_p_truncation_sd": None,
}


@pytest.fixture
def config():
    return dict(CONFIG)


@pytest.fixture
def angles():
    """7 trials, 2 joints, 91 frames in 6 s; trials 0 to 4 at 0.04 N m, 5 and 6 at 0.02 N m."""
    rng = np.random.default_rng(5)
    n_trial, n_joint, n_frame = 7, 2, 91
    time = np.tile(np.linspace(0.0, 6.0, n_frame), (n_trial, 1))
    torque = np.where(np.arange(n_trial) < 5, 0.04, 0.02)
    load_time = np.tile([0.0, 6.0, 6.0], (n_trial, 1))
    load_torque = np.tile(torque[:, None], (1, 3))
    parameter = MU + SIGMA * rng.standard_normal((n_trial, n_joint, 4))
    parameter[..., :3] = np.exp(parameter[..., :3])
    angle = compute_joint_angle_array(
        *np.moveaxis(parameter, -1, 0), time[:, None], load_time[:, None], load_torque[:, None]
    )
    angle = angle + NOISE_SD * rng.standard_normal(angle.shape)
    flag = np.zeros(angle.shape, np.uint8)
    angle[1, 1, 40:43] = np.nan
    flag[1, 1, 40:43] = 1
    time[6, 80:] = np.nan
    angle[6, :, 80:] = np.nan
    return xr.Dataset(
        {
            "time": (("trial", "frame"), time),
            "joint_angle": (("trial", "joint", "frame"), angle),
            "angle_flag": (("trial", "joint", "frame"), flag),
            "load_time": (("trial", "knot"), load_time),
            "load_torque": (("trial", "knot"), load_torque),
        },
        coords={"trial": [f"trial_{i:03d}" for i in range(n_trial)], "joint": [1, 2]},
    )


@pytest.fixture
def least_squares(angles):
    """Estimates whose logs have the mean MU and the sd SIGMA, nothing dropped."""
    z = np.random.default_rng(7).standard_normal((7, 2, 4))
    z = (z - z.mean(axis=0)) / z.std(axis=0, ddof=1)
    estimate = MU + SIGMA * z
    estimate[..., :3] = np.exp(estimate[..., :3])
    dims = ("trial", "joint", "parameter")
    return xr.Dataset(
        {
            "estimate": (dims, estimate),
            "kept": (dims, np.ones(estimate.shape, bool)),
            "population_mean": (dims[1:], MU.copy()),
            "population_sd": (dims[1:], SIGMA.copy()),
            "residual_rms": (("trial", "joint"), np.full((7, 2), NOISE_SD)),
        },
        coords={"trial": angles["trial"], "joint": [1, 2], "parameter": list(PARAMETERS)},
    )


@pytest.fixture
def posterior():
    """3 chains of 17 draws about the two-stage estimate; k_v and c_v of joint 1 go together."""
    rng = np.random.default_rng(6)
    names = ("log_k_v", "log_c_v", "log_c_p", "q_ini")
    dims = ("chain", "draw", "joint")
    shape = (3, 17, 2)
    data = {"noise_sd": (dims, np.full(shape, NOISE_SD))}
    data["noise_autocorrelation"] = (dims, np.full(shape, 0.3))
    data["noise_white"] = (dims, np.zeros(shape))
    for place, name in enumerate(names):
        jitter = 0.1 * SIGMA[:, place] * rng.standard_normal(shape)
        data[f"mu_{name}"] = (dims, MU[:, place] + jitter)
        data[f"sigma_{name}"] = (dims, SIGMA[:, place] * np.exp(0.1 * rng.standard_normal(shape)))
    z = rng.standard_normal((7, 2, 4))
    z[:, 0, 1] = z[:, 0, 0] + 0.1 * z[:, 0, 1]
    trial = MU + SIGMA * z
    for place, name in enumerate(names):
        value = np.broadcast_to(trial[..., place], (3, 17, 7, 2))
        data[name] = (("chain", "draw", "trial", "joint"), value.copy())
    coords = {"chain": range(3), "draw": range(17), "joint": [1, 2]}
    coords["trial"] = [f"trial_{i:03d}" for i in range(7)]
    dataset = xr.Dataset(data, coords=coords)
    return xr.DataTree.from_dict({"posterior": dataset})
