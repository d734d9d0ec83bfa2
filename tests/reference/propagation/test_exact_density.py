"""The exact density against plain quadrature in three dimensions, also with the paper's tail."""

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from softfinger.propagation.density import compute_density_array

MU = {1: [-2.4441, -3.6635, 2.8538, 0.02], 3: [-1.88, -3.8777, 1.3114, 0.02]}
SIGMA = {1: [0.1973, 0.5232, 0.7011, 0.01], 3: [0.3957, 0.8223, 3.2316, 0.01]}
ANGLE = np.linspace(-0.01, 0.6, 19)


def integrate_flow_and_initial_angle(v, impulse, mu, sigma, sd):
    """Density of impulse/c_p + N(0, sd²) at v, by Gauss–Legendre panels no wider than sd."""
    edges = [impulse * np.exp(-mu - 9 * sigma)]
    while edges[-1] < min(v.max() + 9 * sd, impulse * np.exp(-mu + 9 * sigma)):
        edges.append(min(edges[-1] * np.exp(0.3 * min(sigma, 1.0)), edges[-1] + sd))
    edges = np.array(edges)
    point, weight = np.polynomial.legendre.leggauss(12)
    half = np.diff(edges)[:, None] / 2
    flow = ((edges[1:] + edges[:-1])[:, None] / 2 + half * point).ravel()
    z = (np.log(flow / impulse) + mu) / sigma
    mass = np.exp(-(z**2) / 2) / (flow * sigma * np.sqrt(2 * np.pi)) * (half * weight).ravel()
    distance = (v[:, None] - flow) / sd
    return np.exp(-(distance**2) / 2) @ mass / (sd * np.sqrt(2 * np.pi))


def integrate_all(joint, time):
    mu, sigma = MU[joint], SIGMA[joint]
    v = np.arange(-0.7, 1.0, sigma[3] / 8)
    impulse = 0.04 * time
    rest = integrate_flow_and_initial_angle(v, impulse, mu[2], sigma[2], sigma[3])
    rest = make_interp_spline(v, rest, k=7)
    z = np.linspace(-7, 7, 341)
    weight = np.exp(-(z**2) / 2)
    weight /= weight.sum()
    k, c = np.exp(mu[0] + sigma[0] * z)[:, None], np.exp(mu[1] + sigma[1] * z)
    elastic = 0.04 / k * (1 - np.exp(-k / c * time))
    density = []
    for angle in ANGLE:
        left = angle - mu[3] - elastic
        density.append(weight @ np.where(left > v[0], rest(np.maximum(left, v[0])), 0.0) @ weight)
    return np.array(density)


@pytest.mark.parametrize(("joint", "time"), [(1, 0.3), (1, 30.0), (3, 0.1), (3, 30.0)])
def test_density_equals_three_dimensional_quadrature(joint, time):
    expected = integrate_all(joint, time)
    density = compute_density_array(MU[joint], SIGMA[joint], [time], [0.0], [0.04], ANGLE)[0]
    assert np.abs(density - expected).max() < 1e-7 * expected.max()
