import numpy as np
import pytest
from scipy.stats import norm

from softfinger.propagation.densities import compute_densities


@pytest.fixture
def densities(angles, least_squares, posterior, config):
    return compute_densities(angles, least_squares, posterior, config, np.random.default_rng(3))


def test_sizes(densities):
    assert dict(densities.sizes) == {
        "estimate": 2, "joint": 2, "time": 4, "angle": 64, "bound": 2,
    }  # fmt: skip
    assert densities["time"].values.tolist() == [0.0, 0.1, 1.0, 6.0]


def test_at_rest_the_density_is_that_of_the_initial_angle(densities):
    start = densities.sel(estimate="two_stage", time=0.0, joint=2)
    expected = norm(0.03, 0.02).pdf(start["joint_angle"])
    np.testing.assert_allclose(start["density"], expected, rtol=1e-7)


def test_what_is_shown_is_nearly_all_and_nothing_is_negative(densities):
    assert (densities["density"] >= 0).all()
    assert (densities["probability_shown"] > 0.98).all()
    assert (densities["probability_shown"] < 1).all()


def test_the_quadrature_error_is_below_a_millionth_of_the_peak(densities):
    assert (densities["density_error"] < 1e-6).all()


def test_bounds_hold_the_posterior_density(densities):
    of_posterior = densities["density"].sel(estimate="posterior")
    bound = densities["density_bound"]
    assert (bound.sel(bound="lower") < of_posterior).all()
    assert (bound.sel(bound="upper") > of_posterior).mean() > 0.99


def test_a_heavy_tail_is_cut_from_the_picture_and_said(angles, least_squares, posterior, config):
    least_squares["population_sd"].loc[{"joint": 2, "parameter": "c_p"}] = 3.2316
    heavy = compute_densities(angles, least_squares, posterior, config, np.random.default_rng(3))
    shown = heavy["probability_shown"].sel(joint=2, time=6.0)
    assert shown.sel(estimate="two_stage") < 0.96
    assert shown.sel(estimate="posterior") > 0.98


def test_unknown_population_gives_nan_and_not_a_guess(angles, least_squares, posterior, config):
    least_squares["population_mean"].loc[{"joint": 1, "parameter": "k_v"}] = np.nan
    densities = compute_densities(
        angles, least_squares, posterior, config, np.random.default_rng(3)
    )
    assert np.isnan(densities["density"].sel(joint=1, estimate="two_stage")).all()
    assert np.isnan(densities["density_error"].sel(joint=1)).all()
    assert np.isfinite(densities["density"].sel(joint=1, estimate="posterior")).all()
