"""Masses that links may have, and those that none have."""

import numpy as np
import pytest

from softfinger.mechanics.chain import compute_inertia_coefficients
from softfinger.mechanics.forward.simulate import describe_finger, simulate_joint_angle_array
from softfinger.mechanics.forward.slots import build_slots
from softfinger.mechanics.geometry import FingerGeometry

GEOMETRY = FingerGeometry.uniform([0.025] * 3, [0.005] * 3, 0.008, 0.005)
COARSE = {"tolerance": np.inf, "longest_step": 0.02}


def move(own, moment, end=2e-3, **settings):
    """Angles (joint, time) [rad] under one step of the load."""
    one = np.log([0.1, 0.015, 20.0])
    parameters = np.tile(np.append(one, 0.02), (1, 3, 1))
    shares = {"inertia_own_share": [own], "inertia_moment_share": [moment]}
    slots = build_slots(1, 3, {"inertia_scale": 1.0, **shares})
    finger = describe_finger(GEOMETRY)
    angle, _ = simulate_joint_angle_array(
        parameters, slots, [], finger, np.linspace(0.0, end, 9), [0.0, end], [0.03, 0.03],
        **settings,
    )  # fmt: skip
    return angle[0]


def find_least(own, moment):
    """Least eigenvalue [kg m²] of the kinetic energy's constants."""
    carried = np.maximum.outer(np.arange(3), np.arange(3))
    share = np.where(np.eye(3, dtype=bool), np.array(own), np.array(moment)[carried])
    return np.linalg.eigvalsh(compute_inertia_coefficients(GEOMETRY) * (1.0 + share)).min()


@pytest.mark.parametrize("own", [[0.2, -0.3, 0.0], [0.0, 0.0, -0.7], [-0.6, 0.0, 0.0]])
def test_links_that_no_masses_make_have_no_motion(own):
    """A fit of three trials had such links; coarse steps went over their end, fine ones did not."""
    assert find_least(own, [0.0, 0.0, 0.0]) < 0.0
    assert np.isnan(move(own, [0.0, 0.0, 0.0])).all()
    assert np.isnan(move(own, [0.0, 0.0, 0.0], 2.0, **COARSE)).all()


@pytest.mark.parametrize("own", [[0.4, -0.05, 0.0], [0.0, 0.3, 0.5], [0.0, 0.0, 0.0]])
def test_links_of_any_other_masses_move_alike_by_coarse_steps_and_by_fine(own):
    assert find_least(own, [0.0, 0.0, 0.0]) > 0.0
    coarse = move(own, [0.0, 0.0, 0.0])
    fine = move(own, [0.0, 0.0, 0.0], tolerance=np.inf, longest_step=2e-6)
    assert np.ptp(fine, axis=1).min() > 1e-5
    np.testing.assert_allclose(coarse, fine, atol=2e-6)


def test_a_payload_beyond_what_its_link_can_carry_has_no_motion():
    heavy = [0.0, 0.0, 1.5]
    assert find_least([0.0, 0.0, 0.0], heavy) < 0.0
    assert np.isnan(move([0.0, 0.0, 0.0], heavy, 2.0, **COARSE)).all()
