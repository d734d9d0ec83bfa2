import numpy as np
import pytest

from softfinger.mechanics.chain import compute_inertia_coefficients, fill_slopes
from softfinger.mechanics.geometry import FingerGeometry


@pytest.fixture(params=[1, 2, 4])
def finger(request):
    n = request.param
    rng = np.random.default_rng(n)
    length, mass = rng.uniform(0.02, 0.04, n), rng.uniform(0.002, 0.006, n)
    geometry = FingerGeometry(length, mass, 0.4 * length, 0.1 * mass * length**2, 0.008, 0.005)
    angle, velocity = rng.normal(size=(2, n))
    return geometry, compute_inertia_coefficients(geometry), angle, velocity


def kinetic_energy(geometry, angle, velocity):
    """From positions, by their definition: an independent route to M."""
    step = 1e-30j

    def centres(q):
        direction = np.cumsum(q)
        along = np.cos(direction), np.sin(direction)
        joints = [np.r_[0.0, np.cumsum(geometry.link_length * part)[:-1]] for part in along]
        return [j + geometry.link_centre * part for j, part in zip(joints, along, strict=True)]

    x, y = (part.imag / step.imag for part in centres(angle + step * velocity))
    spin = np.cumsum(velocity)
    return 0.5 * (geometry.link_mass * (x**2 + y**2) + geometry.link_inertia * spin**2).sum()


def test_inertia_matrix_gives_the_kinetic_energy(finger, evaluate_chain):
    geometry, coefficients, angle, velocity = finger
    matrix = evaluate_chain(angle, velocity, coefficients)[0]
    np.testing.assert_allclose(
        0.5 * velocity @ matrix @ velocity, kinetic_energy(geometry, angle, velocity), rtol=1e-13
    )


def test_inertia_matrix_is_symmetric_and_positive(finger, evaluate_chain):
    _, coefficients, angle, velocity = finger
    matrix = evaluate_chain(angle, velocity, coefficients)[0]
    np.testing.assert_allclose(matrix, matrix.T, rtol=1e-14)
    assert (np.linalg.eigvalsh(matrix) > 0.0).all()


def derivative(function, angle):
    """d function / d angle, last axis; central differences of order 4."""
    step = 1e-3
    columns = []
    for unit in step * np.eye(angle.size):
        near = function(angle + unit) - function(angle - unit)
        far = function(angle + 2 * unit) - function(angle - 2 * unit)
        columns.append((8 * near - far) / (12 * step))
    return np.stack(columns, axis=-1)


def test_nonlinear_term_is_that_of_christoffel_and_makes_no_energy(finger, evaluate_chain):
    _, coefficients, angle, velocity = finger
    slope = derivative(lambda q: evaluate_chain(q, velocity, coefficients)[0], angle)
    rate = slope @ velocity
    coriolis = 0.5 * (
        rate + np.einsum("ikj,k->ij", slope, velocity) - np.einsum("jki,k->ij", slope, velocity)
    )
    term = evaluate_chain(angle, velocity, coefficients)[1]
    scale = np.abs(coefficients).max()
    np.testing.assert_allclose(term, coriolis @ velocity, atol=1e-10 * scale)
    skew = rate - 2 * coriolis
    np.testing.assert_allclose(skew, -skew.T, atol=1e-10 * scale)
    assert abs(velocity @ (0.5 * rate @ velocity - term)) < 1e-10 * scale


def test_slopes_are_the_limits_of_differences(finger, evaluate_chain):
    _, coefficients, angle, velocity = finger
    acceleration = np.random.default_rng(9).normal(size=angle.size)
    by_angle, by_velocity = np.empty((2, angle.size, angle.size))
    fill_slopes(angle, velocity, acceleration, coefficients, by_angle, by_velocity)

    def torque(q):
        matrix, term = evaluate_chain(q, velocity, coefficients)
        return matrix @ acceleration + term

    scale = np.abs(coefficients).max()
    np.testing.assert_allclose(by_angle, derivative(torque, angle), atol=1e-9 * scale)
    expected = derivative(lambda w: evaluate_chain(angle, w, coefficients)[1], velocity)
    np.testing.assert_allclose(by_velocity, expected, atol=1e-9 * scale)
