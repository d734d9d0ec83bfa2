import numpy as np
import pytest
import xarray as xr

from softfinger.measurement.flags import JUMP, MISSING, STALE
from softfinger.tracking.quality import LIMITS, compute_quality, list_poor


@pytest.fixture
def markers(rng):
    """Two trials of eight and six frames; four markers on two links."""
    home = np.array([[10.0, 10.0], [30.0, 10.0], [50.0, 10.0], [70.0, 10.0]])
    position = home + 0.01 * rng.standard_normal((2, 8, 4, 2))
    flag = np.zeros((2, 8, 4), np.uint8)
    time = np.tile(np.arange(8.0), (2, 1))
    time[1, 6:] = np.nan
    position[1, 6:] = np.nan
    flag[1, 6:] = MISSING
    return xr.Dataset(
        {
            "time": (("trial", "frame"), time),
            "marker_position": (("trial", "frame", "marker", "axis"), position),
            "marker_position_sd": (("trial", "frame", "marker"), np.full((2, 8, 4), 0.01)),
            "marker_flag": (("trial", "frame", "marker"), flag),
        },
        coords={
            "trial": ["one", "two"],
            "marker": ["base_1", "base_2", "link_1_1", "link_1_2"],
            "axis": ["x", "y"],
        },
    )


def lose(markers, trial, frames, marker):
    markers["marker_position"][trial, frames, marker] = np.nan
    markers["marker_flag"][trial, frames, marker] = MISSING


def test_shares_are_of_the_trials_own_frames(markers):
    lose(markers, 1, slice(0, 2), 3)
    markers["marker_flag"][0, 4] = STALE
    markers["marker_flag"][1, 5, 0] = JUMP
    quality = compute_quality(markers)
    np.testing.assert_allclose(quality["share_seen"], [[1, 1, 1, 1], [1, 1, 1, 4 / 6]])
    np.testing.assert_allclose(quality["share_stale"], [1 / 8, 0])
    np.testing.assert_allclose(quality["share_suspect"], [[0, 0, 0, 0], [1 / 6, 0, 0, 0]])
    np.testing.assert_allclose(quality["sd_median"], 0.01)


def test_the_rigid_residual_is_the_noise_of_one_marker(rng, markers):
    many = markers.isel(frame=np.zeros(4000, int)).copy(deep=True)
    noise = rng.standard_normal(many["marker_position"].shape)
    noise[:, :, :2] *= 0.03
    noise[:, :, 2:] *= 0.1
    many["marker_position"] = many["marker_position"] + noise
    quality = compute_quality(many)
    np.testing.assert_allclose(quality["rigid_residual"][0], [0.03, 0.03, 0.1, 0.1], rtol=0.05)


def test_poor_trials_are_named_with_marker_value_and_limit(markers):
    assert list_poor(compute_quality(markers), LIMITS) == {}
    lose(markers, 0, slice(0, 6), 2)
    reasons = list_poor(compute_quality(markers), LIMITS)
    assert list(reasons) == ["one"]
    for said in ("link_1_1", "0.25 of the frames", "smallest_share_seen", "at least 0.5"):
        assert said in reasons["one"]
    markers["marker_position_sd"][1] = 1.5
    reasons = list_poor(compute_quality(markers), LIMITS)
    assert "at most 1" in reasons["two"]
    assert "1.5 px" in reasons["two"]


def test_a_trial_that_shows_nothing_is_poor(markers):
    lose(markers, 0, slice(None), slice(None))
    assert "0 of the frames" in list_poor(compute_quality(markers), LIMITS)["one"]
