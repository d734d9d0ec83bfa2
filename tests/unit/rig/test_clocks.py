import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.rig.clocks import estimate_clock_offset, fit_frame_clock

STAMP = np.arange(10.0, 10.5, 0.05)
LIT = np.array([9, 9, 99, 99, 99, 9, 9, 9, 9, 9.0])


def test_the_offset_lies_where_all_edges_allow_it():
    offset, uncertainty = estimate_clock_offset(STAMP, LIT, [0.06, 0.22])
    # on within (10.05, 10.1], off within (10.2, 10.25]
    assert (offset - uncertainty, offset + uncertainty) == pytest.approx((9.99, 10.03))


def test_stamps_that_jitter_widen_the_uncertainty():
    shaken = STAMP.copy()
    shaken[2], shaken[4] = 10.07, 10.23  # no offset fits both edges any more
    offset, uncertainty = estimate_clock_offset(shaken, LIT, [0.06, 0.215])
    assert offset == pytest.approx(10.0125)
    assert uncertainty == pytest.approx(0.0025)


@pytest.mark.parametrize(
    ("brightness", "said"),
    [
        (
            np.array([9, 9, 20, 20, 20, 9, 9, 9, 9, 9.0]),
            "not seen: .* between 9 and 20 grey over 10",
        ),
        (np.array([9, 9, 99, 99, 9, 9, 99, 99, 9, 9.0]), "switched 2 times but seen to change 4"),
        (np.array([99, 99, 9, 9, 9, 99, 99, 99, 99, 99.0]), "other light"),
        (np.zeros(0), "over 0 frames"),
    ],
)
def test_a_light_that_does_not_flash_as_switched_is_a_fault(brightness, said):
    with pytest.raises(Fault, match=said):
        estimate_clock_offset(STAMP[: brightness.size], brightness, [0.06, 0.22])


def test_the_beat_survives_lost_frames_and_jitter():
    rng = np.random.default_rng(3)
    kept = np.flatnonzero(rng.random(300) > 0.2)
    stamp = 50.0 + kept / 29.9 + rng.normal(0.0, 0.003, kept.size)
    clock = fit_frame_clock(stamp, 30.0)
    np.testing.assert_array_equal(clock.slot, kept - kept[0])
    assert clock.rate == pytest.approx(29.9, rel=2e-4)
    assert clock.start == pytest.approx(50.0 + kept[0] / 29.9, abs=0.001)
    assert clock.jitter == pytest.approx(0.003, rel=0.2)


@pytest.mark.parametrize(
    ("stamp", "said"), [([1.0], "took 1 frames"), ([0, 0.102], "9.804 frames")]
)
def test_a_camera_at_the_wrong_rate_is_a_fault(stamp, said):
    with pytest.raises(Fault, match=said):
        fit_frame_clock(np.array(stamp), 10.0)
