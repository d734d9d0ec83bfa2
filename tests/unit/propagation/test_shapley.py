import numpy as np
import pytest

from softfinger.propagation.shapley import compute_shapley, draw_correlations_array


@pytest.fixture
def shapley(angles, posterior, config):
    return compute_shapley(angles, posterior, config, np.random.default_rng(3))


def test_sizes(shapley):
    assert dict(shapley.sizes) == {
        "joint": 2, "time": 13, "parameter": 4, "other_parameter": 4, "quantile": 3,
    }  # fmt: skip


def test_effects_are_shares(shapley):
    np.testing.assert_allclose(shapley["shapley"].sum("parameter"), 1.0, rtol=1e-12)
    assert (shapley["shapley_quantile"] >= 0).all()
    assert (shapley["shapley_quantile"].diff("quantile") >= 0).all()
    assert shapley["shapley"].sel(time=0.0, parameter="q_ini").min() > 0.3


def test_correlation_is_found_among_the_trials_and_stays_wide_with_seven(shapley):
    found = shapley["correlation_quantile"].sel(parameter="k_v", other_parameter="c_v")
    assert found.sel(quantile=0.5, joint=1) > 0.5
    other = found.sel(joint=2)
    assert other.sel(quantile=0.95) - other.sel(quantile=0.05) > 0.3
    itself = shapley["correlation"].sel(parameter="c_p", other_parameter="c_p")
    np.testing.assert_allclose(itself, 1.0, rtol=1e-12)


def test_fitted_correlations_are_taken_as_they_are(angles, posterior, config):
    group = posterior["posterior"].to_dataset()
    matrix = np.zeros((group.sizes["chain"], group.sizes["draw"], 8, 8)) + np.eye(8)
    matrix[..., 4, 6] = matrix[..., 6, 4] = 0.5  # log k_v with log c_p at the second joint
    fitted = posterior.copy()
    fitted["posterior"] = group.assign(
        parameter_correlation=(("chain", "draw", "own", "other_own"), matrix)
    )
    found = compute_shapley(angles, fitted, config, np.random.default_rng(3))
    expected = np.broadcast_to(np.eye(4), (2, 4, 4)).copy()
    expected[1, 0, 2] = expected[1, 2, 0] = 0.5
    np.testing.assert_allclose(found["correlation"], expected)
    assert "of the fitted population" in found.attrs["definition"]


def test_many_trials_show_their_correlation():
    rng = np.random.default_rng(2)
    z = rng.standard_normal((5, 2000, 2, 3))
    z[..., 1] = 0.6 * z[..., 0] + 0.8 * z[..., 1]
    drawn = draw_correlations_array(z, rng)
    assert drawn.shape == (5, 2, 3, 3)
    expected = [[1.0, 0.6, 0.0], [0.6, 1.0, 0.0], [0.0, 0.0, 1.0]]
    np.testing.assert_allclose(drawn.mean(axis=(0, 1)), expected, atol=0.03)


def test_without_a_trial_every_correlation_is_as_probable():
    drawn = draw_correlations_array(np.empty((600, 0, 2, 4)), np.random.default_rng(2))[..., 0, 1]
    np.testing.assert_allclose(np.quantile(drawn, [0.1, 0.5, 0.9]), [-0.8, 0.0, 0.8], atol=0.08)
