"""What the stage computes is what its artifacts declare."""

import numpy as np

from softfinger.artifacts.spec import list_faults
from softfinger.artifacts.specs import bands, densities, sobol
from softfinger.propagation import compute_bands, compute_densities, compute_sobol


def test_bands(angles, least_squares, posterior, config):
    found = compute_bands(angles, least_squares, posterior, config, np.random.default_rng(3))
    assert list_faults(bands.SPEC, found) == []


def test_densities(angles, least_squares, posterior, config):
    assert (
        list_faults(densities.SPEC, compute_densities(angles, least_squares, posterior, config))
        == []
    )


def test_sobol(angles, least_squares, posterior, config):
    assert list_faults(sobol.SPEC, compute_sobol(angles, least_squares, posterior, config)) == []
