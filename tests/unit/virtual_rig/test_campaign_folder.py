from datetime import timedelta
from itertools import pairwise

import numpy as np
import pytest

from softfinger.campaign import marker_names, read_angle_table, read_campaign, read_load
from softfinger.virtual_rig.campaign_folder import (
    draw_angle_noise_array,
    write_campaign_folder,
)
from softfinger.virtual_rig.film import film_trial
from softfinger.virtual_rig.scene import compute_marker_position


@pytest.fixture
def angle_campaign(truth, config, tmp_path):
    write_campaign_folder(truth, config | {"level": "angles"}, tmp_path, seed=6)
    return read_campaign(tmp_path)


def test_the_reader_takes_a_folder_of_videos(truth, config, rig, tmp_path):
    write_campaign_folder(truth, config, tmp_path, seed=6)
    for index, name in enumerate(truth.trial.values):
        film_trial(truth, config, index, tmp_path / "video" / f"{name}.avi", seed=6)
    campaign = read_campaign(tmp_path)
    assert campaign.source == "synthetic"
    assert not campaign.set_aside
    assert campaign.noise_sd_rad is None
    assert campaign.finger.bends_sign == 1
    assert campaign.finger.link_length_m == tuple(rig.link_length_m)
    assert campaign.finger.wire_offset_m == 0.005
    assert campaign.camera.fps == 10.0
    assert campaign.camera.marker_colour == "dark"
    assert [trial.level for trial in campaign.trials] == ["video"] * 5
    seen = compute_marker_position(truth.joint_angle, rig)
    assert marker_names(campaign.camera) == list(seen.marker.values)


def test_the_reader_takes_a_folder_of_angles(angle_campaign, truth):
    assert angle_campaign.camera is None
    for index, trial in enumerate(angle_campaign.trials):
        table = read_angle_table(angle_campaign, trial)
        np.testing.assert_allclose(table["time"], truth.time, atol=1e-6)
        noise = table["joint_angle"].values - truth.joint_angle.values[index]
        assert 0 < abs(noise).max() < 5 * 0.003


def test_the_load_log_says_what_the_wire_did(angle_campaign, truth):
    load_time, load_torque, kind = read_load(angle_campaign, angle_campaign.trials[3], 0.1, 0.0)
    assert kind == "tension_n"
    np.testing.assert_allclose(load_time, [0, 0, 0.3, 0.3, 0.7])
    np.testing.assert_allclose(load_torque, np.array([0, 8, 8, 2, 3]) * 0.005)


def test_trials_follow_each_other_and_carry_the_room_s_temperature(angle_campaign):
    starts = [trial.started_at for trial in angle_campaign.trials]
    rests = [(b - a) / timedelta(seconds=1) for a, b in pairwise(starts)]
    assert len(set(rests)) > 1
    assert all(115 <= rest <= 125 for rest in rests)
    temperature = [trial.covariates["temperature_c"] for trial in angle_campaign.trials]
    assert 20 < min(temperature) < max(temperature) < 26


def test_the_truth_stays_out_of_the_folder(angle_campaign):
    names = sorted(path.name for path in angle_campaign.folder.iterdir())
    assert names == ["angles", "campaign.yaml", "load", "trials.csv"]


def test_same_seed_same_bytes_and_the_first_trials_stay_the_same(truth, config, tmp_path):
    angles = config | {"level": "angles"}
    for name, seed, trials in [("a", 6, 5), ("b", 6, 5), ("few", 6, 2), ("other", 7, 5)]:
        kept = truth.isel(trial=slice(trials))
        write_campaign_folder(kept, angles | {"n_trials": trials}, tmp_path / name, seed)
    read = {
        name: {p.relative_to(tmp_path / name): p.read_bytes() for p in sorted(files)}
        for name in ("a", "b", "few", "other")
        if (files := [p for p in (tmp_path / name).rglob("*") if p.is_file()])
    }
    assert read["a"] == read["b"]
    assert read["a"] != read["other"]
    for path, content in read["few"].items():
        if path.parent.name in ("angles", "load"):
            assert content == read["a"][path]
    table = next(path for path in read["few"] if path.name == "trials.csv")
    assert read["a"][table].startswith(read["few"][table])


@pytest.mark.parametrize("autocorrelation", [0.0, 0.9])
def test_angle_noise_has_the_declared_sd_and_correlations(autocorrelation):
    rng = np.random.default_rng(8)
    noise = draw_angle_noise_array((3, 400_000), 0.003, autocorrelation, rng) / 0.003
    covariance = np.array([[1.0, -0.5, 0.0], [-0.5, 1.0, -0.5], [0.0, -0.5, 1.0]])
    few = 4 / np.sqrt(400_000 * (1 - autocorrelation) / (1 + autocorrelation))
    np.testing.assert_allclose(np.cov(noise), covariance, atol=1.5 * few)
    for lag in (1, 2, 7):
        lagged = (noise[:, lag:] * noise[:, :-lag]).mean(1)
        np.testing.assert_allclose(lagged, autocorrelation**lag, atol=1.5 * few)


def test_angle_noise_is_stationary_from_the_first_frame():
    rng = np.random.default_rng(8)
    first = np.array([draw_angle_noise_array((3, 2), 1.0, 0.9, rng) for _ in range(4000)])
    np.testing.assert_allclose(first.var(axis=0), 1.0, atol=5 * np.sqrt(2 / 4000))
