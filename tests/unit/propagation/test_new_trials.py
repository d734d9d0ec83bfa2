"""New fingers and their recordings."""

import numpy as np
import pytest
import xarray as xr

from softfinger.inference.motion import move_paper_joint
from softfinger.propagation.config import read_config
from softfinger.propagation.new_trials import (
    Source,
    draw_fingers,
    draw_noise,
    draw_standard_array,
    place_scores_array,
)
from softfinger.propagation.populations import select_posterior

MU, SIGMA = np.array([[-2.4, -3.6, 2.8, 0.02]] * 2), np.array([[0.2, 0.5, 0.7, 0.01]] * 2)


def test_fingers_have_the_populations_moments(posterior, config):
    config = {**config, "band_samples": 4096}
    matrix = np.eye(8)
    matrix[0, 6] = matrix[6, 0] = -0.7  # log k_v of the first joint with log c_p of the second
    group = posterior["posterior"].to_dataset()
    matrix = np.broadcast_to(matrix, (3, 17, 8, 8))
    group["parameter_correlation"] = (("chain", "draw", "own", "other_own"), matrix)
    for k, name in enumerate(("log_k_v", "log_c_v", "log_c_p", "q_ini")):
        group[f"mu_{name}"][:], group[f"sigma_{name}"][:] = MU[:, k], SIGMA[:, k]
    posterior["posterior"] = group
    population = select_posterior(posterior, 16)
    source = Source(population, move_paper_joint, read_config(config), 1)
    draw, own = draw_fingers(source, np.random.default_rng(2))
    assert (np.bincount(draw) == 256).all()
    np.testing.assert_allclose(own.mean(axis=0), MU, atol=5e-3)
    np.testing.assert_allclose(own.std(axis=0), SIGMA, rtol=0.02)
    expected = np.array(matrix[0, 0])
    np.testing.assert_allclose(np.corrcoef(own.reshape(-1, 8).T), expected, atol=0.03)


def test_a_cut_population_stays_inside():
    score = draw_standard_array(1024, 8, np.random.default_rng(4))[0]
    own = (place_scores_array(MU, SIGMA, score, 1.5) - MU) / SIGMA
    assert np.abs(own[..., 2]).max() == pytest.approx(1.5, abs=0.01)
    assert np.abs(own[..., 1]).max() > 2.5


def test_numbers_do_not_follow_their_place():
    """By the order of a Sobol sequence every second number lies in the same half."""
    normal = draw_standard_array(1024, 3, np.random.default_rng(4))[0]
    even = (normal[::2] > 0).mean(axis=0)
    assert (np.abs(even - 0.5) < 0.1).all()


def test_noise_of_recordings_is_correlated_over_time_and_joints_as_fitted():
    shape = (2, 2)
    population = xr.Dataset(
        {
            "noise_sd": (("draw", "joint"), [[0.003, 0.001], [0.006, 0.002]]),
            "noise_autocorrelation": (("draw", "joint"), np.full(shape, 0.8)),
            "noise_white": (("draw", "joint"), np.zeros(shape)),
            "noise_correlation": (
                ("draw", "joint", "other_joint"),
                np.tile([[1.0, 0.5], [0.5, 1.0]], (2, 1, 1)),
            ),
        }
    )
    draw = np.repeat([0, 1], 4000)
    noise = draw_noise(population, draw, np.array([0.0, 1.0, 3.0]), np.random.default_rng(6))
    sd = noise.reshape(2, 4000, 2, 3).std(axis=1)
    np.testing.assert_allclose(sd, population["noise_sd"].values[..., None] * np.ones(3), rtol=0.05)
    first = noise[:4000, 0]
    found = np.corrcoef(first.T)
    np.testing.assert_allclose([found[0, 1], found[1, 2]], [0.8, 0.64], atol=0.03)
    beside = np.corrcoef(noise[:4000, 0, 2], noise[:4000, 1, 2])[0, 1]
    assert beside == pytest.approx(0.5, abs=0.04)
