"""Both routes to the same answers, for one population of two joints."""

import numpy as np
import pytest
import xarray as xr

from softfinger.inference.motion import move_paper_joint
from softfinger.propagation.config import read_config
from softfinger.propagation.new_trials import Source
from softfinger.propagation.populations import relate_own_array
from softfinger.propagation.protocols import Protocol
from softfinger.propagation.routes import CORRELATED, EXACT, SAMPLED, choose_route
from softfinger.propagation.subsets import SUBSETS

TIME = np.array([0.1, 1.0, 4.0])
LOAD = np.array([0.0, 2.0, 6.0]), np.array([0.04, 0.04, 0.02])
PROTOCOL = Protocol("protocol_1", np.array([0, 2]), *LOAD, 6.0)
MU = np.array([[-2.4, -3.6, 2.8, 0.02], [-1.9, -3.2, 3.3, 0.03]])
SIGMA = np.array([[0.2, 0.5, 0.6, 0.02], [0.3, 0.6, 0.5, 0.03]])


def correlate(joints=2):
    """Correlations within the joints and between them, of either sign."""
    factor = np.random.default_rng(12).standard_normal((4 * joints, 4 * joints))
    scatter = factor @ factor.T + 2 * np.eye(4 * joints)
    sd = np.sqrt(np.diag(scatter))
    return scatter / np.outer(sd, sd)


@pytest.fixture
def make_source(config):
    def make(correlation=None, cut=None, move=move_paper_joint, **knobs):
        correlation = np.eye(8) if correlation is None else correlation
        population = xr.Dataset(
            {
                "mu": (("draw", "joint", "parameter"), np.tile(MU, (3, 1, 1))),
                "sigma": (("draw", "joint", "parameter"), np.tile(SIGMA, (3, 1, 1))),
                "correlation": (("draw", "own", "other_own"), np.tile(correlation, (3, 1, 1))),
            },
            coords={"joint": [1, 2], "parameter": ["k_v", "c_v", "c_p", "q_ini"]},
        )
        knobs = {"draw_samples": 4096, **knobs, "c_p_truncation_sd": cut}
        return Source(population, move, read_config({**config, **knobs}), 5)

    return make


def test_the_model_chooses_its_route(make_source):
    assert choose_route(make_source()) is EXACT
    assert choose_route(make_source(cut=2.0)) is EXACT
    assert choose_route(make_source(correlate())) is CORRELATED
    assert choose_route(make_source(correlate(), cut=2.0)) is SAMPLED
    assert choose_route(make_source(move=lambda *fingers: None)) is SAMPLED


@pytest.mark.parametrize("cut", [None, 1.5])
def test_moments_of_independent_parameters(make_source, cut):
    source, left = make_source(cut=cut), np.array([1.0, 1.0, 0.5, 1e-6])
    for spread in (np.ones(4), left):
        mean, variance = EXACT.compute_moments(source, PROTOCOL, TIME, spread)
        estimated = SAMPLED.compute_moments(source, PROTOCOL, TIME, spread)
        np.testing.assert_allclose(estimated[0], mean, rtol=3e-3)
        np.testing.assert_allclose(estimated[1], variance, rtol=0.05)


def test_moments_of_correlated_parameters(make_source):
    source, left = make_source(correlate()), np.array([1.0, 0.5, 1e-6, 1.0])
    for spread in (np.ones(4), left):
        mean, variance = CORRELATED.compute_moments(source, PROTOCOL, TIME, spread)
        estimated = SAMPLED.compute_moments(source, PROTOCOL, TIME, spread)
        np.testing.assert_allclose(estimated[0], mean, rtol=3e-3)
        np.testing.assert_allclose(estimated[1], variance, rtol=0.05)


def test_without_correlation_both_closed_forms_are_one(make_source):
    source = make_source()
    for one, other in zip(
        EXACT.compute_moments(source, PROTOCOL, TIME),
        CORRELATED.compute_moments(source, PROTOCOL, TIME),
        strict=True,
    ):
        np.testing.assert_allclose(other, one, rtol=1e-9)
    shares = [route.share_variance(source, PROTOCOL, TIME) for route in (EXACT, CORRELATED)]
    for subset in SUBSETS:
        np.testing.assert_allclose(shares[1][subset], shares[0][subset], atol=1e-9)


@pytest.mark.parametrize(("correlation", "route"), [(None, EXACT), (correlate(), CORRELATED)])
def test_shares_of_every_set_of_parameters(make_source, correlation, route):
    source = make_source(correlation)
    shares = route.share_variance(source, PROTOCOL, TIME)
    estimated = SAMPLED.share_variance(source, PROTOCOL, TIME)
    assert set(estimated) == set(shares) == set(SUBSETS)
    for subset in SUBSETS:
        np.testing.assert_allclose(
            estimated[subset].mean(axis=0), shares[subset].mean(axis=0), atol=0.02
        )


@pytest.mark.parametrize("cut", [None, 1.0])
def test_quantiles_and_densities_of_independent_parameters(make_source, cut):
    source, probability = make_source(cut=cut), np.array([0.05, 0.5, 0.95])
    edges = EXACT.find_quantiles(source, PROTOCOL, TIME, probability)
    estimated = SAMPLED.find_quantiles(source, PROTOCOL, TIME, probability)
    np.testing.assert_allclose(estimated, edges, rtol=0.01)
    angle = np.linspace(edges[..., 0], edges[..., 2], 41, axis=-1)
    mean, of_draws = EXACT.compute_densities(source, PROTOCOL, TIME, angle)
    estimated, of_sampled = SAMPLED.compute_densities(source, PROTOCOL, TIME, angle)
    assert of_draws.shape == of_sampled.shape == (3, 2, 3, 41)
    peak = mean.max(axis=-1, keepdims=True)
    np.testing.assert_allclose(estimated / peak, mean / peak, atol=0.06)
    np.testing.assert_allclose(of_sampled / peak, of_draws / peak, atol=0.12)


def test_densities_of_correlated_parameters_are_those_of_brute_force(make_source):
    rng = np.random.default_rng(4)
    covariance = relate_own_array(correlate(), SIGMA)
    own = rng.multivariate_normal(MU.ravel(), covariance, 100000).reshape(-1, 2, 4)
    moved = move_paper_joint(own, None, None, TIME, *LOAD)
    source = make_source(correlate())
    edges = np.quantile(moved, [0.02, 0.98], axis=0)
    grid = np.linspace(*edges, 31, axis=-1)
    density, _ = CORRELATED.compute_densities(source, PROTOCOL, TIME, grid)
    for joint, time in np.ndindex(2, 3):
        places = grid[joint, time]
        counted, _ = np.histogram(moved[:, joint, time], places)
        counted = counted / len(moved) / np.diff(places)
        middle = (density[joint, time, 1:] + density[joint, time, :-1]) / 2
        assert np.abs(middle - counted).max() < 0.06 * counted.max()


def test_the_knobs_count(make_source):
    few = make_source(move=lambda *fingers: move_paper_joint(*fingers), sampled_draws=2)
    mean, _ = choose_route(few).compute_moments(few, PROTOCOL, TIME)
    assert len(mean) == 2
    asked = []

    def move(own, *rest):
        asked.append(len(own))
        return move_paper_joint(own, *rest)

    source = make_source(move=move, draw_samples=128)
    choose_route(source).compute_moments(source, PROTOCOL, TIME)
    assert asked == [128] * 3


def test_a_finger_that_cannot_be_moved_does_not_count(make_source):
    def move(own, *rest):
        angle = move_paper_joint(own, *rest)
        angle[::5] = np.nan
        return angle

    source = make_source(move=move)
    mean, variance = EXACT.compute_moments(source, PROTOCOL, TIME)
    estimated = SAMPLED.compute_moments(source, PROTOCOL, TIME)
    np.testing.assert_allclose(estimated[0], mean, rtol=0.02)
    np.testing.assert_allclose(estimated[1], variance, rtol=0.15)
    assert all(
        np.isfinite(v).all() for v in SAMPLED.share_variance(source, PROTOCOL, TIME).values()
    )


def test_a_set_explains_no_less_than_its_parts(make_source):
    """Also where few samples of correlated parameters say otherwise."""
    alike = np.full((8, 8), 0.98) + 0.02 * np.eye(8)
    shares = SAMPLED.share_variance(make_source(alike, draw_samples=64), PROTOCOL, TIME)
    for subset in SUBSETS:
        for part in SUBSETS:
            if set(part) < set(subset):
                assert (shares[part] <= shares[subset]).all()
