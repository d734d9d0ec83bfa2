"""The sampling routes against closed forms and against the exact routes."""

import numpy as np
import pytest
from scipy.stats import lognorm, norm, uniform

from softfinger.propagation.density import compute_density_array
from softfinger.propagation.general import estimate_density_array, estimate_sobol_array
from softfinger.propagation.indices import compute_sobol_array
from softfinger.propagation.sampling import compute_angles_array, draw_parameters_array

MU = np.array([-2.4441, -3.6635, 2.8538, 0.02])
SIGMA = np.array([0.1973, 0.5232, 0.7011, 0.01])
STEP = ([0.0], [0.04])


def assert_within_error(estimate, error, truth):
    """The errors are 95 % half-widths: twice as much is never met, and they are small.

    The floor is for rare parameters that no run of the seed drew and that matter by less than it.
    """
    assert (np.abs(estimate - truth) <= 2 * error + 1e-4).all()
    assert (error < 0.05).all()


def test_ishigami():
    """Closed form: Ishigami, Homma (1990), a = 7, b = 0.1."""
    a, b = 7.0, 0.1

    def model(x):
        return (np.sin(x[:, 0]) + a * np.sin(x[:, 1]) ** 2 + b * x[:, 2] ** 4 * np.sin(x[:, 0]))[
            :, None
        ]

    v1 = 0.5 * (1 + b * np.pi**4 / 5) ** 2
    v2, v13 = a**2 / 8, b**2 * np.pi**8 * (1 / 18 - 1 / 50)
    whole = v1 + v2 + v13
    indices = estimate_sobol_array(
        model, [uniform(-np.pi, 2 * np.pi)] * 3, 2**13, np.random.default_rng(2)
    )
    first = np.array([v1, v2, 0.0]) / whole
    total = np.array([v1 + v13, v2, v13]) / whole
    assert_within_error(indices.first_order[:, 0], indices.first_order_error[:, 0], first)
    assert_within_error(indices.total[:, 0], indices.total_error[:, 0], total)


def test_sobol_g():
    """Closed form: V_i = 1/(3 (1 + a_i)²), ∏(1 + V_i) − 1 in all."""
    a = np.array([0.0, 0.5, 3.0, 9.0, 99.0])

    def model(x):
        return ((np.abs(4 * x - 2) + a) / (1 + a)).prod(axis=1, keepdims=True)

    part = 1 / (3 * (1 + a) ** 2)
    whole = (1 + part).prod() - 1
    indices = estimate_sobol_array(model, [uniform()] * 5, 2**13, np.random.default_rng(4))
    assert_within_error(indices.first_order[:, 0], indices.first_order_error[:, 0], part / whole)
    total = part * (1 + part).prod() / (1 + part) / whole
    assert_within_error(indices.total[:, 0], indices.total_error[:, 0], total)


def test_sampled_indices_agree_with_the_exact_ones():
    time = np.array([0.0, 0.5, 3.0, 30.0])
    populations = [lognorm(s, scale=np.exp(m)) for m, s in zip(MU[:3], SIGMA[:3], strict=True)]
    populations.append(norm(MU[3], SIGMA[3]))
    indices = estimate_sobol_array(
        lambda p: compute_angles_array(p, time, *STEP), populations, 2**12, np.random.default_rng(7)
    )
    exact = compute_sobol_array(MU, SIGMA, time, *STEP)
    assert_within_error(indices.first_order, indices.first_order_error, exact.first_order.T)
    assert_within_error(indices.total, indices.total_error, exact.total.T)


def test_an_output_that_does_not_vary_has_no_index():
    indices = estimate_sobol_array(
        lambda x: np.column_stack([x[:, 0], 0 * x[:, 0]]),
        [uniform()] * 2,
        64,
        np.random.default_rng(1),
    )
    assert np.isfinite(indices.first_order[:, 0]).all()
    assert np.isnan(indices.first_order[:, 1]).all()


@pytest.mark.parametrize("time", [0.2, 10.0])
def test_sampled_density_agrees_with_the_exact_one(time):
    rng = np.random.default_rng(8)
    parameters = MU + SIGMA * rng.standard_normal((40000, 4))
    parameters[:, :3] = np.exp(parameters[:, :3])
    parameters[:, 3] = 0.0
    angle = np.linspace(0.0, 1.0, 61)
    motion = compute_angles_array(parameters, [time], *STEP)[:, 0]
    density, error = estimate_density_array(motion, SIGMA[3], angle - MU[3])
    exact = compute_density_array(MU, SIGMA, [time], *STEP, angle)[0]
    peak = exact.max()
    assert (np.abs(density - exact) <= 4.5 * error + 2e-3 * peak).all()
    assert 1e-4 * peak < error.max() < 0.03 * peak


def test_drawn_parameters_have_the_populations_moments_and_noise():
    other = np.stack([MU, MU + np.eye(4)[3]])
    parameters, draw, z = draw_parameters_array(
        other, np.stack([SIGMA, SIGMA]), 4096, np.random.default_rng(3)
    )
    assert np.bincount(draw).tolist() == [2048, 2048]
    np.testing.assert_allclose(np.log(parameters[:, :3]).mean(0), MU[:3], atol=2e-3)
    np.testing.assert_allclose(np.log(parameters[:, :3]).std(0), SIGMA[:3], rtol=5e-3)
    assert parameters[draw == 1, 3].mean() == pytest.approx(1.02, abs=1e-3)
    assert z.std() == pytest.approx(1.0, abs=5e-3)


def test_drawn_c_p_keeps_within_its_truncation():
    parameters = draw_parameters_array(
        MU[None], SIGMA[None], 1024, np.random.default_rng(3), c_p_truncation_sd=1.5
    )[0]
    z = (np.log(parameters[:, 2]) - MU[2]) / SIGMA[2]
    assert np.abs(z).max() == pytest.approx(1.5, abs=0.01)
    assert np.abs((np.log(parameters[:, 1]) - MU[1]) / SIGMA[1]).max() > 2.5
