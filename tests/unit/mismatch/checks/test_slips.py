import numpy as np
import pytest

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.measurement.memory import Memory, whiten_array
from softfinger.mismatch.checks.slips import (
    Series,
    find_slips,
    project_outliers,
    project_steps,
    weigh_shapes,
)


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


def test_projections_are_those_of_whitened_columns():
    rng = np.random.default_rng(1)
    n, rho = 30, 0.9
    gap = np.concatenate([[np.inf], rng.uniform(0.5, 3.0, n - 1)])
    carried = np.where(np.isfinite(gap), rho**gap, 0.0)
    rows = rng.normal(size=(n, 5))
    series = Series(
        rows, (1 - carried**2) ** -0.5, carried, np.zeros(4), np.eye(4), np.ones(n, bool)
    )
    place = np.cumsum(np.where(np.isfinite(gap), gap, 0.0))
    later = np.arange(n)[:, None] >= np.arange(n)
    decay = np.where(later, rho ** np.maximum(place[:, None] - place, 0.0), 0.0)
    found = [project_steps(series), *project_outliers(series)]
    for (product, square), shapes in zip(found, (1.0 * later, np.eye(n), decay), strict=True):
        white, _ = whiten_array(shapes, gap, Memory(rho))
        np.testing.assert_allclose(product, white.T @ rows, atol=1e-10)
        np.testing.assert_allclose(square, (white**2).sum(axis=0), atol=1e-10)


def test_a_leap_of_one_step_of_rounding_is_no_slip():
    rng = np.random.default_rng(2)
    n, step = 200, 4.0
    left = 0.1 * rng.normal(size=n)
    left[120:] += step
    rows = np.column_stack([np.zeros((n, 4)), left])
    none = np.zeros(n)
    series = Series(rows, 1.0 + none, none, np.zeros(4), np.eye(4), np.ones(n, bool))
    sizes = np.array([5.0])
    shape = project_steps(series)
    assert weigh_shapes(series, *shape, sizes) > 100.0
    rounded = series._replace(step=step)
    assert weigh_shapes(rounded, *shape, sizes) < 0.0
    rows[120:, -1] += step  # twice as far as rounding takes it
    assert weigh_shapes(rounded, *project_steps(rounded), sizes) > 100.0
