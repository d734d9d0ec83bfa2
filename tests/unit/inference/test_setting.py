from types import SimpleNamespace

import numpy as np

from softfinger.campaign.load_log import build_load_array
from softfinger.inference.setting import find_first_seen, find_step_gap


def find_gap(*rows):
    time, load = build_load_array(*np.array(rows, float).T, step_within=0.05)
    return find_step_gap(
        SimpleNamespace(load_time=time[None], load_torque=load[None], interval=0.05 / 1.5)
    )


def test_the_two_rows_of_a_step_say_how_well_its_time_is_known():
    assert np.isclose(find_gap((0, 0), (0.98, 0), (1.0, 5.0), (4.0, 5.0)), 0.02)
    assert np.isclose(find_gap((0, 0), (0.98, 0), (1.0, 5.0), (3.99, 5.0), (4.0, 0.0)), 0.02)


def test_a_step_of_its_own_time_leaves_no_gap():
    assert find_gap((0, 0), (1.0, 0), (1.0, 5.0), (4.0, 5.0)) == 0.0  # stated twice
    assert find_gap((1.0, 5.0), (4.0, 5.0)) == 0.0  # the first row
    assert find_gap((0, 0), (2.0, 5.0), (4.0, 0.0)) == 0.0  # slow ramps


def test_frames_that_come_denser_after_a_load_are_seen():
    trials = SimpleNamespace(
        load_time=np.array([[0.0, 1.0, 1.0, 9.0]] * 3),
        load_torque=np.array([[0.0, 0.0, 2.0, 2.0]] * 3),
    )
    dense = np.array([0.5, 1.02, 1.05, 1.2, 2.0, 5.0])
    sparse = np.array([0.5, 1.5, 2.5, 3.5, np.nan, np.nan])
    assert np.isclose(find_first_seen(np.stack([dense, dense, sparse]), trials), 0.05)
    assert np.isclose(find_first_seen(np.stack([dense, sparse, sparse]), trials), 1.5)


def test_without_a_load_or_frames_after_it_nothing_is_known():
    idle = SimpleNamespace(load_time=np.zeros((1, 2)), load_torque=np.zeros((1, 2)))
    assert find_first_seen(np.array([[0.1, 0.2, 0.3]]), idle) == 0.0
    late = SimpleNamespace(load_time=np.array([[0.0, 5.0]]), load_torque=np.array([[0.0, 2.0]]))
    assert find_first_seen(np.array([[0.1, 0.2, 5.1]]), late) == 0.0
