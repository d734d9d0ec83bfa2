"""A free response moves the finger as delayed loads do, on average."""

import numpy as np
import pytest

from softfinger.mechanics.effects.load_response import EDGES
from softfinger.mechanics.forward.curve import KNOTS
from softfinger.mechanics.forward.simulate import describe_finger, simulate_joint_angle_array
from softfinger.mechanics.forward.slots import build_slots, build_tangent
from softfinger.mechanics.geometry import FingerGeometry

UNIT = 0.05  # s, a frame interval
SHARE = np.array([0.05, 0.1, 0.1, 0.05, 0.1, 0.02, 0.02, 0.01])
TIME = np.linspace(0.0, 9.0, 181)
LOGS = {
    "steps": ([1.0, 4.0, 4.0, 9.0], [0.03, 0.03, 0.01, 0.01], 1e-5),
    "brief ramps": ([1.0, 1.06, 4.0, 4.06, 9.0], [0.0, 0.03, 0.03, 0.01, 0.01], 2e-3),
    "slow ramps": ([1.0, 3.0, 5.0, 9.0], [0.0, 0.03, 0.0, 0.0], 2e-3),
}


def simulate(time, log, slots, directions=()):
    """One joint's angle (n,) and changes (n, direction) under a log."""
    finger = describe_finger(FingerGeometry.uniform([0.025], [0.005], 0.008, 0.005))
    own = np.array([[[-2.4, -3.7, 2.9, 0.02]]])
    series = np.atleast_2d(time), *np.atleast_2d(*log)
    tangents = [build_tangent(1, 1, direction) for direction in directions]
    angle, change = simulate_joint_angle_array(
        own, build_slots(1, 1, slots), tangents, finger, *series, by_own=False, tolerance=1e-8
    )
    return angle[0, 0], change[0, 0]


def respond(share):
    law = np.zeros((1, 1, KNOTS))
    law[0, 0, : len(share)] = share
    return {"response": law, "response_unit": UNIT}


@pytest.mark.parametrize("name", LOGS)
def test_it_is_an_average_of_delayed_motions(name):
    time, load, tolerance = LOGS[name]
    expected = (1.0 - SHARE.sum()) * simulate(TIME, (time, load), {})[0]
    point, weight = np.polynomial.legendre.leggauss(64)
    for share, first, last in zip(SHARE, EDGES, EDGES[1:], strict=False):
        delays = UNIT * (0.5 * (first + last) + 0.5 * (last - first) * point)
        moments = TIME[:, None] - delays
        order = np.argsort(moments, axis=None)
        motion = np.empty(moments.size)
        motion[order] = simulate(moments.ravel()[order], (time, load), {})[0]
        expected += share * motion.reshape(moments.shape) @ weight / 2.0
    angle, _ = simulate(TIME, (time, load), respond(SHARE))
    assert np.abs(angle - expected).max() < tolerance * np.ptp(angle)


@pytest.mark.parametrize("name", LOGS)
@pytest.mark.parametrize("beside", [{}, {"arm_scale": 1.0}])
def test_its_tangents_are_slopes(name, beside):
    time, load, _ = LOGS[name]
    direction = np.arange(1.0, 9.0) / 100.0
    slope = {"response": respond(direction)["response"]}
    _, change = simulate(TIME, (time, load), {**respond(SHARE), **beside}, [slope])
    up, down = (
        simulate(TIME, (time, load), {**respond(SHARE + step * direction), **beside})[0]
        for step in (1e-3, -1e-3)
    )
    np.testing.assert_allclose(change[:, 0], (up - down) / 2e-3, atol=2e-6)
