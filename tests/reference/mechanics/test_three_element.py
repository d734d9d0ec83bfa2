from itertools import pairwise

import numpy as np
from scipy.integrate import quad

from softfinger.mechanics.load import evaluate_load_array
from softfinger.mechanics.three_element import compute_elastic_basis_array


def test_basis_is_boltzmanns_convolution():
    knots = np.array([0.5, 0.5, 2.0, 3.0, 3.0, 5.0])
    torques = np.array([0.0, 1.0, 2.0, 2.0, -0.5, 1.0])
    time = np.sort(np.random.default_rng(0).uniform(-1.0, 8.0, 23))
    basis, _ = compute_elastic_basis_array(1.7, time, knots, torques)
    for t, value in zip(time, basis, strict=True):
        edges = [0.5, *(k for k in np.unique(knots) if 0.5 < k < t), max(t, 0.5)]
        reference = sum(
            quad(
                lambda s, t=t: (
                    1.7 * np.exp(-1.7 * (t - s)) * evaluate_load_array([s], knots, torques)[0]
                ),
                *piece,
                epsabs=1e-13,
            )[0]
            for piece in pairwise(edges)
        )
        assert abs(value - reference) < 1e-13
