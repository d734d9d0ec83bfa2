"""Coverage of the bands over many small campaigns whose truth is known.

Each trial's parameters are known exactly, so that the posterior of the hyperparameters is conjugate
and drawn without a sampler. Bands of the posterior must then cover new trials as often as they say,
also when scored on the trials that made them; the two-stage estimate, which takes its estimate for
the truth, must fall short with few trials.
"""

import numpy as np
import pytest
import xarray as xr

from softfinger.mechanics import PARAMETERS
from softfinger.mechanics.three_element import compute_joint_angle_array
from softfinger.propagation import compute_bands

MU = np.array([-2.4441, -3.6635, 2.8538, 0.02])
SIGMA = np.array([0.1973, 0.5232, 0.7011, 0.01])
NOISE_SD = 0.001
N_TRIAL, N_FRAME, N_DRAW = 6, 40, 400
CONFIG = {
    "draws": N_DRAW,
    "sampled_draws": 8,
    "draw_samples": 64,
    "band_samples": 2048,
    "band_times": 40,
    "sobol_time_step_s": 0.5,
    "running_times_s": [1.0],
    "density_times_s": [1.0],
    "density_angles": 64,
    "c_p_truncation_sd": None,
}


def build_campaign(rng):
    eta = MU + SIGMA * rng.standard_normal((N_TRIAL, 1, 4))
    parameter = eta.copy()
    parameter[..., :3] = np.exp(parameter[..., :3])
    time = np.linspace(0.0, 10.0, N_FRAME)
    angle = compute_joint_angle_array(*np.moveaxis(parameter, -1, 0), time, [0.0], [0.04])
    angle = angle + NOISE_SD * rng.standard_normal(angle.shape)
    coords = {"trial": [f"trial_{i}" for i in range(N_TRIAL)], "joint": [1]}
    angles = xr.Dataset(
        {
            "time": (("trial", "frame"), np.tile(time, (N_TRIAL, 1))),
            "joint_angle": (("trial", "joint", "frame"), angle),
            "angle_flag": (("trial", "joint", "frame"), np.zeros(angle.shape, np.uint8)),
            "load_time": (("trial", "knot"), np.tile([0.0, 10.0], (N_TRIAL, 1))),
            "load_torque": (("trial", "knot"), np.full((N_TRIAL, 2), 0.04)),
        },
        coords,
    )
    dims = ("trial", "joint", "parameter")
    least_squares = xr.Dataset(
        {
            "estimate": (dims, parameter),
            "kept": (dims, np.ones(parameter.shape, bool)),
            "population_mean": (dims[1:], eta.mean(axis=0)),
            "population_sd": (dims[1:], eta.std(axis=0, ddof=1)),
            "residual_rms": (dims[:2], np.full((N_TRIAL, 1), NOISE_SD)),
        },
        {**coords, "parameter": list(PARAMETERS)},
    )
    return angles, least_squares, draw_posterior(eta, coords, rng)


def draw_posterior(eta, coords, rng):
    """Flat in μ and log σ: σ² is scaled inverse χ², μ given σ normal."""
    spread = eta.var(axis=0, ddof=1) * (N_TRIAL - 1)
    sigma = np.sqrt(spread / rng.chisquare(N_TRIAL - 1, (N_DRAW, 1, 4)))
    mu = eta.mean(axis=0) + sigma / np.sqrt(N_TRIAL) * rng.standard_normal((N_DRAW, 1, 4))
    dims = ("chain", "draw", "joint")
    data = {"noise_sd": (dims, np.full((1, N_DRAW, 1), NOISE_SD))}
    data["noise_autocorrelation"] = (dims, np.zeros((1, N_DRAW, 1)))
    data["noise_white"] = (dims, np.zeros((1, N_DRAW, 1)))
    for place, name in enumerate(("log_k_v", "log_c_v", "log_c_p", "q_ini")):
        data[f"mu_{name}"] = (dims, mu[None, ..., place])
        data[f"sigma_{name}"] = (dims, sigma[None, ..., place])
        value = np.broadcast_to(eta[..., place], (1, N_DRAW, N_TRIAL, 1))
        data[name] = (("chain", "draw", "trial", "joint"), value)
    return xr.DataTree.from_dict({"posterior": xr.Dataset(data, coords)})


@pytest.mark.slow
def test_bands_cover_the_trials_that_they_are_left_without():
    rng = np.random.default_rng(12)
    coverage = []
    for _ in range(150):
        bands = compute_bands(*build_campaign(rng), CONFIG, rng)
        coverage.append(bands["coverage"].sel(window="whole").isel(protocol=0, joint=0))
    coverage = xr.concat(coverage, "campaign")
    mean = coverage.mean("campaign")
    error = coverage.std("campaign") / np.sqrt(coverage.sizes["campaign"])
    of_posterior = {"estimate": "posterior"}
    difference = mean.sel(of_posterior) - mean["ci_prob"]
    assert (np.abs(difference) < 3 * error.sel(of_posterior) + 0.01).all()
    assert mean.sel(estimate="two_stage", ci_prob=0.9) < 0.87
