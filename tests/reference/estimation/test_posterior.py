"""The posterior against a long run of NUTS on a model of all frames, written anew in PyMC."""

import numpy as np
import pymc as pm
import pytensor.tensor as pt
import pytest

from softfinger.inference.posterior import prepare_fit, sample_posterior
from softfinger.inference.simulate import (
    build_recording,
    describe_noise,
    draw_angles,
    draw_parameters,
)

TORQUE, TRIALS = 0.04, 6
MEAN, SPREAD = np.array([-2.3, -3.6, 3.0, 0.02]), np.array([0.3, 0.5, 0.6, 0.01])
NAMES = ("log_k_v", "log_c_v", "log_c_p", "q_ini")


def sample_plainly(angles, prior, draws):
    """Non-centred, every frame by itself: the first stationary, the others given the one before."""
    time, y = angles["time"].values[0], angles["joint_angle"].values[:, 0]
    with pm.Model():
        mu = pm.Normal("mu", prior.mu_mean, prior.mu_sd)
        sigma = pm.LogNormal("sigma", np.log(prior.sigma_median), prior.sigma_log_sd)
        eta = mu + sigma * pm.Normal("z", shape=(TRIALS, 4))
        sd = pm.LogNormal("noise_sd", np.log(0.01), 0.5)
        rho = pm.Uniform("rho")
        k_v, c_v, c_p = (pt.exp(eta[:, k, None]) for k in range(3))
        motion = TORQUE / k_v * (1 - pt.exp(-k_v / c_v * time)) + TORQUE / c_p * time
        left = y - motion - eta[:, 3:]
        pm.Potential("first", pm.logp(pm.Normal.dist(0, sd), left[:, 0]).sum())
        step = pm.Normal.dist(rho * left[:, :-1], sd * pt.sqrt(1 - rho**2))
        pm.Potential("rest", pm.logp(step, left[:, 1:]).sum())
        return pm.sample(
            draws, tune=1500, chains=4, cores=1, random_seed=1, nuts_sampler="nutpie",
            nuts={"target_accept": 0.95, "maxdepth": 12}, progressbar=False,
        )["posterior"]  # fmt: skip


@pytest.mark.slow
def test_posterior_is_that_of_a_long_run_on_all_frames():
    rng = np.random.default_rng(8)
    time = np.arange(60) / 2.0
    names = [f"trial_{i}" for i in range(TRIALS)]
    recording = build_recording(time, [0.0, 30.0], [TORQUE] * 2, 1, names)
    noise = describe_noise(np.array([0.01]), np.array([0.3]))
    angles = draw_angles(recording, draw_parameters(MEAN, SPREAD, recording, rng), noise, rng)
    prepared = prepare_fit(angles)
    config = {
        "chains": 4,
        "tune": 1000,
        "draws": 5000,
        "cores": 1,
        "target_accept": 0.8,
        "max_depth": 10,
        "sampler": "nuts",
        "covariance": "independent",
    }
    ours, _ = sample_posterior(prepared, config, rng)
    rival = sample_plainly(angles, prepared.given.prior, 5000)
    for k, name in enumerate(NAMES):
        for level in ("mu", "sigma"):
            mine = ours[f"{level}_{name}"].values.ravel()
            theirs = rival[level].values[..., k].ravel()
            if level == "sigma":
                mine, theirs = np.log(mine), np.log(theirs)
            assert abs(mine.mean() - theirs.mean()) < 0.1 * theirs.std(), (level, name)
            assert mine.std() == pytest.approx(theirs.std(), rel=0.05), (level, name)
