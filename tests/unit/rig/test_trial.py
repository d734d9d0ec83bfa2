import dataclasses

import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.rig.camera import StampedPicture
from softfinger.rig.clocks import ClockOffset
from softfinger.rig.controller import Sample
from softfinger.rig.trial import Pull, assemble_trial

OFFSET = ClockOffset(100.0, 0.002)
FPS = 30.0  # the plan's


def pull(lost=()):
    """Armed at 7 s, pulled from 8 s to 9 s; frames from 107.01 s on; lead-in 0.5 s."""
    frames = [StampedPicture(107.01 + k / FPS, 0.0, b"%d" % k) for k in range(75) if k not in lost]
    samples = [Sample(7.0 + 0.1 * k, 8.0 * (k >= 10), 0.4) for k in range(21)]
    return Pull(8.0, 9.0, samples, frames)


def test_frames_and_samples_share_one_time(plan):
    trial = assemble_trial(pull(), OFFSET, OFFSET, plan)
    # the first frame within the lead-in is number 15, at 107.51 s: 0.49 s before the start
    assert trial.pictures == [b"%d" % k for k in range(15, 60)]
    assert trial.load_start == pytest.approx(0.49)
    assert trial.sample_time[10] == pytest.approx(0.49)
    assert trial.tension[10] == 8.0
    assert trial.rate == pytest.approx(FPS)
    assert trial.n_dropped == 0


def test_a_lost_frame_is_replaced_by_the_one_before_it(plan):
    trial = assemble_trial(pull(lost=(20, 21)), OFFSET, OFFSET, plan)
    assert trial.pictures[4:8] == [b"19", b"19", b"19", b"22"]
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(trial.stamp)), [5, 6])
    assert len(trial.pictures) == 45


def test_too_many_lost_frames_spoil_a_trial(plan):
    with pytest.raises(Fault, match=r"lost 3 of 45 frames, more than the share .* 0.05"):
        assemble_trial(pull(lost=(20, 21, 22)), OFFSET, OFFSET, plan)


def test_a_pull_without_its_last_samples_is_refused(plan):
    cut = dataclasses.replace(pull(), samples=pull().samples[:15])
    with pytest.raises(Fault, match=r"sampled for 0.40 s of a pull of 1.00 s"):
        assemble_trial(cut, OFFSET, OFFSET, plan)
