import numpy as np
import pytest

from softfinger.measurement.gaps import (
    place_gap_nodes_array,
    spread_gaps_array,
)


def test_few_distinct_gaps_are_kept_as_they_are():
    gap = np.array([1.0, 1.0002, 3.0, 1.0, 2.0, 2.0])
    nodes = place_gap_nodes_array(gap)
    assert nodes == pytest.approx([1.0, 2.0, 3.0], abs=1e-3)
    assert spread_gaps_array(gap, nodes).argmax(axis=1).tolist() == [0, 0, 2, 0, 1, 1]


def test_many_gaps_are_interpolated():
    gap = np.random.default_rng(0).uniform(0.6, 2.5, 300)
    nodes = place_gap_nodes_array(gap)
    assert len(nodes) == 8
    weights = spread_gaps_array(gap, nodes)
    assert weights.sum(axis=1) == pytest.approx(1.0)
    for rho in (0.2, 0.9):
        exact = 1 / (1 - rho ** (2 * gap))
        assert weights @ (1 / (1 - rho ** (2 * nodes))) == pytest.approx(exact, rel=1e-4)
