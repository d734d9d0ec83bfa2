import numpy as np
import pytest
from scipy.signal import lfilter

from softfinger.tracking.outliers import find_jumps_array, find_stale_array

TIME = np.arange(240) * 0.03
NO_JUMPS = np.array([])


def ring(frequency, decay=1.2, amplitude=0.4, start=1.5):
    after = np.maximum(TIME - start, 0.0)
    swing = np.exp(-after * decay) * np.cos(2 * np.pi * frequency * after)
    return amplitude * (1.0 - swing) * (start <= TIME)


@pytest.mark.parametrize("frequency", [0.5, 1.7, 3.4, 5.6])
@pytest.mark.parametrize("known", [True, False])
def test_a_ring_after_a_step_is_left_alone(frequency, known, rng):
    value = ring(frequency) + 0.002 * rng.standard_normal(TIME.size)
    assert not find_jumps_array(TIME, value, np.array([1.5]) if known else NO_JUMPS).any()


@pytest.mark.parametrize("frequency", [1.7, 3.4])
def test_a_ring_seen_by_a_slow_camera_is_left_alone(frequency, rng):
    value = ring(frequency) + 0.002 * rng.standard_normal(TIME.size)
    held = value[np.sort(rng.choice(TIME.size, 150, replace=False))]
    shown = held[np.minimum(np.arange(TIME.size) * 150 // TIME.size, 149)]
    assert not find_jumps_array(TIME, shown, NO_JUMPS).any()


@pytest.mark.parametrize("runs", [[(40, 1)], [(60, 4), (70, 15)], [(56, 2), (59, 1), (62, 3)]])
def test_false_blobs_are_found_and_nothing_else(runs, rng):
    value = ring(3.4, amplitude=0.1) + 0.002 * rng.standard_normal(TIME.size)
    false = np.zeros(TIME.size, bool)
    for start, length in runs:
        false[start : start + length] = True
    value[false] = -1.13
    np.testing.assert_array_equal(find_jumps_array(TIME, value, np.array([1.5])), false)


def test_a_step_that_stays_is_motion(rng):
    value = np.where(TIME > 3.0, 0.5, 0.0) + 0.001 * rng.standard_normal(TIME.size)
    assert not find_jumps_array(TIME, value, NO_JUMPS).any()


def test_a_short_pulse_of_the_load_is_motion_but_not_without_a_load(rng):
    value = 0.5 * ((TIME > 2.99) & (TIME < 3.29)) + 0.001 * rng.standard_normal(TIME.size)
    assert not find_jumps_array(TIME, value, np.array([3.0, 3.3])).any()
    assert find_jumps_array(TIME, value, NO_JUMPS).sum() == 10


def test_a_path_in_the_plane_is_judged_whole(rng):
    path = np.stack([50.0 * TIME, 20.0 * np.sin(TIME)], axis=1)
    path += 0.02 * rng.standard_normal(path.shape)
    path[100:103] = [430.0, 381.0]
    np.testing.assert_array_equal(
        np.flatnonzero(find_jumps_array(TIME, path, NO_JUMPS)), [100, 101, 102]
    )


def test_gaps_are_no_jumps(rng):
    value = ring(1.7) + 0.002 * rng.standard_normal(TIME.size)
    value[30:45] = np.nan
    value[90] = 3.0
    np.testing.assert_array_equal(np.flatnonzero(find_jumps_array(TIME, value, NO_JUMPS)), [90])
    assert not find_jumps_array(TIME, np.full(TIME.size, np.nan), NO_JUMPS).any()


def test_slow_drifting_noise_holds_no_jumps(rng):
    white = 0.002 * rng.standard_normal((40, TIME.size))
    slow = lfilter([0.3], [1.0, -0.95], white, axis=1)
    found = [find_jumps_array(TIME, value, NO_JUMPS).any() for value in white + slow]
    assert sum(found) == 0


def test_repeated_frames_are_stale_in_all_channels_at_once(rng):
    angle = np.cumsum(rng.standard_normal((2, 80)), axis=1)
    angle[:, 30:33] = angle[:, [29]]
    angle[0, 50] = angle[0, 49]
    np.testing.assert_array_equal(np.flatnonzero(find_stale_array(angle)), [30, 31, 32])


def test_rounding_is_not_a_repeated_frame(rng):
    angle = np.round(np.cumsum(0.001 * rng.standard_normal((1, 400)), axis=1), 2)
    assert (np.diff(angle) == 0).mean() > 0.5
    assert not find_stale_array(angle).any()


def test_a_gap_is_not_a_repeated_frame(rng):
    angle = rng.standard_normal((2, 60))
    angle[:, 20:25] = np.nan
    angle[0, 40:43] = np.nan
    angle[1, 41] = angle[1, 40]
    np.testing.assert_array_equal(np.flatnonzero(find_stale_array(angle)), [41])
