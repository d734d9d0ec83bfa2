"""Protocols keep within load, rate, time and knots; limits that allow nothing are refused."""

import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.mismatch.experiment.choice import choose_best, hold_angle
from softfinger.mismatch.experiment.limits import RigLimits, check_limits, limit_rate
from softfinger.mismatch.experiment.protocols import PlannedProtocol
from softfinger.mismatch.experiment.shapes import build_protocol, list_generic, list_shapes

LIMITS = RigLimits(0.04, 1.5, 0.01, 10.0, 10, 20.0, 0.05, 500)


@pytest.mark.parametrize("name", list(list_shapes()))
@pytest.mark.parametrize("rate", [0.01, np.inf])
def test_every_protocol_keeps_within_the_limits(name, rate):
    limits = LIMITS._replace(rate=rate)
    for place in (0.0, 0.4, 1.0):
        size = len(list_shapes()[name].parameters)
        time, load = build_protocol(name, np.full(size, place), limits)
        assert time.shape == load.shape
        assert (time[:, 0] == 0.0).all()
        np.testing.assert_allclose(time[:, -1], limits.duration)
        assert (np.diff(time, axis=1) >= 0.0).all()
        assert load.min() >= 0.0
        assert load.max() <= limits.load * (1 + 1e-12)
        if np.isfinite(rate):
            fastest = rate * np.diff(time, axis=1) + 1e-12
            assert (np.abs(np.diff(load, axis=1)) <= fastest).all()
        assert time.shape[1] <= limits.knots


def test_a_load_that_may_not_jump_arrives_late_and_then_is_the_same():
    time, load = limit_rate(np.array([0.0, 10.0]), np.array([3.0, 3.0]), 1.5)
    np.testing.assert_allclose(np.interp([1.0, 2.0, 9.0], time, load), [1.5, 3.0, 3.0])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"load": 0.0}, "--max-load"),
        ({"rate": -1.0}, "--max-rate"),
        ({"angle": 0.01}, "without load"),
        ({"minutes": 1.0}, "give 3.5"),
        ({"trials": 0}, "--trials"),
    ],
)
def test_limits_that_allow_nothing_are_refused_in_a_sentence(change, words):
    with pytest.raises(Fault, match=words):
        check_limits(LIMITS._replace(**change), at_rest=0.02, least_frames=20)


def test_a_load_is_lowered_until_no_joint_goes_too_far():
    protocol = PlannedProtocol(np.array([[0.0, 40.0]]), np.full((1, 2), 0.04))

    def bend(protocol):
        return 100.0 * protocol.load_torque.max()

    held = hold_angle(protocol, LIMITS, bend)
    assert 0.9 * LIMITS.angle < bend(held) <= LIMITS.angle
    assert hold_angle(protocol, LIMITS, lambda _: 9.0) is None  # whatever the load
    assert hold_angle(protocol, LIMITS._replace(knots=1), bend) is None


def test_the_simplex_goes_beyond_the_places_it_starts_from():
    """What is wanted is a load of 0.03 for half of the time: no protocol that anyone records."""

    def like(protocol):
        time = np.linspace(0.0, LIMITS.duration, 200)
        load = np.interp(time, protocol.load_time[0], protocol.load_torque[0])
        return -float(np.abs(load - np.where(time < LIMITS.duration / 2, 0.03, 0.01)).mean()) * 1e3

    limits = LIMITS._replace(rate=np.inf)
    best = choose_best(limits, like, lambda _: 0.0)
    assert [c.worth for c in best] == sorted((c.worth for c in best), reverse=True)
    assert best[0].worth > max(map(like, list_generic(limits).values()))
