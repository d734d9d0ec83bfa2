import numpy as np
import pytest

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.measurement.memory import Memory, whiten_array
from softfinger.mismatch.checks.onsets import project_onsets
from softfinger.mismatch.checks.slips import Series, find_slips, weigh_shapes


def look(angles):
    problem, fit = pose_problem(angles)
    return find_slips(problem, Candidate(problem.base, fit, fit.log_evidence), angles)


def test_a_slip_in_two_trials_is_found_there(draw_campaign):
    angles = draw_campaign(3, 0.0)
    for trial, frame in ((1, 60), (4, 30)):
        angles["joint_angle"][trial, 0, frame:] += 0.02
    slips = look(angles)
    assert slips.gain > 20.0
    assert slips.trials == ["t1", "t4"]
    assert slips.joints == [1]


@pytest.mark.parametrize("seed", [3, 4])
def test_noise_holds_no_jump(draw_campaign, seed):
    slips = look(draw_campaign(seed, 0.0))
    assert slips.gain < 4.6
    assert slips.trials == []


@pytest.mark.parametrize("frame", [1, 2, 4])
def test_an_outlier_is_no_jump(draw_campaign, frame):
    angles = draw_campaign(3, 0.0)
    angles["joint_angle"][2, 0, frame] += 0.02
    slips = look(angles)
    assert slips.gain < 4.6
    assert slips.trials == []


@pytest.mark.parametrize(("last", "slips"), [(3, False), (40, True)])
def test_a_few_frames_at_the_end_are_no_slip(draw_campaign, last, slips):
    angles = draw_campaign(3, 0.0)
    angles["joint_angle"][2, 0, -last:] += 0.008
    assert (look(angles).trials == ["t2"]) == slips


def test_a_slip_is_found_in_noise_that_lasts(draw_campaign):
    angles = draw_campaign(3, 0.0, rho=0.95)
    for trial, frame in ((1, 60), (2, 45), (4, 30), (6, 70)):
        angles["joint_angle"][trial, 0, frame:] += 0.02
    slips = look(angles)
    assert slips.gain > 10.0
    assert set(slips.trials) <= {"t1", "t2", "t4", "t6"}


def test_one_large_innovation_of_lasting_noise_is_no_jump(draw_campaign):
    angles = draw_campaign(3, 0.0, rho=0.8)
    for trial in (1, 2, 4, 6):
        angles["joint_angle"][trial, 0, 60:] += 0.01 * 0.8 ** np.arange(100)
    slips = look(angles)
    assert slips.gain < 4.6
    assert slips.trials == []


def test_what_wanders_slowly_beneath_white_noise_is_no_slip():
    own, neighbours = Memory(0.97, 0.45), Memory(0.97 * 0.55)
    n, sizes = 600, np.array([1.0, 3.0, 10.0])
    gap = np.append(np.inf, np.ones(n - 1))
    inverse = whiten_array(np.eye(n), gap, own)[0]
    evidence = {own: 0.0, neighbours: 0.0}
    for seed in range(6):
        left = np.linalg.solve(inverse, np.random.default_rng(seed).normal(size=n))
        for memory in evidence:
            rows, _ = whiten_array(np.column_stack([np.zeros((n, 4)), left]), gap, memory)
            series = Series(rows, np.zeros(4), np.eye(4), np.ones(n, bool))
            step, *_ = project_onsets(rows, np.ones(n), gap, memory)
            evidence[memory] += weigh_shapes(series, *step, sizes)
    assert evidence[own] < 0.0
    assert evidence[neighbours] > 20.0  # what the frame before alone predicts is not enough


@pytest.mark.parametrize("memory", [Memory(0.9), Memory(0.95, 0.4), Memory(0.0, 0.3)])
def test_onsets_are_those_of_whitened_columns(memory):
    rng = np.random.default_rng(1)
    n = 30
    gap = np.concatenate([[np.inf], rng.uniform(0.5, 3.0, n - 1)])
    rows, size = rng.normal(size=(n, 5)), rng.uniform(0.3, 2.0, n)
    place = np.cumsum(np.where(np.isfinite(gap), gap, 0.0))
    later = np.arange(n)[:, None] >= np.arange(n)
    apart = np.maximum(place[:, None] - place, 0.0)
    decay = np.where(later, memory.autocorrelation**apart, 0.0)
    shapes = size[:, None] * later, np.diag(size), size * decay
    for found, columns in zip(project_onsets(rows, size, gap, memory), shapes, strict=True):
        white, _ = whiten_array(columns, gap, memory)
        np.testing.assert_allclose(found.product, white.T @ rows, atol=1e-10)
        np.testing.assert_allclose(found.square, (white**2).sum(axis=0), atol=1e-10)


def test_a_leap_of_one_step_of_rounding_is_no_slip():
    rng = np.random.default_rng(2)
    n, step = 200, 4.0
    left = 0.1 * rng.normal(size=n)
    left[120:] += step
    rows = np.column_stack([np.zeros((n, 4)), left])
    one, sizes = np.ones(n), np.array([5.0])
    series = Series(rows, np.zeros(4), np.eye(4), np.ones(n, bool))
    shape, *_ = project_onsets(rows, one, one, Memory(0.0))
    assert weigh_shapes(series, *shape, sizes) > 100.0
    rounded = series._replace(step=step)
    assert weigh_shapes(rounded, *shape, sizes) < 0.0
    rows[120:, -1] += step  # twice as far as rounding takes it
    shape, *_ = project_onsets(rows, one, one, Memory(0.0))
    assert weigh_shapes(rounded, *shape, sizes) > 100.0
