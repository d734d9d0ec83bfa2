"""Moving fingers of the paper's joints."""

import numpy as np

from softfinger.inference.motion import move_paper_joint


def test_a_finger_that_is_not_known_does_not_move_and_stops_no_other():
    """Of one trial, the spread of the two-stage estimate is not known."""
    own = np.log([[[0.1, 0.01, 20.0, 1.03]], [[0.1, 0.01, 20.0, 1.03]]])
    own[1, 0, 0] = np.nan
    series = np.array([5.0, 10.0]), np.array([0.0]), np.array([0.04])
    moved = move_paper_joint(own, np.zeros(2, int), np.zeros(2, int), *series)
    assert np.isfinite(moved[0]).all()
    assert np.isnan(moved[1]).all()
    assert np.isnan(move_paper_joint(own[1:], np.zeros(1, int), np.zeros(1, int), *series)).all()
