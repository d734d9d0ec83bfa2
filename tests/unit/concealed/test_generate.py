import hashlib
import json
from dataclasses import replace

import numpy as np
import pytest

from softfinger.campaign import read_angle_table, read_campaign, read_load
from softfinger.concealed import CaseSpec, build_paper_case, generate_campaign
from softfinger.concealed.protocols import PROTOCOLS, Load, draw_loads, write_rows
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.setting import disturb, draw_setting, record_cleanly, set_strengths

SPEC = CaseSpec(5, ("gravity",), ((),), (0.6,), "staircase", 2, "gappy", duration_s=12.0)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    place = tmp_path_factory.mktemp("proof")
    truth = generate_campaign(SPEC, place / "c3f1", place / "truths" / "c3f1.json")
    return place, truth


def test_the_reader_takes_the_folder_as_it_is(made):
    place, _ = made
    campaign = read_campaign(place / "c3f1")
    assert not campaign.set_aside
    assert campaign.source == "synthetic"
    assert [trial.name for trial in campaign.trials] == [f"trial_{k:03d}" for k in (1, 2)]
    assert campaign.trials[0].covariates.keys() == {"temperature_c", "humidity_pct"}
    setting = draw_setting(SPEC)
    for k, trial in enumerate(campaign.trials):
        table = read_angle_table(campaign, trial)
        assert table.sizes["joint"] == 3
        assert np.isnan(table.joint_angle).any()
        np.testing.assert_allclose(table.time, setting.times[k], atol=1e-6)
        load = setting.trials[k].load
        times, torque, kind = read_load(campaign, trial, 1.0 / setting.rig.fps, 0.0)
        assert kind == "tension_n"
        probe = np.setdiff1d(np.linspace(0.0, 12.0, 1237), load.time)
        np.testing.assert_allclose(
            Load(times, torque).value(probe),
            setting.rig.wire_offset * load.value(probe),
            atol=1e-7,
        )


def test_the_angles_are_the_motion_plus_the_noise(made):
    _, truth = made
    assert truth["misfit"]["true"] == pytest.approx(1.0, abs=0.06)
    assert truth["oracle_settled"]


def test_the_truth_says_everything_and_lies_beside(made):
    place, truth = made
    assert json.loads((place / "truths" / "c3f1.json").read_text()) == truth
    effect = truth["effects"][0]
    assert effect["id"] == "gravity"
    assert effect["parameters"]["tilt_rad"] == effect["strength"] > 0
    assert effect["gain_nats"] == truth["gain_nats"]
    assert truth["aimed_at_nats"]["gravity"] > 1.0
    assert len(truth["individuals"]) == 2
    start, end = truth["window_s"]
    assert 0.0 <= start < end < 12.0


def test_nothing_in_the_folder_tells(made):
    place, _ = made
    text = " ".join(
        [str(path) + path.read_text() for path in (place / "c3f1").rglob("*.*") if path.is_file()]
    )
    words = {*EFFECTS, "tilt", "strength", "seed", "truth", "oracle", "gappy", "staircase"}
    for word in words - {"temperature"}:  # a covariate that every campaign has
        assert word not in text


@pytest.mark.slow
def test_the_same_case_gives_the_same_bytes(made, tmp_path):
    place, _ = made
    generate_campaign(SPEC, tmp_path / "c3f1", tmp_path / "truth.json")
    files = [p for p in (place / "c3f1").rglob("*") if p.is_file()]
    assert len(files) == 2 + 2 * 2
    for path in files:
        again = tmp_path / "c3f1" / path.relative_to(place / "c3f1")
        assert again.read_bytes() == path.read_bytes()
    truths = (place / "truths" / "c3f1.json", tmp_path / "truth.json")
    assert truths[0].read_bytes() == truths[1].read_bytes()


def test_a_truth_inside_the_campaign_is_refused(tmp_path):
    with pytest.raises(ValueError, match="beside"):
        generate_campaign(SPEC, tmp_path / "c", tmp_path / "c" / "hidden" / "truth.json")
    assert not (tmp_path / "c").exists()


@pytest.mark.slow
def test_a_filmed_case_hands_the_motion_to_the_film_maker(tmp_path):
    spec = replace(SPEC, trials=2, noise="white", filmed=True)
    with pytest.raises(ValueError, match="filmed"):
        generate_campaign(spec, tmp_path / "a", tmp_path / "a.json")
    filmed = []

    def film(angle, rig, path, seed):
        filmed.append((angle, rig.fps, seed))
        path.write_bytes(b"frames")

    generate_campaign(spec, tmp_path / "b", tmp_path / "b.json", film)
    assert [angle.shape for angle, _, _ in filmed] == [(361, 3)] * 2
    assert all(fps == 30.0 for _, fps, _ in filmed)
    assert filmed[0][2] != filmed[1][2]
    campaign = read_campaign(tmp_path / "b")
    assert [trial.level for trial in campaign.trials] == ["video", "video"]
    assert campaign.noise_sd_rad is None


def test_an_effect_of_strength_zero_leaves_a_clean_campaign(tmp_path):
    zero = replace(SPEC, quantiles=(-1.0,), trials=1)
    folder = tmp_path / "1234567e12"  # a digest may look like a number
    truth = generate_campaign(zero, folder, tmp_path / "zero.json")
    assert read_campaign(folder).name == folder.name
    assert truth["effects"] == []
    assert truth["gain_nats"] == 0.0
    assert truth["elpd_difference"] is None


def test_the_papers_own_case_moves_by_the_papers_wire(tmp_path):
    spec = replace(build_paper_case("single_step", 1, 9), duration_s=12.0)
    truth = generate_campaign(spec, tmp_path / "paper", tmp_path / "paper.json")
    assert truth["effects"][0]["parameters"] == {"arm_scale": 1.0}
    assert truth["aimed_at_nats"] == {}


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_a_protocol_starts_at_rest_and_reaches_its_peak(protocol):
    loads, duration = draw_loads(protocol, 7, np.random.default_rng(4))
    assert len(loads) == 7
    kinds = {tuple(load.tension) for load in loads}
    assert len(kinds) == {"single_step": 1, "levels": 4, "staircase": 3, "triangle": 1}[protocol]
    for load in loads:
        assert load.time[0] == 0.0
        assert load.value(np.array([-0.1]))[0] == 0.0
        assert 2.0 < load.tension.max() < 9.0
        assert load.time[-1] < duration
        assert np.all(np.diff(load.time) >= 0)
    again, _ = draw_loads(protocol, 7, np.random.default_rng(4))
    np.testing.assert_array_equal(again[3].time, loads[3].time)


def test_a_jump_becomes_two_close_rows():
    rows = write_rows(Load(np.array([0, 0.5, 0.5, 3.0]), np.array([0, 0.0, 6.0, 7.0])))
    np.testing.assert_allclose(rows, [[0, 0], [0.49999, 0], [0.5, 6], [3, 7]])
    at_once = write_rows(Load(np.zeros(2), np.array([0.0, 6.0])))
    np.testing.assert_allclose(at_once, [[0.0, 6.0]])


def test_numbers_of_earlier_versions_are_what_they_were():
    spec = CaseSpec(
        5, ("gravity", "fatigue_softening"), ((), (0, 1, 2)), (0.6, 0.5), "staircase", 10, "gappy"
    )
    setting = draw_setting(spec)
    doses = set_strengths(setting.doses, {"gravity": 0.2, "fatigue_softening": 0.2})
    first = disturb(setting, record_cleanly(setting, doses, np.arange(2)), 5)
    numbers = [setting.individuals.ravel(), *(r.angle.ravel() for r in first), setting.humidity]
    digest = hashlib.sha256(np.round(np.concatenate(numbers), 6).tobytes()).hexdigest()
    assert digest[:16] == "b9785d2461acfab3"


@pytest.fixture(scope="module")
def twins(tmp_path_factory):
    """The same campaign twice, once with two nuisances."""
    place = tmp_path_factory.mktemp("twins")
    plain = replace(SPEC, noise="white", trials=2)
    spoilt = replace(plain, nuisances=("noisy_load", "lost_frames"))
    return place, [
        generate_campaign(spec, place / name, place / f"{name}.json")
        for name, spec in (("plain", plain), ("spoilt", spoilt))
    ]


@pytest.mark.slow
def test_twins_differ_by_their_nuisances_alone(twins):
    place, (plain, spoilt) = twins
    assert plain["individuals"] == spoilt["individuals"]
    assert plain["effects"][0]["strength"] == spoilt["effects"][0]["strength"]
    assert plain["faults"] == []
    plain_load, spoilt_load = (place / name / "load/trial_001.csv" for name in ("plain", "spoilt"))
    assert plain_load.read_bytes() != spoilt_load.read_bytes()
    assert spoilt["case"]["seed"] == plain["case"]["seed"]


@pytest.mark.slow
def test_the_truth_tells_of_the_faults_and_how_plain_they_are(twins):
    place, (_, spoilt) = twins
    faults = {fault["id"]: fault for fault in spoilt["faults"]}
    assert faults["noisy_load"]["finding"] == "noisy_load"
    assert faults["noisy_load"]["nats"] > 15.0
    assert faults["lost_frames"]["nats"] > 15.0
    assert 0.003 <= faults["noisy_load"]["size"] <= 0.01
    assert spoilt["misfit"]["true"] == pytest.approx(1.0, abs=0.06)
    assert not read_campaign(place / "spoilt").set_aside


@pytest.mark.slow
def test_a_trial_may_be_short(twins):
    place, _ = twins
    table = read_campaign(place / "plain")
    assert read_angle_table(table, table.trials[0]).time.max() == pytest.approx(12.0, abs=0.1)
