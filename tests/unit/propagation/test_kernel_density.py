import numpy as np
from scipy.stats import norm

from softfinger.propagation.kernel_density import estimate_density_array, smooth_sample_array


def test_it_is_the_sum_of_its_kernels():
    sample, places = np.array([0.0, 0.1, 0.4]), np.linspace(-0.2, 0.5, 21)
    expected = norm(sample[:, None], 0.07).pdf(places).mean(axis=0)
    np.testing.assert_allclose(smooth_sample_array(sample, 0.07, places), expected, rtol=1e-6)


def test_a_kernel_density_holds_one_whatever_is_unknown():
    sample = np.random.default_rng(5).normal(0.3, 0.05, 500)
    sample[::10] = np.nan
    places = np.linspace(0.0, 0.6, 200)
    density = estimate_density_array(sample, places)
    np.testing.assert_allclose(np.trapezoid(density, places), 1.0, atol=1e-3)
    middle = density[np.argmin(np.abs(places - 0.3))]
    np.testing.assert_allclose(middle, 1 / (0.05 * np.sqrt(2 * np.pi)), rtol=0.15)
