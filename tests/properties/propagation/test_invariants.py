import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import simpson

from softfinger.propagation.correlated import compute_values_array
from softfinger.propagation.density import compute_density_array
from softfinger.propagation.independent import share_variance_array
from softfinger.propagation.moments import compute_moments_array
from softfinger.propagation.quantiles import compute_quantiles_array
from softfinger.propagation.scores import compute_coverage_array, compute_crps_array
from softfinger.propagation.subsets import EVERY, compute_shapley_effects, compute_sobol_indices

TIME = np.array([0.0, 0.1, 0.7, 3.0, 12.0])
MU = st.tuples(st.floats(-4, -1), st.floats(-6, -1), st.floats(0, 5), st.floats(-0.1, 0.1))
LOG_SD = st.floats(0.02, 1.5)
SIGMA = st.tuples(LOG_SD, LOG_SD, st.floats(0.02, 3.5), st.floats(1e-3, 0.1))
TORQUE = st.floats(-0.1, 0.1, allow_subnormal=False)


def compute_indices(*arguments):
    return compute_sobol_indices(share_variance_array(*arguments))


@st.composite
def loads(draw):
    gaps = draw(st.lists(st.just(0.0) | st.floats(1e-3, 5.0), min_size=1, max_size=4))
    torque = draw(st.lists(TORQUE, min_size=len(gaps), max_size=len(gaps)))
    return np.cumsum(gaps), np.array(torque)


@settings(deadline=None, derandomize=True, max_examples=60)
@given(MU, SIGMA, loads())
def test_indices_are_shares_of_one(mu, sigma, load):
    indices = compute_indices(mu, sigma, TIME, *load)
    for array in indices:
        assert (array >= -1e-12).all()
        assert (array <= 1 + 1e-12).all()
    whole = indices.first_order.sum(axis=-1) + indices.second_order.sum(axis=-1)
    np.testing.assert_allclose(whole, 1.0, rtol=1e-12)


@settings(deadline=None, derandomize=True, max_examples=40)
@given(MU, SIGMA, loads(), st.floats(0.1, 10.0))
def test_units_do_not_matter(mu, sigma, load, factor):
    """Torque, stiffness and viscosities in another unit: the same angles, the same indices."""
    mu, sigma = np.array(mu), np.array(sigma)
    other = mu + np.log(factor) * np.array([1, 1, 1, 0])
    scaled = load[0], load[1] * factor
    for compute in (compute_moments_array, compute_indices):
        for one, two in zip(
            compute(mu, sigma, TIME, *load), compute(other, sigma, TIME, *scaled), strict=True
        ):
            np.testing.assert_allclose(two, one, rtol=1e-6, atol=1e-9)


@settings(deadline=None, derandomize=True, max_examples=40)
@given(MU, SIGMA, loads())
def test_the_two_quadratures_agree_on_the_share_of_the_initial_angle(mu, sigma, load):
    variance = compute_moments_array(mu, sigma, TIME, *load)[1]
    share = compute_indices(mu, sigma, TIME, *load).first_order[:, 3]
    np.testing.assert_allclose(share, sigma[3] ** 2 / variance, rtol=1e-5)


@settings(deadline=None, derandomize=True, max_examples=25)
@given(MU, SIGMA, TORQUE)
def test_density_is_one_in_all_and_turns_with_the_load(mu, sigma, torque):
    mu, sigma = np.array(mu), np.array(sigma)
    ends = compute_quantiles_array(mu, sigma, TIME, [0.0], [torque], [0.001, 0.6])
    angle = np.linspace(ends[:, 0], ends[:, 1], 1201, axis=-1)
    density = compute_density_array(mu, sigma, TIME, [0.0], [torque], angle)
    assert (density >= 0).all()
    turned = compute_density_array(mu * [1, 1, 1, -1], sigma, TIME, [0.0], [-torque], -angle)
    peak = density.max(axis=1, keepdims=True)
    np.testing.assert_allclose(turned / peak, density / peak, atol=1e-6)
    narrow = (ends[:, 1] - ends[:, 0]) / 1200 < 0.3 * sigma[3]
    between = simpson(density, angle, axis=1)
    np.testing.assert_allclose(between[narrow], 0.599, atol=1e-4)


@settings(deadline=None, derandomize=True, max_examples=25)
@given(MU, SIGMA, loads())
def test_shapley_effects_are_shares_of_one(mu, sigma, load):
    covariance = np.diag(np.square(np.minimum(sigma, 1.5)))
    _, value = compute_values_array(np.array([mu]), covariance, TIME, *load)
    effect = compute_shapley_effects({u: v[0] / value[EVERY][0] for u, v in value.items()})
    assert (effect >= 0).all()
    np.testing.assert_allclose(effect.sum(axis=-1), 1.0, rtol=1e-6)


@settings(deadline=None, derandomize=True)
@given(st.lists(st.floats(-1, 1), min_size=1, max_size=9), st.floats(-2, 2), st.floats(-1, 1))
def test_scores_move_with_the_angle(predicted, observed, shift):
    predicted = np.sort(predicted)
    crps = compute_crps_array(observed, predicted)
    assert crps >= -1e-15
    assert crps <= np.abs(predicted - observed).mean() + 1e-12
    np.testing.assert_allclose(
        compute_crps_array(observed + shift, predicted + shift), crps, atol=1e-12
    )
    y = np.array([observed, np.nan])
    inside = compute_coverage_array(y, np.full(2, predicted[0]), np.full(2, predicted[-1]))
    assert inside == float(predicted[0] <= observed <= predicted[-1])
