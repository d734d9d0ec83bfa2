"""Exact responses of a linear mode.

The drive is a quadratic in time.

A mode is x' = −λ x + g D(t). With D(s) = d₀ + d₁ s + d₂ s² over a step of length h (s = t/h) and
z = λ h s,

    x(s) = e^{−z} x(0) + g h s [d₀ φ₁ + d₁ s φ₂ + 2 d₂ s² φ₃],
    φ_k = ∫₀¹ e^{−(1−r)z} r^{k−1}/(k−1)! dr,

so every spring, dashpot and springpot mode is advanced without error however long the step, and
only drives that are no quadratics need short ones. The drives go through the nodes of the
three-stage Radau IIA method.
"""

import math

import numpy as np

from softfinger.compiled import compiled

_ROOT = math.sqrt(6.0)
NODES = np.array([(4.0 - _ROOT) / 10.0, (4.0 + _ROOT) / 10.0, 1.0])
"""Radau IIA nodes s within a step."""
TO_MONOMIAL = np.linalg.inv(np.vander(NODES, increasing=True))
"""(power, node): coefficients d of the quadratic through values at the nodes."""
_INTEGRAL = np.stack([NODES, NODES**2 / 2, NODES**3 / 3], axis=1) @ TO_MONOMIAL
DIFFERENTIATE = np.linalg.inv(_INTEGRAL)
"""(node, node): h × derivative at the nodes, from the increments since the start of the step."""


@compiled
def phi_functions(z: float) -> tuple[float, float, float, float, float]:
    """e^{−z} and φ₁ … φ₄, to rounding.

    z ≥ 0.
    """
    if z == 0.0:
        return 1.0, 1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0
    if z > 1.0:
        decay = math.exp(-z)
        first = (1.0 - decay) / z
        second = (1.0 - first) / z
        third = (0.5 - second) / z
        return decay, first, second, third, (1.0 / 6.0 - third) / z
    term, fourth, n = 1.0 / 24.0, 0.0, 4
    while abs(term) > 1e-18:
        fourth += term
        n += 1
        term *= -z / n
    third = 1.0 / 6.0 - z * fourth
    second = 0.5 - z * third
    first = 1.0 - z * second
    return 1.0 - z * first, first, second, third, fourth


@compiled
def mode_response(
    rate: float, span: float, share: float, start: float, gain: float,
    d0: float, d1: float, d2: float,
) -> tuple[float, float, float, float, float, float, float]:  # fmt: skip
    """A mode inside a step.

    It is `span` seconds into a step, at the share s of it.

    Returns x, its derivatives by x(0), λ and g, and the integrals that d₀, d₁, d₂ weigh (times g:
    the derivatives by them).
    """
    decay, p1, p2, p3, p4 = phi_functions(rate * span)
    w0, w1, w2 = span * p1, span * share * p2, 2.0 * span * share * share * p3
    unit = d0 * w0 + d1 * w1 + d2 * w2
    v0, v1 = p1 - p2, share * (p2 - 2.0 * p3)
    v2 = 2.0 * share * share * (p3 - 3.0 * p4)
    slower = -span * (decay * start + gain * span * (d0 * v0 + d1 * v1 + d2 * v2))
    return decay * start + gain * unit, decay, slower, unit, w0, w1, w2
