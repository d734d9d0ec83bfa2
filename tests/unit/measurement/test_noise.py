from dataclasses import replace

import numpy as np
import pytest

from softfinger.measurement import reml
from softfinger.measurement.frames import select_frames
from softfinger.measurement.memory import Memory, whiten_array
from softfinger.measurement.noise import fit_noise
from softfinger.measurement.quiet import find_load_changes_array, find_quiet_array


def estimate_noise(angles):
    return fit_noise(angles, select_frames(angles)).noise


@pytest.mark.parametrize("rho", [0.0, 0.4, 0.9])
def test_finds_sd_autocorrelation_and_correlation_under_motion(make_campaign, rng, rho):
    angles, _, noise = make_campaign(rng, trials=12, time=np.arange(600) / 30, rho=rho)
    found = estimate_noise(angles)
    assert found["noise_sd"].values == pytest.approx(noise["noise_sd"].values, rel=0.08)
    expected = noise["noise_autocorrelation"].values
    assert found["noise_autocorrelation"].values == pytest.approx(expected, abs=0.05)
    assert found["noise_correlation"].values[0, 1] == pytest.approx(-0.5, abs=0.05)


def test_some_windows_of_a_long_recording_show_its_memory(make_campaign, rng, monkeypatch):
    """Of 60 trials a third is looked at, for the memory alone: the sd is that of all."""
    angles, _, noise = make_campaign(rng, trials=60, time=np.arange(600) / 30, rho=0.9)
    every = estimate_noise(angles)
    fewer = replace(reml.BUDGET, memory_rows=10_000)
    monkeypatch.setattr(reml, "BUDGET", fewer)
    rows = []
    evaluate = reml.evaluate_reml
    monkeypatch.setattr(
        reml,
        "evaluate_reml",
        lambda part, *rest: rows.append(len(part.angle)) or evaluate(part, *rest),
    )
    found = estimate_noise(angles)
    assert sum(n > 11_000 for n in rows) < 0.1 * len(rows)
    expected = noise["noise_autocorrelation"].values
    assert found["noise_autocorrelation"].values == pytest.approx(expected, abs=0.03)
    assert found["noise_sd"].values == pytest.approx(every["noise_sd"].values, rel=0.06)
    assert (found["window_count"] == every["window_count"]).all()


def test_a_declared_sd_is_kept(make_campaign, rng):
    angles, _, _ = make_campaign(rng, time=np.arange(300) / 30)
    angles.attrs["noise_sd_rad"] = 0.0042
    assert estimate_noise(angles)["noise_sd"].values.tolist() == [0.0042] * 3


def test_a_window_that_jumps_is_left_out(make_campaign, rng):
    angles, _, noise = make_campaign(rng, trials=12, time=np.arange(600) / 30)
    angles["joint_angle"][3, :, 400:] += 0.2
    found = estimate_noise(angles)
    assert found["noise_sd"].values == pytest.approx(noise["noise_sd"].values, rel=0.08)
    assert found["noise_correlation"].values[0, 1] == pytest.approx(-0.5, abs=0.05)
    assert (
        found["window_count"] < estimate_noise(angles.isel(trial=[0]))["window_count"] * 12
    ).all()


def test_too_short_recordings_give_no_noise(make_campaign, rng):
    angles, _, _ = make_campaign(rng, time=np.arange(20) / 30)
    found = estimate_noise(angles)
    assert np.isnan(found["noise_sd"]).all()
    assert (found["window_count"] == 0).all()


def test_a_dense_log_of_a_steady_load_has_one_change():
    time = np.linspace(0, 5, 400)
    load = np.ones(400) + 1e-3 * np.sin(40 * time)
    assert find_load_changes_array(time, load).tolist() == [0.0]


def test_turns_of_a_triangle_are_changes():
    assert find_load_changes_array(
        np.array([0.0, 3.0, 6.0]), np.array([0.0, 2.0, 0.0])
    ).tolist() == [0.0, 3.0, 6.0]


def test_before_the_first_load_all_is_quiet():
    quiet = find_quiet_array(np.linspace(0, 10, 11), np.array([5.0]), np.array([1.0]))
    assert quiet.tolist() == [False] + [True] * 4 + [False, False] + [True] * 3 + [False]


def test_whitened_rows_give_the_inverse_correlation():
    gap = np.array([np.inf, 1.0, 2.5, 1.0])
    place = np.array([0.0, 1.0, 3.5, 4.5])
    correlation = 0.7 ** np.abs(place[:, None] - place)
    for share in (0.0, 0.4):
        mixed = (1.0 - share) * correlation + share * np.eye(4)
        white, logdet = whiten_array(np.eye(4), gap, Memory(0.7, share))
        assert white.T @ white == pytest.approx(np.linalg.inv(mixed))
        assert logdet == pytest.approx(np.linalg.slogdet(mixed)[1])


def test_noise_of_two_kinds_is_told_from_one(make_campaign, rng):
    """Rounding or detection errors beside noise that lasts half a second."""
    angles, _, noise = make_campaign(rng, trials=12, time=np.arange(600) / 30, rho=0.95)
    fresh = rng.normal(size=angles["joint_angle"].shape) * noise["noise_sd"].values[:, None]
    both = estimate_noise(angles.assign(joint_angle=angles["joint_angle"] + fresh))
    assert both["noise_white"].values == pytest.approx(0.5, abs=0.1)
    expected = noise["noise_autocorrelation"].values
    assert both["noise_autocorrelation"].values == pytest.approx(expected, abs=0.12)
    assert both["noise_sd"].values == pytest.approx(np.sqrt(2) * noise["noise_sd"].values, rel=0.1)
    assert estimate_noise(angles)["noise_white"].values.tolist() == [0.0] * 3


def test_slight_white_noise_is_seen_beside_what_lasts(make_campaign, rng):
    """Rounding: a hundredth of the variance, and half of what differs from frame to frame."""
    angles, _, noise = make_campaign(rng, trials=12, joints=1, time=np.arange(1200) / 30, rho=0.98)
    sd = noise["noise_sd"].values[:, None]
    fresh = 0.1 * sd * rng.normal(size=angles["joint_angle"].shape)
    both = estimate_noise(angles.assign(joint_angle=angles["joint_angle"] + fresh))
    white_sd = np.sqrt(both["noise_white"].values) * both["noise_sd"].values
    assert white_sd == pytest.approx(0.1 * noise["noise_sd"].values, rel=0.1)
    assert both["noise_autocorrelation"].values == pytest.approx(0.98, abs=0.025)


def test_joints_share_one_autocorrelation_unless_it_plainly_differs(make_campaign, rng):
    alike, _, _ = make_campaign(rng, trials=6, time=np.arange(500) / 30, rho=0.0)
    assert np.ptp(estimate_noise(alike)["noise_autocorrelation"].values) == 0.0
    apart, _, _ = make_campaign(rng, trials=6, time=np.arange(500) / 30, rho=0.9)
    assert np.ptp(estimate_noise(apart)["noise_autocorrelation"].values) > 0.1


def test_noise_that_outlasts_the_windows_is_not_taken_for_an_endless_drift(make_campaign, rng):
    ratios = []
    for _ in range(6):
        angles, _, noise = make_campaign(rng, trials=3, time=np.arange(250) / 30, rho=0.98)
        ratios.append(estimate_noise(angles)["noise_sd"].values / noise["noise_sd"].values)
    assert 0.6 < np.median(ratios) < 1.3
    assert np.max(ratios) < 2.0


def test_where_frames_thin_out_the_dense_ones_show_the_memory(make_campaign, rng):
    """Frames at rest, half a minute apart, seemed white, and so the dense ones counted too much."""
    time = np.append(0.0, np.geomspace(0.5, 3600.0, 200))
    held = [0.0, time[-1]], [0.04, 0.04]
    angles, _, noise = make_campaign(rng, trials=8, joints=1, time=time, rho=0.9, load=held)
    found = estimate_noise(angles)
    assert found["noise_autocorrelation"].values == pytest.approx(0.9, abs=0.06)
    assert found["noise_sd"].values == pytest.approx(noise["noise_sd"].values, rel=0.1)


def test_frames_at_rest_that_remember_each_other_are_enough(make_campaign, rng):
    """Dense early frames, whose noise may be of another kind, are then not looked at."""
    time = np.append(np.arange(0.0, 30.0, 0.1), np.arange(30.0, 240.0, 0.5))
    held = [0.0, time[-1]], [0.04, 0.04]
    angles, _, _ = make_campaign(rng, trials=6, joints=1, time=time, rho=0.95, load=held)
    still = estimate_noise(angles)
    angles["joint_angle"][:, :, 100:300] += rng.normal(0.0, 0.001, (6, 1, 200))
    assert estimate_noise(angles)["noise_white"].equals(still["noise_white"])
    assert still["noise_autocorrelation"] > 0.7
