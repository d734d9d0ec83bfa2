import numpy as np
import pytest

from softfinger.inference.collapse.basis import (
    build_elastic_modes,
    build_elastic_table,
    interpolate_coefficients_array,
)
from softfinger.mechanics.three_element import compute_elastic_basis_array

STEP = (np.arange(200) / 20, np.array([0.0]), np.array([1.0]))
UNEVEN = (
    np.sort(np.random.default_rng(4).uniform(0.3, 8.0, 150)),
    np.array([0.5, 2.0, 2.0, 5.0]),
    np.array([0.0, 3.0, 1.0, 1.0]),
)


@pytest.mark.parametrize("protocols", [[STEP], [STEP, UNEVEN]])
def test_curves_and_slopes_are_exact_over_the_whole_table(protocols):
    table = build_elastic_table(protocols)
    places = np.random.default_rng(1).uniform(*table.nodes[[0, -1]], 40)
    for protocol in protocols:
        modes = build_elastic_modes(table, protocol)
        exact, exact_slope = compute_elastic_basis_array(np.exp(places), *protocol)
        for x, e, de in zip(places, exact, exact_slope, strict=True):
            value, slope = interpolate_coefficients_array(table, x)
            assert value @ modes == pytest.approx(e, abs=2e-8)
            assert slope @ modes == pytest.approx(de, abs=2e-6)


def test_beyond_the_table_curves_keep_their_limits():
    table = build_elastic_table([STEP])
    modes = build_elastic_modes(table, STEP)
    slow = interpolate_coefficients_array(table, table.nodes[0] - 3.0)[0] @ modes
    exact, _ = compute_elastic_basis_array(np.exp(table.nodes[0] - 3.0), *STEP)
    assert slow == pytest.approx(exact, abs=2e-5)
    fast, slope = interpolate_coefficients_array(table, table.nodes[-1] + 5.0)
    assert (fast @ modes)[1:] == pytest.approx(1.0, abs=1e-8)
    assert (slope == 0).all()


def test_no_number_gives_no_number_instead_of_a_crash():
    table = build_elastic_table([STEP])
    assert np.isnan(interpolate_coefficients_array(table, np.nan)[0]).all()
