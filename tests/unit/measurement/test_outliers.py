"""Outliers: how far a frame is from what all others predict."""

import numpy as np

from softfinger.measurement.outliers import measure_distance_array


def test_a_frame_is_not_judged_by_one_whose_time_is_wrong():
    """What a frame beside it may be off by, a frame may seem off by."""
    residual, passed = np.zeros((20, 2)), np.zeros((20, 2))
    residual[10], passed[10] = 0.05, 0.06
    noise = np.full(2, 0.002), np.full(2, 0.9), np.zeros(2), np.eye(2)
    distance, judged = measure_distance_array(residual, np.ones(19), *noise, -passed, passed)
    assert distance[[9, 10, 11]].min() > 100.0
    assert judged.max() == 0.0
    residual[10] = 0.2  # more than its time explains
    judged = measure_distance_array(residual, np.ones(19), *noise, -passed, passed)[1]
    assert judged.argmax() == 10
