"""The exact indices against independent quadratures and against what is known of the paper."""

import numpy as np
import pytest
from scipy.integrate import dblquad
from scipy.stats import lognorm

from softfinger.propagation.independent import share_variance_array, split_elastic_variance_array
from softfinger.propagation.moments import compute_inverse_moments, compute_moments_array
from softfinger.propagation.subsets import compute_sobol_indices

# the paper's table, joints 1 to 3: k_v, c_v, c_p (of the logs), q_ini as the brief takes it
MU = np.array(
    [
        [-2.4441, -3.6635, 2.8538, 0.02],
        [-2.2986, -3.6476, 3.1129, 0.02],
        [-1.8800, -3.8777, 1.3114, 0.02],
    ]
)
SIGMA = np.array(
    [
        [0.1973, 0.5232, 0.7011, 0.01],
        [0.2238, 0.4838, 0.8496, 0.01],
        [0.3957, 0.8223, 3.2316, 0.01],
    ]
)
TIME = np.arange(301) * 0.1
STEP = ([0.0], [0.04])


def compute_indices(*arguments):
    return compute_sobol_indices(share_variance_array(*arguments))


def split_by_gauss_hermite(mu, sigma, n):
    """V_k, V_c, V_kc of the step's elastic part by a tensor rule, its formula written anew."""
    z, w = np.polynomial.hermite_e.hermegauss(n)
    w = w / w.sum()
    k = np.exp(mu[0] + sigma[0] * z)[:, None, None]
    c = np.exp(mu[1] + sigma[1] * z)[None, :, None]
    angle = 0.04 / k * (1 - np.exp(-k / c * TIME))
    given_k = np.einsum("j,ijt->it", w, angle)
    given_c = np.einsum("i,ijt->jt", w, angle)
    mean = w @ given_k
    v_k, v_c = w @ (given_k - mean) ** 2, w @ (given_c - mean) ** 2
    return v_k, v_c, np.einsum("i,j,ijt->t", w, w, (angle - mean) ** 2) - v_k - v_c


@pytest.mark.parametrize("joint", [0, 1, 2])
def test_indices_equal_a_high_order_tensor_rule(joint):
    elastic = np.array(split_by_gauss_hermite(MU[joint], SIGMA[joint], 120))
    mu, sigma = MU[joint].copy(), SIGMA[joint].copy()
    if joint == 2:  # the table's c_p would leave nothing of the other indices to compare
        mu[2], sigma[2] = 3.3, 0.9
    inverse = lognorm(sigma[2], scale=np.exp(-mu[2])).var()
    total = elastic.sum(axis=0) + (0.04 * TIME) ** 2 * inverse + sigma[3] ** 2
    indices = compute_indices(mu, sigma, TIME, *STEP)
    np.testing.assert_allclose(indices.first_order[:, 0], elastic[0] / total, atol=1e-9)
    np.testing.assert_allclose(indices.first_order[:, 1], elastic[1] / total, atol=1e-9)
    np.testing.assert_allclose(indices.second_order[:, 0], elastic[2] / total, atol=1e-9)
    np.testing.assert_allclose(
        indices.first_order[:, 2], (0.04 * TIME) ** 2 * inverse / total, atol=1e-9
    )


@pytest.mark.parametrize(("joint", "lowest"), [(0, 0.94), (1, 0.93)])
def test_first_order_indices_do_not_sum_to_one(joint, lowest):
    """The paper says that they do; k_v and c_v interact near 0.5 s."""
    total = compute_indices(MU[joint], SIGMA[joint], TIME, *STEP).first_order.sum(axis=-1)
    assert total.min() == pytest.approx(lowest, abs=0.005)
    assert 0.3 < TIME[total.argmin()] < 0.7


def test_joint_3_interaction_depends_on_the_tail_of_c_p():
    mu, sigma = MU[2].copy(), SIGMA[2].copy()
    assert compute_indices(mu, sigma, TIME, *STEP).first_order.sum(-1).min() > 0.9999
    mu[2], sigma[2] = 3.3, 0.9
    lowest = compute_indices(mu, sigma, TIME, *STEP).first_order.sum(-1).min()
    assert lowest == pytest.approx(0.86, abs=0.001)


def test_the_papers_table_makes_no_band_at_joint_3():
    """Trap 3 of the table: mean and sd of 1/c_p, and of the angle at 30 s."""
    mean, log_variance = compute_inverse_moments(1.3114, 3.2316)
    assert mean == pytest.approx(49.9, abs=0.05)
    assert np.exp(log_variance / 2) == pytest.approx(9245, rel=0.002)
    angle_mean, angle_variance = compute_moments_array(MU[2], SIGMA[2], [30.0], *STEP)
    assert angle_mean[0] == pytest.approx(60.2, abs=0.1)
    assert np.sqrt(angle_variance[0]) == pytest.approx(11094, rel=0.01)


@pytest.mark.parametrize("cut", [0.5, 2.0])
def test_truncated_moments_equal_quadrature(cut):
    z = np.linspace(-cut, cut, 20001)
    weight = np.exp(-(z**2) / 2)
    inverse = np.exp(-(1.3 + 0.9 * z))
    mean = np.trapezoid(weight * inverse, z) / np.trapezoid(weight, z)
    variance = np.trapezoid(weight * (inverse - mean) ** 2, z) / np.trapezoid(weight, z)
    ours, log_variance = compute_inverse_moments(1.3, 0.9, cut)
    assert ours == pytest.approx(mean, rel=1e-7)
    assert np.exp(log_variance) == pytest.approx(variance, rel=1e-6)


@pytest.mark.parametrize("sigma_c_v", [0.02, 3.0])
def test_moments_and_indices_agree_on_the_variance_also_when_hardly_identified(sigma_c_v):
    """Two independent quadratures, under a load with ramps, holding and unloading."""
    load = ([0.0, 1.0, 5.0, 5.0, 9.0], [0.0, 0.04, 0.04, 0.01, 0.0])
    mu, sigma = MU[0], SIGMA[0] * [2.0, 1.0, 1.0, 1.0]
    sigma[1] = sigma_c_v
    time = np.linspace(0.0, 12.0, 25)
    elastic = split_elastic_variance_array(mu, sigma, time, *load).sum(axis=0)
    variance = compute_moments_array(mu, sigma, time, *load)[1]
    share = compute_indices(mu, sigma, time, *load).first_order[:, 3]
    np.testing.assert_allclose(share, sigma[3] ** 2 / variance, rtol=1e-8)
    assert elastic[0] == 0.0


def test_mean_equals_adaptive_quadrature():
    sigma, mu = SIGMA[1], MU[1]

    def integrand(y, x):
        k, c = np.exp(mu[0] + sigma[0] * x), np.exp(mu[1] + sigma[1] * y)
        return 0.04 / k * (1 - np.exp(-k / c * 0.7)) * np.exp(-(x * x + y * y) / 2) / (2 * np.pi)

    elastic = dblquad(integrand, -9, 9, -9, 9, epsabs=1e-10)[0]
    flow = 0.04 * 0.7 * np.exp(-mu[2] + sigma[2] ** 2 / 2)
    mean = compute_moments_array(mu, sigma, [0.7], *STEP)[0]
    assert mean[0] == pytest.approx(elastic + flow + 0.02, abs=1e-9)
