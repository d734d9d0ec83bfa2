"""What each number that cleans recordings does: the effect of those that no other test shows."""

import numpy as np
import pytest
import xarray as xr

from softfinger.measurement.frames import select_frames
from softfinger.measurement.noise import fit_noise
from softfinger.measurement.outliers import find_outliers, subtract_median_array
from softfinger.measurement.presence import _count_frames, _weigh_tails
from softfinger.measurement.reml import cut_windows
from softfinger.measurement.repeats import _expect_equal, find_step_array


@pytest.fixture
def quiet(make_campaign):
    """One joint at rest under one load, for 30 s in 4 trials; its frames."""
    rng = np.random.default_rng(6)
    angles = make_campaign(rng, 4, 1, time=np.arange(900) / 30, rho=0.0)[0]
    return angles, select_frames(angles)


def test_a_slip_is_no_tail(quiet):
    """One value in a window of 200 far beyond the others makes no Student's t of the noise."""
    angles, frames = quiet
    slipped = angles.assign(joint_angle=angles["joint_angle"].copy(deep=True))
    slipped["joint_angle"][:, 0, 500] += 0.04
    assert _weigh_tails(fit_noise(slipped, frames))["heavy_tails"][1] < 0.0


@pytest.mark.parametrize(("lost", "found"), [(1, False), (2, True)])
def test_few_lost_frames_are_usual(lost, found):
    frames = xr.Dataset({"used": (("trial", "frame"), np.ones((1, 1500), bool))})
    assert bool(_count_frames("lost_frames", lost, frames)) == found


def clean_outliers(make_campaign, share):
    angles = make_campaign(np.random.default_rng(6), 30, 1, time=np.arange(300) / 30, rho=0.0)[0]
    frames = select_frames(angles)
    noise = xr.Dataset(
        {
            "noise_sd": ("joint", [0.003]),
            "noise_autocorrelation": ("joint", [0.0]),
            "noise_white": ("joint", [0.0]),
            "noise_correlation": (("joint", "other_joint"), np.eye(1)),
        }
    )
    residual = 0.003 * np.random.default_rng(7).standard_normal((30, 1, 300))
    count = int(share * 300)
    residual[0, 0, np.linspace(2, 297, count).astype(int)] = 0.1
    return np.count_nonzero(find_outliers(residual, angles, frames, noise)[0]), count


@pytest.mark.parametrize(("share", "kept"), [(0.18, False), (0.25, True)])
def test_a_trial_of_many_outliers_keeps_all(make_campaign, share, kept):
    found, count = clean_outliers(make_campaign, share)
    assert found == (0 if kept else count)


@pytest.mark.parametrize(("length", "stands_out"), [(7, True), (8, False)])
def test_a_short_burst_stands_out_and_a_long_one_does_not(length, stands_out):
    rows = np.zeros((100, 1))
    rows[40 : 40 + length] = 1.0
    left = subtract_median_array(rows, np.ones(99))
    assert (left[40 : 40 + length] == 1.0).all() == stands_out


def test_windows_are_neither_long_nor_short(quiet):
    angles, frames = quiet
    sizes = np.diff(cut_windows(angles, frames)[0].start)
    assert 150 < sizes.max() <= 200


@pytest.mark.parametrize(("count", "step"), [(19, 0.0), (20, 0.5)])
def test_few_values_show_no_step(count, step):
    assert find_step_array(0.5 * np.arange(count)) == step


@pytest.mark.parametrize(("distinct", "shown"), [(3, False), (4, True)])
def test_what_is_held_shows_no_step(distinct, shown):
    """Three even gaps are no accident; fewer are, unless a value comes back."""
    held = np.repeat(0.1 * np.arange(distinct), 20)
    assert np.isfinite(_expect_equal(held)) == shown
    assert _expect_equal(np.concatenate([held, held])) == pytest.approx(1.0)
