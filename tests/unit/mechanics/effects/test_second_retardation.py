"""Elements of a generalised Voigt model, one beside the other."""

import numpy as np
import pytest

from softfinger.mechanics.forward.simulate import describe_finger, simulate_joint_angle_array
from softfinger.mechanics.forward.slots import build_slots
from softfinger.mechanics.geometry import FingerGeometry

FINGER = describe_finger(FingerGeometry.uniform([0.025, 0.02], [0.005, 0.004], 0.008, 0.005))
PARAMETERS = np.array([[[-2.4, -3.7, 2.9, 0.03], [-1.9, -3.9, 3.3, 0.01]]])
TIME, LOAD = np.linspace(0.0, 8.0, 15), ([0.0, 4.0, 4.0], [0.04, 0.04, 0.02])


def bend(**slots):
    return simulate_joint_angle_array(
        PARAMETERS, build_slots(1, 2, slots), [], FINGER, TIME, *LOAD, tolerance=1e-10
    )[0][0]


@pytest.mark.parametrize("own_time", [0.0, 1.0])
def test_two_elements_creep_by_the_sum_of_what_each_does(own_time):
    def creep(time):
        one = bend(second_share=0.2, second_time=time, second_own_time=own_time)
        return one - bend()

    two = bend(
        second_share=0.2, second_time=1.5, second_own_time=own_time,
        second_slow_share=0.3, second_slower=6.0,
    ) - bend()  # fmt: skip
    np.testing.assert_allclose(two, 0.7 * creep(1.5) + 0.3 * creep(9.0), rtol=1e-6, atol=1e-10)
