"""Every nuisance does what it says, and the oracle that knows it sees a clean campaign."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import kurtosis

from softfinger.concealed.effects import Dose
from softfinger.concealed.faults import weigh_faults
from softfinger.concealed.forward import compute_plain_angles
from softfinger.concealed.nuisances import NUISANCES, OF_NOISE
from softfinger.concealed.oracle import fit_model
from softfinger.concealed.protocols import read_rows, write_rows
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.setting import draw_setting, record_cleanly
from softfinger.concealed.spoil import recall, spoil
from softfinger.concealed.suite import CaseSpec

TRIALS, SEED = 6, 5
FINDINGS = """outliers heavy_tails uneven_noise signal_noise timing_jitter repeated_frames
lost_frames noisy_load clock_rate clock_offset drift saturated_sensor"""


def _spoil(*names, noise="white", trials=TRIALS, protocol="staircase", duration_s=16.0):
    spec = CaseSpec(
        SEED, (), (), (), protocol, trials, noise, nuisances=names, duration_s=duration_s
    )
    setting = draw_setting(spec)
    clean = record_cleanly(setting, {}, np.arange(trials))
    return setting, clean, spoil(setting, {}, clean, SEED)


def _move(setting, k, time, load=None):
    trial = setting.trials[k]
    trial = trial if load is None else replace(trial, load=load)
    return compute_plain_angles(setting.individuals[k], trial, setting.rig.wire_offset, time)


def test_there_are_at_least_twelve_and_their_findings_have_ids():
    assert len(NUISANCES) >= 16
    ids = set(FINDINGS.split())
    for nuisance in NUISANCES.values():
        assert {nuisance.finding, *nuisance.also} - {""} <= ids
        assert nuisance.low <= nuisance.high
    assert {finding for found in OF_NOISE.values() for finding in found} <= ids


def test_sizes_are_random_and_stay_in_their_range():
    rng = np.random.default_rng(1)
    for nuisance in NUISANCES.values():
        faults = [nuisance.draw(rng) for _ in range(20)]
        sizes = [fault.size for fault in faults]
        assert nuisance.low <= min(sizes) < max(sizes) <= nuisance.high


@pytest.mark.parametrize("noise", ["white", "ar_0.9"])
@pytest.mark.parametrize("name", NUISANCES)
def test_what_the_oracle_knows_leaves_white_noise(name, noise):
    setting, _, sights = _spoil(name, noise=noise)
    squares = []
    for k, recording in enumerate(recall(setting, sights, SEED)):
        error = recording.angle - _move(setting, k, recording.time, recording.trial.load)
        squares.append(recording.whiten(setting.noise, error) ** 2)
    squares = np.concatenate(squares)
    tails = 0.25 if name == "quantised_angles" else 0.04  # two errors, one fast and one slow
    assert squares.mean() == pytest.approx(1.0, abs=tails)


@pytest.mark.slow
@pytest.mark.parametrize("name", NUISANCES)
def test_the_truth_of_a_spoilt_clean_campaign_is_clean(name):
    """The oracle that knows the nuisance fits the base model and gains nothing by an effect."""
    setting, _, sights = _spoil(name, noise="ar_0.3", trials=2, protocol="levels", duration_s=12.0)
    known = recall(setting, sights, SEED)
    base = fit_model(known, setting.rig, setting.noise, {}, setting.individuals)
    misfit = np.mean(np.concatenate([r.ravel() for r in base.residuals]) ** 2)
    assert base.settled
    assert misfit == pytest.approx(1.0, abs=0.06)
    for effect in ("camera_delay", "moment_arm"):
        dose = {effect: Dose(0.3 * EFFECTS[effect].typical)}
        fit = fit_model(known, setting.rig, setting.noise, dose, setting.individuals)
        assert fit.log_evidence - base.log_evidence < 2.0


@pytest.mark.slow
def test_an_oracle_that_does_not_know_takes_a_stalling_camera_for_physics():
    setting, _, sights = _spoil("held_frames")
    blind = recall(setting, sights, SEED, knowing=())
    base = fit_model(blind, setting.rig, setting.noise, {}, setting.individuals)
    dose = {"camera_delay": Dose(0.01)}
    fit = fit_model(blind, setting.rig, setting.noise, dose, setting.individuals)
    assert fit.log_evidence - base.log_evidence > 15.0


def test_plain_faults_are_seen_and_what_leaves_no_mark_is_not_weighed():
    names = ("uneven_noise", "noisy_load", "laplace_population")
    setting, _, sights = _spoil(*names)
    weighed = weigh_faults(setting, sights, {}, SEED)
    assert weighed.keys() == {"uneven_noise", "noisy_load"}
    assert min(weighed.values()) > 15.0


def test_a_fault_too_small_to_see_gains_nothing():
    setting, clean, _ = _spoil("hum")
    fault = setting.faults["hum"]
    setting = replace(setting, faults={"hum": replace(fault, size=1e-4)})
    sights = spoil(setting, {}, clean, SEED)
    assert weigh_faults(setting, sights, {}, SEED)["hum"] < 3.0


def test_without_nuisances_nothing_is_weighed_and_the_log_is_the_load():
    setting, clean, sights = _spoil()
    assert weigh_faults(setting, sights, {}, SEED) == {}
    assert recall(setting, sights, SEED)[0].blur is None
    np.testing.assert_array_equal(sights[0].rows, write_rows(clean[0].trial.load))


def test_a_share_of_the_frames_has_gross_errors():
    setting, clean, sights = _spoil("outliers")
    error = np.abs(
        np.concatenate([s.recording.angle - c.angle for s, c in zip(sights, clean, strict=True)])
    )
    far = (error.max(axis=1) > 5.0 * setting.noise.sd).mean()
    assert 0.5 * setting.faults["outliers"].size < far < 1.5 * setting.faults["outliers"].size


def test_noise_differs_between_trials():
    _, clean, sights = _spoil("uneven_noise")
    scale = [
        np.log((s.recording.angle - c.angle).std()) for s, c in zip(sights, clean, strict=True)
    ]
    assert np.std(scale) > 0.25


def test_noise_grows_as_the_finger_bends():
    _, clean, sights = _spoil("signal_noise")
    error = np.concatenate(
        [s.recording.angle - c.angle for s, c in zip(sights, clean, strict=True)]
    )
    bent = np.concatenate([c.angle - c.angle[0] for c in clean])
    assert error[bent > 0.3].std() > 1.3 * error[bent < 0.05].std()


def test_jittering_frames_show_the_finger_at_another_time():
    setting, clean, _ = _spoil("timing_jitter")
    setting = replace(
        setting, faults={"timing_jitter": replace(setting.faults["timing_jitter"], size=0.05)}
    )
    sights = spoil(setting, {}, clean, SEED)
    fast = slice(30, 200)
    error = sights[0].recording.angle[fast] - clean[0].angle[fast]
    speed = np.gradient(clean[0].angle, clean[0].time, axis=0)[fast]
    swift = np.abs(speed).min(axis=1) > 0.1
    late = np.median(error[swift] / speed[swift], axis=1)  # joints agree on when it was
    assert np.ptp(np.quantile(late, [0.25, 0.75])) / 1.349 == pytest.approx(0.05, rel=0.5)


def test_a_slow_clock_states_other_times():
    setting, clean, sights = _spoil("clock_rate")
    rate = 1.0 + setting.faults["clock_rate"].size
    moved = _move(setting, 1, clean[1].time * rate)
    error = sights[1].recording.angle - moved
    assert error.std() == pytest.approx(setting.noise.sd, rel=0.06)
    np.testing.assert_allclose(recall(setting, sights, SEED)[1].time, clean[1].time * rate)


@pytest.mark.parametrize("dense", [0.0, 1.0])
def test_a_noisy_log_differs_from_the_load_that_acted(dense):
    setting, clean, _ = _spoil("noisy_load")
    fault = replace(setting.faults["noisy_load"], shape={"dense": dense})
    sights = spoil(replace(setting, faults={"noisy_load": fault}), {}, clean, SEED)
    ratio = []
    for k, sight in enumerate(sights):
        assert len(sight.rows) > 15 * dense
        pulled = sight.rows[:, 1] > 0.0
        inside = sight.rows[pulled, 0] + (1e-6 if not dense else 0.0)
        acted = clean[k].trial.load.value(inside)
        near = np.abs(sight.rows[pulled, 1] - acted) < 0.1 * acted
        ratio.append((sight.rows[pulled, 1] / acted)[near])
    assert np.concatenate(ratio).std() == pytest.approx(fault.size, rel=0.3)


def test_a_rows_error_moves_the_finger_as_its_column_says():
    setting, clean, sights = _spoil("noisy_load")
    sight, size = sights[0], setting.faults["noisy_load"].size
    columns, rows = sight.marks["noisy_load"].columns, sight.rows
    loaded = np.flatnonzero(rows[:, 1])
    nudged = rows.copy()
    nudged[loaded[2], 1] *= 1.0 + size
    loads = [read_rows(r) for r in (rows, nudged)]
    moved = [_move(setting, 0, clean[0].time, load) for load in loads]
    np.testing.assert_allclose(columns[..., 2], moved[1] - moved[0], atol=1e-10)


def test_the_load_cells_gain_drifts_with_time():
    setting, clean, sights = _spoil("load_cell_drift")
    for sight, recording in zip(sights, clean, strict=True):
        steady = (sight.rows[:, 0] > 1.0) & (sight.rows[:, 1] > 0.0)
        time, tension = sight.rows[steady].T
        acted = recording.trial.load.value(time + 1e-7)
        near = np.abs(tension - acted) < 0.1 * acted
        slope = np.polyfit(time[near], (tension / acted)[near] - 1.0, 1)
        assert slope[1] == pytest.approx(0.0, abs=1e-5)
        assert abs(slope[0]) * 16.0 < 4.0 * setting.faults["load_cell_drift"].size


def test_lost_frames_come_in_bursts():
    setting, _, sights = _spoil("lost_frames")
    lost = np.isnan(np.concatenate([s.recording.angle[:, 0] for s in sights]))
    runs = np.diff(np.flatnonzero(np.diff(np.r_[False, lost, False])))[::2]
    assert 0.5 * setting.faults["lost_frames"].size < lost.mean()
    assert runs.min() >= int(setting.faults["lost_frames"].shape["frames_in_a_row"])


def test_held_frames_repeat_the_one_before():
    setting, _, sights = _spoil("held_frames")
    angle = sights[2].recording.angle
    same = (angle[1:] == angle[:-1]).all(axis=1)
    held = sights[2].marks["held_frames"].left_out
    np.testing.assert_array_equal(same, held[1:])
    assert 0.3 * setting.faults["held_frames"].size < held.mean() < 0.5


def test_rounded_angles_are_multiples_of_a_step():
    setting, _, sights = _spoil("quantised_angles")
    steps = sights[0].recording.angle / setting.faults["quantised_angles"].size
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)


def test_student_noise_keeps_its_variance_and_has_tails():
    setting, clean, _ = _spoil("student_noise")
    fault = replace(setting.faults["student_noise"], size=5.0)
    sights = spoil(replace(setting, faults={"student_noise": fault}), {}, clean, SEED)
    error = np.concatenate(
        [s.recording.angle - c.angle for s, c in zip(sights, clean, strict=True)]
    )
    assert error.std() == pytest.approx(setting.noise.sd, rel=0.05)
    assert kurtosis(error.ravel()) > 1.0


def test_a_hum_is_a_line_in_the_spectrum_of_the_first_joint():
    setting, clean, sights = _spoil("hum")
    frequency = setting.faults["hum"].shape["frequency_hz"]
    error = np.stack([s.recording.angle - c.angle for s, c in zip(sights, clean, strict=True)])
    power = (np.abs(np.fft.rfft(error, axis=1)) ** 2).mean(axis=0)
    grid = np.fft.rfftfreq(error.shape[1], setting.noise.frame_interval)
    assert grid[power[:, 0].argmax()] == pytest.approx(frequency, abs=0.1)
    assert power[:, 0].max() > 5.0 * np.median(power[:, 0])
    assert power[:, 2].max() < 8.0 * np.median(power[:, 2])


def test_a_drift_is_slow_and_the_first_joints():
    setting, _, sights = _spoil("camera_drift")
    offset = np.stack([s.marks["camera_drift"].offset for s in sights])
    assert not offset[..., 1:].any()
    sd = setting.faults["camera_drift"].size * setting.noise.sd
    assert 0.2 * sd < offset[..., 0].std() < 3.0 * sd
    assert np.abs(np.diff(offset, axis=1)).max() < 0.2 * sd


def test_a_swimming_marker_gives_one_joint_what_it_takes_from_the_next():
    setting, _, sights = _spoil("swimming_marker")
    offset = sights[0].marks["swimming_marker"].offset
    link = int(setting.faults["swimming_marker"].shape["link"])
    if link + 1 < 3:
        np.testing.assert_array_equal(offset[:, link], -offset[:, link + 1])
    assert np.ptp(offset[:, link]) > setting.faults["swimming_marker"].size * setting.noise.sd


def test_a_laplace_population_keeps_mean_and_spread_and_has_tails():
    spec = CaseSpec(
        SEED, (), (), (), "single_step", 3000, "white", nuisances=("laplace_population",)
    )
    setting = draw_setting(spec)
    z = (setting.individuals - setting.population.mean) / setting.population.sd
    assert z.mean() == pytest.approx(0.0, abs=0.02)
    assert z.std() == pytest.approx(setting.faults["laplace_population"].size, rel=0.03)
    assert kurtosis(z.ravel()) == pytest.approx(3.0, abs=0.5)


def test_another_day_is_a_batch_of_trials():
    _, _, sights = _spoil("other_day", trials=20)
    batch = [k for k, s in enumerate(sights) if np.any(s.marks["other_day"].offset)]
    assert 2 <= len(batch) <= 8
    assert batch == list(range(batch[0], batch[-1] + 1))
    assert all(sights[k].marks["other_day"].scale != 1.0 for k in batch)


def test_a_sampled_log_has_regular_rows_and_the_oracle_knows_the_load():
    setting, clean, sights = _spoil("sampled_log", protocol="triangle")
    interval = setting.faults["sampled_log"].size
    known = recall(setting, sights, SEED)
    for sight, recording, plain in zip(sights, known, clean, strict=True):
        np.testing.assert_allclose(np.diff(sight.rows[1:, 0]), interval)
        np.testing.assert_array_equal(recording.trial.load.tension, plain.trial.load.tension)
        away = sight.rows[:, 1] - plain.trial.load.value(sight.rows[:, 0])
        assert np.abs(away).max() < 1e-3
    assert len({sight.rows[1, 0] for sight in sights}) == len(sights)


def test_a_noisy_log_that_is_sampled_is_known_before_it_is():
    setting, _, sights = _spoil("noisy_load", "sampled_log")
    rows = recall(setting, sights, SEED)[0].trial.load.time.size
    assert rows < len(sights[0].rows)
    assert len(sights[0].known) < len(sights[0].rows)
