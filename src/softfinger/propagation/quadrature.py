"""Quadrature over normal populations.

It is the trapezoidal rule, which converges exponentially.

For ∫ φ(z) f(σ z) dz with step h the error is the Fourier transform of the integrand at ω = 2π/h.
The Gaussian decays like exp(−ω²/2); a function f of a log-rate, analytic for |Im| < π/2 as
exp(−exp(x)) is, like exp(−a ω) with a = π/(2σ). The slowest split of ω between the two gives
exp(−ω²/2) for ω ≤ a and exp(a²/2 − a ω) beyond.

References
----------
Trefethen, Weideman (2014), SIAM Review 56, 385, doi:10.1137/130932132.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

REACH = 7.5  # sd; 6e-14 of a normal population lies beyond
EXPONENT = 28.0  # the rule's relative error is of the order exp(−28) = 7e-13


def compute_log_step(sigma: ArrayLike) -> NDArray[np.float64]:
    """Compute the widest step of a log-parameter.

    Its sd is `sigma`, and the step keeps the error at exp(−28).

    >>> compute_log_step([0.1, 3.0]).round(3)
    array([0.084, 0.351])
    """
    sigma = np.asarray(sigma, float)
    decay = np.pi / (2 * sigma)
    frequency = np.where(
        decay >= np.sqrt(2 * EXPONENT), np.sqrt(2 * EXPONENT), EXPONENT / decay + decay / 2
    )
    return 2 * np.pi * sigma / frequency


def compute_normal_weights(
    lattice: NDArray[np.float64], mean: ArrayLike, sd: ArrayLike
) -> NDArray[np.float64]:
    """Weigh an equidistant lattice by normal densities.

    The lattice is (m,), the densities (…); weights (…, m) sum to 1.

    >>> compute_normal_weights(np.array([-1.0, 0.0, 1.0]), 0.0, 0.5).round(4)
    array([0.1065, 0.787 , 0.1065])
    """
    z = (lattice - np.asarray(mean, float)[..., None]) / np.asarray(sd, float)[..., None]
    weight = np.exp(-0.5 * z * z)
    return weight / weight.sum(axis=-1, keepdims=True)
