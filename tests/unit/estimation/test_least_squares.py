"""The paper's two stages: exact without noise, and not led astray by gross errors."""

import numpy as np

from softfinger.estimation import fit_least_squares

RULE = {"outlier_rule": "scaled_mad", "outlier_cutoff": 3.0}
TIME = np.arange(500) / 30
LOAD = ([0.0, 4.0, 4.0, 8.0, 8.0, 12.0, 12.0], [0.02, 0.02, 0.06, 0.06, 0.01, 0.01, 0.05])


def spoil(angles, share, size, rng):
    """Move frames by `size` sd of the noise, 0.003 rad, either way."""
    angle = angles["joint_angle"].copy()
    hit = rng.random(angle.shape) < share / angle.sizes["joint"]
    return angles.assign(joint_angle=angle + 0.003 * size * hit * rng.choice([-1, 1], angle.shape))


def test_estimates_are_exact_without_noise(make_campaign, rng):
    angles, truth, _ = make_campaign(rng, time=TIME, load=LOAD, sd=1e-12)
    found = fit_least_squares(angles, RULE)
    for name in ("k_v", "c_v", "c_p", "q_ini"):
        estimate = found["estimate"].sel(parameter=name)
        np.testing.assert_allclose(estimate, truth[name], rtol=1e-4, atol=1e-6)


def test_gross_errors_hardly_move_the_estimates(make_campaign, rng):
    angles, _, _ = make_campaign(rng, time=TIME, load=LOAD, rho=0.0)
    spoilt = spoil(angles, 0.02, 30.0, rng)
    clean, found = (fit_least_squares(some, RULE) for some in (angles, spoilt))
    moved = (found["estimate"] - clean["estimate"]) / clean["estimate_sd"]
    assert np.abs(moved).median() < 0.2
    np.testing.assert_allclose(found["residual_rms"], clean["residual_rms"], rtol=0.1)


def test_a_flow_against_the_load_is_an_estimate_and_no_end(make_campaign, rng):
    angles, _, _ = make_campaign(rng, time=TIME, load=LOAD)
    angles = angles.assign(joint_angle=angles["joint_angle"] - 0.03 * angles["time"])
    found = fit_least_squares(angles, RULE)
    flow = found.sel(parameter="c_p")
    assert (flow["estimate"] < 0.0).any()
    assert not flow["kept"].values[flow["estimate"].values < 0.0].any()
    assert (found["residual_rms"] < 0.05).all()
