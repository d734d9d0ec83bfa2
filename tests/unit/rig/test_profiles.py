import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from softfinger.rig.profiles import Profile

BUILD = TypeAdapter(Profile)


@pytest.mark.parametrize(
    ("shape", "time", "tension"),
    [
        ({"shape": "steps", "levels_n": [4, 9], "hold_s": 2}, [0, 2, 2, 4], [4, 4, 9, 9]),
        (
            {"shape": "staircase", "peak_n": 9, "stairs": 3, "hold_s": 1},
            [0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6],
            [3, 3, 6, 6, 9, 9, 6, 6, 3, 3, 0, 0],
        ),
        (
            {"shape": "ramps", "levels_n": [4, 1], "ramp_s": 2, "hold_s": 3},
            [0, 2, 5, 7, 10],
            [0, 4, 4, 1, 1],
        ),
        (
            {"shape": "triangle", "peak_n": 5, "rise_s": 2, "cycles": 2},
            [0, 2, 4, 6, 8],
            [0, 5, 0, 5, 0],
        ),
    ],
)
def test_shapes_have_the_knots_that_one_would_draw(shape, time, tension):
    knots = BUILD.validate_python({"name": "a", **shape}).build_knots()
    np.testing.assert_allclose(knots[0], time)
    np.testing.assert_allclose(knots[1], tension)


def test_a_sine_swings_about_its_mean_from_its_lowest_tension():
    values = {"mean_n": 5, "amplitude_n": 3, "period_s": 4, "cycles": 2}
    time, tension = BUILD.validate_python({"name": "a", "shape": "sine", **values}).build_knots()
    assert time[[0, -1]].tolist() == [0, 8]
    at = [0, 1, 2, 3, 4, 6]
    np.testing.assert_allclose(np.interp(at, time, tension), [2, 5, 8, 5, 2, 8], atol=1e-12)
    fine = np.linspace(0, 8, 1001)
    exact = 5 - 3 * np.cos(np.pi / 2 * fine)
    assert np.abs(np.interp(fine, time, tension) - exact).max() < 0.005 * 3


def test_a_wire_cannot_push():
    with pytest.raises(ValidationError, match="a wire cannot push"):
        BUILD.validate_python(
            {
                "name": "a",
                "shape": "sine",
                "mean_n": 2,
                "amplitude_n": 3,
                "period_s": 4,
                "cycles": 1,
            }
        )
