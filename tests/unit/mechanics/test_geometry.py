import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.mechanics.geometry import FingerGeometry


def test_uniform_rods():
    geometry = FingerGeometry.uniform([0.02, 0.03], [0.005, 0.004], 0.008, 0.005)
    assert geometry.joints == 2
    np.testing.assert_allclose(geometry.link_centre, [0.01, 0.015])
    np.testing.assert_allclose(geometry.link_inertia, [0.005 * 4e-4 / 12, 0.004 * 9e-4 / 12])


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (([0.02, 0.0], [0.005, 0.004], 0.008, 0.005), r"link_length\[1\] = 0: .* positive.*\[m\]"),
        (([0.02], [np.nan], 0.008, 0.005), r"link_mass\[0\] = nan"),
        (([0.02], [0.005], 0.0, 0.005), "joint_length = 0"),
        (([0.02], [0.005], 0.008, -0.005), "wire_offset = -0.005"),
        (([0.02, 0.03, 0.03], [0.005, 0.004], 0.008, 0.005), "one value for each of the 3 links"),
    ],
)
def test_impossible_fingers_are_refused(arguments, sentence):
    with pytest.raises(Fault, match=sentence):
        FingerGeometry.uniform(*arguments)
