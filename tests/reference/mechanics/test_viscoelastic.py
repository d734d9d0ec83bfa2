"""Every model against identities and integrators that know nothing of how it is computed."""

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from softfinger.mechanics.load import evaluate_load_array
from softfinger.mechanics.viscoelastic.elements import (
    Dashpot,
    Spring,
    Springpot,
    burgers,
    generalised_maxwell,
    generalised_voigt,
    kelvin_voigt,
    maxwell,
    parallel,
    series,
    three_element,
    zener,
)
from softfinger.mechanics.viscoelastic.response import (
    compute_creep_compliance_array,
    compute_network_response_array,
    compute_relaxation_modulus_array,
)

EXACT = {
    "maxwell": maxwell(2.0, 3.0),
    "kelvin_voigt": kelvin_voigt(2.0, 3.0),
    "zener": zener(1.0, 2.0, 3.0),
    "three_element": three_element(0.1, 0.02, 20.0),
    "burgers": burgers(1.0, 2.0, 3.0, 4.0),
    "generalised_maxwell": generalised_maxwell(1.0, [1, 2, 3], [0.1, 1.0, 30.0]),
    "generalised_voigt": generalised_voigt(1.0, [1, 2, 3], [0.1, 1.0, 30.0]),
    "nested": parallel(three_element(0.1, 0.02, 20.0), burgers(1.0, 2.0, 3.0, 4.0), Dashpot(0.3)),
}
FRACTIONAL = {
    "springpot": Springpot(2.0, 0.4),
    "fractional_voigt": parallel(Spring(2.0), Springpot(0.5, 0.6)),
    "fractional_maxwell": series(Spring(2.0), Springpot(0.5, 0.6)),
    "fractional_zener": series(Spring(1.0), parallel(Spring(2.0), Springpot(0.5, 0.3))),
    "two_exponents": series(kelvin_voigt(1.0, 1.0), parallel(Springpot(1.0, 0.3), Dashpot(2.0))),
}
ALL = {**EXACT, **FRACTIONAL}


@pytest.mark.parametrize("name", ALL)
def test_relaxation_and_creep_are_inverse(name):
    """∫₀ᵗ G(t − s) J(s) ds = t, the impulse of G included."""
    network = ALL[name]
    nodes, weights = np.polynomial.legendre.leggauss(12)
    edges = np.r_[0.0, np.geomspace(1e-12, np.pi / 4, 40)]  # s = t sin²x or t cos²x
    half = np.diff(edges)[:, None] / 2
    x = (edges[:-1, None] + half * (1 + nodes)).ravel()
    weight = (half * weights).ravel() * np.sin(2 * x)
    for t in (0.01, 1.0, 40.0):
        ends = t * np.cos(x) ** 2, t * np.sin(x) ** 2
        modulus = [compute_relaxation_modulus_array(network, end)[1] for end in ends]
        creep = [compute_creep_compliance_array(network, end) for end in ends]
        impulse, _ = compute_relaxation_modulus_array(network, t)
        total = t * weight @ (modulus[0] * creep[1] + modulus[1] * creep[0])
        total += impulse * compute_creep_compliance_array(network, t)
        np.testing.assert_allclose(total, t, rtol=1e-8)


LOAD = (np.array([0.5, 0.5, 2.0, 3.0, 3.0, 5.0]), np.array([0.0, 1.0, 2.0, 2.0, -0.5, 1.0]))


@pytest.mark.parametrize("name", ALL)
def test_response_is_boltzmanns_superposition(name):
    network = ALL[name]
    steps = [(0.5, 1.0), (3.0, -2.5)]
    ramps = [(0.5, 2.0, 2 / 3), (3.0, 5.0, 0.75)]
    for t in (0.8, 2.9, 4.0, 9.0):

        def creep(since):
            return float(compute_creep_compliance_array(network, since))

        expected = sum(torque * creep(t - at) for at, torque in steps if t > at)
        for start, end, slope in ramps:
            if t > start:
                ends = (max(t - end, 0.0) ** 0.5, (t - start) ** 0.5)
                expected += slope * quad(lambda r: 2 * r * creep(r * r), *ends, epsabs=1e-12)[0]
        found = compute_network_response_array(network, [t], *LOAD)
        np.testing.assert_allclose(found, expected, rtol=1e-8)


def integrate(rate, angle, size):
    """Step x' = rate(x, torque) by Radau from knot to knot; the angles at TIME."""
    state, angles = np.zeros(size), []
    for start, end in ((0.5, 2.0), (2.0, 3.0), (3.0, 5.0), (5.0, 9.0)):
        inside = TIME[(start <= TIME) & (end > TIME)]
        solution = solve_ivp(
            lambda t, x: rate(x, evaluate_load_array([t], *LOAD)[0]),
            (start, end - 1e-12), state, "Radau", np.r_[inside, end - 1e-12],
            rtol=1e-10, atol=1e-12,
        )  # fmt: skip
        torque = evaluate_load_array(inside, *LOAD)
        angles.append(angle(solution.y[:, : inside.size], torque))
        state = solution.y[:, -1]
    return np.concatenate(angles)


TIME = np.linspace(0.5, 8.0, 16)
K, C = np.array([1.0, 2.0, 3.0]), np.array([0.1, 1.0, 30.0])
# The models written out anew: rate of the inner states, angle, number of states.
EQUATIONS = {
    "maxwell": (lambda x, u: [u / 3.0], lambda x, u: u / 2.0 + x[0], 1),
    "kelvin_voigt": (lambda x, u: [(u - 2.0 * x[0]) / 3.0], lambda x, u: x[0], 1),
    "zener": (lambda x, u: [(u - 2.0 * x[0]) / 3.0], lambda x, u: u / 1.0 + x[0], 1),
    "three_element": (
        lambda x, u: [(u - 0.1 * x[0]) / 0.02, u / 20.0], lambda x, u: x[0] + x[1], 2,
    ),
    "burgers": (
        lambda x, u: [(u - 2.0 * x[0]) / 3.0, u / 4.0], lambda x, u: u / 1.0 + x[0] + x[1], 2,
    ),
    "generalised_maxwell": (
        lambda x, u: K * ((u + K @ x) / (1.0 + K.sum()) - x) / C,
        lambda x, u: (u + K @ x) / (1.0 + K.sum()), 3,
    ),
    "generalised_voigt": (lambda x, u: (u - K * x) / C, lambda x, u: u / 1.0 + x.sum(axis=0), 3),
}  # fmt: skip


@pytest.mark.parametrize("name", EQUATIONS)
def test_response_solves_the_models_equations(name):
    found = compute_network_response_array(EXACT[name], TIME, *LOAD)
    np.testing.assert_allclose(found, integrate(*EQUATIONS[name]), atol=1e-8)


def test_the_papers_joint_solves_its_differential_equation():
    """c_v c_p q̇ + c_p k_v q = (c_v + c_p) τ + k_v ∫τ dt, as printed."""
    k_v, c_v, c_p = 0.1, 0.02, 20.0

    def rate(x, torque):
        push = (c_v + c_p) * torque + k_v * x[1] - c_p * k_v * x[0]
        return [push / (c_v * c_p), torque]

    found = compute_network_response_array(three_element(k_v, c_v, c_p), TIME, *LOAD)
    np.testing.assert_allclose(found, integrate(rate, lambda x, _: x[0], 2), atol=1e-7)


@pytest.mark.parametrize("name", ["maxwell", "zener", "burgers", "generalised_maxwell"])
def test_the_first_instant_is_elastic(name):
    creep = compute_creep_compliance_array(EXACT[name], 0.0)
    impulse, relaxation = compute_relaxation_modulus_array(EXACT[name], 1e-300)
    assert impulse == 0.0
    np.testing.assert_allclose(creep * relaxation, 1.0, rtol=1e-12)
