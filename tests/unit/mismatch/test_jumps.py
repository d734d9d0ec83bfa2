import pytest

from softfinger.mismatch.jumps import find_jumps
from softfinger.mismatch.problem import Candidate, pose_problem


def look(angles):
    problem, fit = pose_problem(angles)
    return find_jumps(problem, Candidate(problem.base, fit, fit.log_evidence))


def test_a_slip_in_two_trials_is_found_there(draw_campaign):
    angles = draw_campaign(3, 0.0)
    for trial, frame in ((1, 60), (4, 30)):
        angles["joint_angle"][trial, 0, frame:] += 0.02
    jumps = look(angles)
    assert jumps.gain > 20.0
    assert jumps.trials == ["t1", "t4"]
    assert jumps.joints == [1]


@pytest.mark.parametrize("seed", [3, 4])
def test_noise_holds_no_jump(draw_campaign, seed):
    jumps = look(draw_campaign(seed, 0.0))
    assert jumps.gain < 4.6
    assert jumps.trials == []


@pytest.mark.parametrize("frame", [1, 2, 4])
def test_an_outlier_is_no_jump(draw_campaign, frame):
    angles = draw_campaign(3, 0.0)
    angles["joint_angle"][2, 0, frame] += 0.02
    jumps = look(angles)
    assert jumps.gain < 4.6
    assert jumps.trials == []
