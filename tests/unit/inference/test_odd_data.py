"""Few trials, one to several joints, joints that barely move, gaps and uneven clocks."""

import numpy as np
import pytest

from softfinger.inference.layout import describe_limits
from softfinger.inference.posterior import prepare_fit, sample_posterior

SMALL = {
    "chains": 2,
    "tune": 250,
    "draws": 200,
    "cores": 1,
    "target_accept": 0.8,
    "max_depth": 10,
    "sampler": "nuts",
    "covariance": "independent",
}


def fit(angles, seed=1):
    prepared = prepare_fit(angles)
    return prepared, sample_posterior(prepared, SMALL, np.random.default_rng(seed))[0]


def spread(posterior, name):
    return float(posterior[name].isel(joint=0).std())


def test_one_trial_is_no_population(draw):
    angles, _ = draw(1, 2, 1)
    prepared, posterior = fit(angles)
    assert "One trial shows no spread" in describe_limits(prepared.recorded.problem.trials.present)
    log_sigma = np.log(posterior["sigma_log_k_v"])
    assert float(log_sigma.std()) == pytest.approx(prepared.given.prior.sigma_log_sd[0], rel=0.3)
    assert spread(posterior, "mu_log_k_v") > 3 * spread(posterior, "log_k_v")


def test_two_trials_hardly_tell_the_spread(draw):
    angles, _ = draw(2, 1, 2)
    prepared, posterior = fit(angles)
    assert "2 trials hardly show" in describe_limits(prepared.recorded.problem.trials.present)
    assert float(np.log(posterior["sigma_log_c_v"]).std()) > 0.3


def test_flow_that_is_not_seen_stays_unknown(draw):
    angles, _ = draw(6, 1, 3)
    early = angles.isel(frame=slice(0, 9))  # 1.2 s: the flow is 0.002 rad, the noise as large
    _, known = fit(angles)
    _, unknown = fit(early)
    assert spread(known, "log_c_p") < 0.7
    assert spread(unknown, "mu_log_c_p") > 2 * spread(known, "mu_log_c_p")


def test_a_joint_that_does_not_move_has_a_bound_only(draw):
    angles, _ = draw(5, 2, 4)
    still = angles["joint_angle"].copy()
    noise = np.random.default_rng(4).normal(0, 0.002, still.isel(joint=1).shape)
    still[:, 1] = noise
    _, posterior = fit(angles.assign(joint_angle=still))
    width = posterior["mu_log_k_v"].std(("chain", "draw")).values
    assert width[1] > 2 * width[0]
    assert float(posterior["mu_log_k_v"].mean(("chain", "draw"))[1]) > 0  # stiffer than it was


@pytest.mark.parametrize("joints", [1, 3])
def test_any_number_of_joints(draw, joints):
    angles, _ = draw(3, joints, 5)
    _, posterior = fit(angles)
    assert posterior["mu_q_ini"].sizes["joint"] == joints
    assert np.isfinite(posterior.to_array()).all()


def test_gaps_and_uneven_clocks_agree_with_the_whole(draw):
    uneven = np.sort(np.random.default_rng(6).uniform(0, 20, 150))
    angles, own = draw(5, 1, 6, uneven)
    holes = angles["joint_angle"].copy()
    holes[:, :, 40:60] = np.nan
    _, posterior = fit(angles.assign(joint_angle=holes))
    true = np.log(own["k_v"]).values
    draws = posterior["log_k_v"].values.reshape(-1, 5, 1)
    z = (draws.mean(axis=0) - true) / draws.std(axis=0)
    assert np.abs(z).max() < 3.5
    assert draws.std(axis=0).max() < 0.1
