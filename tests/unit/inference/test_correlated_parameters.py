"""Correlated parameters over trials: the option, its prior, its posterior, its artifact."""

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import approx_fprime

from softfinger.artifacts.spec import list_tree_faults
from softfinger.artifacts.specs.posterior import SPEC
from softfinger.inference.correlation import (
    correlate_free_partials_array,
    mark_free_partials,
    shape_free_partials,
)
from softfinger.inference.posterior import fit_posterior, prepare_fit, sample_posterior
from softfinger.inference.predictive import draw_standard
from softfinger.inference.simulate import (
    build_recording,
    describe_noise,
    draw_angles,
    draw_parameters,
)
from softfinger.measurement.covariance import factorise_partials, pull_factor_back

MEAN = np.array([[-2.4, -3.6, 2.8, 0.02], [-2.3, -3.5, 3.1, 0.03]])
SD = np.array([[0.2, 0.4, 0.5, 0.01], [0.3, 0.5, 0.6, 0.02]])
SMALL = {
    "sampler": "nuts", "chains": 2, "tune": 100, "draws": 60, "cores": 1, "target_accept": 0.8,
    "max_depth": 5, "predictive_draws": 40,
}  # fmt: skip
NAMES = [f"{k}[{j}]" for j in (1, 2) for k in ("log_k_v", "log_c_v", "log_c_p", "q_ini")]


def draw_together(trials: int, seed: int):
    """Draw a campaign in which log k_v of both joints, and log c_v of joint 1, are nearly one."""
    rng = np.random.default_rng(seed)
    time = np.arange(150) / 7.5
    recording = build_recording(
        time, [0.0, time[-1]], [0.04, 0.04], 2, [f"trial_{i}" for i in range(trials)]
    )
    own = draw_parameters(MEAN, SD, recording, rng)
    shared = (np.log(own["k_v"][:, 0]) - MEAN[0, 0]) / SD[0, 0]
    for name, joint, k in (("k_v", 1, 0), ("c_v", 0, 1)):
        mixed = 0.95 * shared + np.sqrt(1 - 0.95**2) * rng.standard_normal(trials)
        own[name][:, joint] = np.exp(MEAN[joint, k] + SD[joint, k] * mixed)
    noise = describe_noise(np.full(2, 0.002), np.full(2, 0.3))
    return draw_angles(recording, own, noise, rng)


@pytest.fixture(scope="module")
def angles():
    return draw_together(24, 8)


def find_mean(tree) -> np.ndarray:
    return tree["posterior"]["parameter_correlation"].mean(("chain", "draw")).values


def test_any_parameters_may_go_together(angles):
    tree = fit_posterior(angles, SMALL | {"covariance": "full"}, 4)
    assert list_tree_faults(SPEC, tree) == []
    assert tree["posterior"]["parameter_correlation"].coords["own"].values.tolist() == NAMES
    found = find_mean(tree)
    np.testing.assert_allclose(np.diag(found), 1)
    np.testing.assert_allclose([found[0, 4], found[0, 1]], 0.95, atol=0.15)
    others = found[np.tril_indices(8, -1)]
    assert np.median(np.abs(others)) < 0.25
    before = tree["prior"]["parameter_correlation"].mean(("chain", "draw")).values
    np.testing.assert_allclose(before, np.eye(8), atol=0.1)


def test_new_trials_keep_together_as_the_population_does():
    correlation = np.eye(8)
    correlation[0, 5] = correlation[5, 0] = 0.9
    population = xr.Dataset(
        {
            "mu_q_ini": (("sample", "joint"), np.zeros((1, 2))),
            "parameter_correlation": (("sample", "own", "other_own"), correlation[None]),
        }
    )
    drawn = draw_standard(population, 4000, np.random.default_rng(1)).reshape(4000, 8)
    np.testing.assert_allclose(np.corrcoef(drawn.T), correlation, atol=0.06)


def test_parameters_of_a_joint_alone_may_go_together(angles):
    config = SMALL | {"covariance": "joint"}
    draws, _ = sample_posterior(prepare_fit(angles), config, np.random.default_rng(4))
    found = draws["parameter_correlation"]
    assert (found.values[..., :4, 4:] == 0).all()
    assert found.mean(("chain", "draw")).values[0, 1] > 0.8


@pytest.mark.parametrize(("kind", "free"), [("independent", 0), ("joint", 12), ("full", 28)])
def test_as_many_correlations_as_the_option_says(kind, free):
    assert mark_free_partials(2, kind).sum() == free
    assert shape_free_partials(2, kind).shape == (free,)


@pytest.mark.parametrize("kind", ["joint", "full"])
def test_every_correlation_has_the_density_of_lkj(kind):
    # Under LKJ(2) in p dimensions each correlation is 2 Beta(a, a) − 1, a = 1 + p/2: its variance
    # is 1/(2a + 1) = 1/(p + 3).
    rng = np.random.default_rng(2)
    shape = shape_free_partials(2, kind)
    partial = 2 * rng.beta(shape, shape, (20_000, shape.size)) - 1
    drawn = correlate_free_partials_array(partial, 2, kind)
    size = 4 if kind == "joint" else 8
    row, column = np.tril_indices(size, -1)
    np.testing.assert_allclose(drawn[:, row, column].var(axis=0), 1 / (size + 3), rtol=0.06)


def test_the_slope_of_the_factor_is_its_finite_difference():
    rng = np.random.default_rng(3)
    partial, weight = rng.uniform(-0.7, 0.7, 10), rng.standard_normal((5, 5))
    slope = pull_factor_back(partial, factorise_partials(partial), weight)
    steps = approx_fprime(partial, lambda z: (weight * factorise_partials(z)).sum(), 1e-7)
    np.testing.assert_allclose(slope, steps, rtol=1e-5, atol=1e-6)
