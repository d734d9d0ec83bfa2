"""What recordings suffer from: each disturbance is found where it is, and none where it is not."""

import numpy as np
import pytest
from scipy.signal import lfilter

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.inference.reduce import reduce_trials
from softfinger.measurement.measure import measure
from softfinger.measurement.planned import assume_noise
from softfinger.measurement.trials import prepare_trials
from softfinger.mismatch.candidates.columns import collect_columns
from softfinger.mismatch.candidates.rank import list_pieces, rank_pieces

TIME = np.arange(500) / 30
LOAD = ([0.0, 4.0, 4.0, 8.0, 8.0, 12.0, 12.0], [0.02, 0.02, 0.06, 0.06, 0.01, 0.01, 0.05])
SD = 0.003


@pytest.fixture
def drawn(make_campaign):
    """Angles and motion of 8 trials of 3 joints on a staircase; white noise."""

    def draw(seed=20, **knobs):
        parts = [
            make_campaign(np.random.default_rng(seed), 8, time=TIME, load=LOAD, rho=0.0, **more)[0]
            for more in (knobs, {"sd": 1e-12})
        ]
        return parts[0], parts[1]["joint_angle"].values

    return draw


def disturb(angles, motion, factor):
    """Multiply the noise by a factor."""
    noise = angles["joint_angle"].values - motion
    return angles.assign(joint_angle=(angles["joint_angle"].dims, motion + factor * noise))


def list_found(found):
    return dict(
        zip(found["component"].values.tolist(), found["component_size"].values, strict=True)
    )


def test_clean_recordings_suffer_from_nothing(drawn):
    for seed in (20, 21, 22):
        angles, motion = drawn(seed)
        found = measure(angles, motion)
        assert list_found(found) == {}
        assert (~found["used"]).sum() <= 1
        assert (found["noise_factor"] == 1.0).all()


def test_noise_of_another_size_in_every_trial(drawn):
    angles, motion = drawn()
    factor = np.exp(0.6 * np.random.default_rng(3).standard_normal(8))
    found = measure(disturb(angles, motion, factor[:, None, None]), motion)
    assert list(list_found(found)) == ["uneven_noise"]
    sd = found["trial_factor"].values * found["noise_sd"].values / (SD * np.array([1.0, 0.8, 1.3]))
    np.testing.assert_allclose(sd, np.repeat(factor[:, None], 3, axis=1), rtol=0.12)


def test_noise_that_grows_with_the_deflection(drawn):
    angles, motion = drawn()
    moved = np.abs(motion - motion[:, :, :1])
    found = measure(disturb(angles, motion, np.sqrt(1 + (8.0 * moved) ** 2)), motion)
    assert list(list_found(found)) == ["signal_noise"]
    assert float(found["noise_per_rad"]) == pytest.approx(8.0, rel=0.25)
    np.testing.assert_allclose(found["noise_sd"], SD * np.array([1.0, 0.8, 1.3]), rtol=0.2)


@pytest.fixture
def blurred(make_campaign):
    """Angles, motion and sd [rad] under a triangle, whose corners are no kicks."""

    def draw(per_rate, seed=21):
        load = [0.0, *np.arange(2.0, 17.0, 2.0)], [0.0, *(0.045 * (np.arange(7) % 2 == 0)), 0.0]
        angles = make_campaign(np.random.default_rng(20), 8, time=TIME, load=load)[0]
        phase = np.abs((TIME + 2.0) % 4.0 - 2.0)
        size = np.array([0.2, 0.3, 0.5])[:, None] * np.linspace(0.6, 1.4, 8)[:, None, None]
        motion = size * phase**1.5
        speed = np.abs(np.gradient(motion, TIME, axis=2))
        sd = SD * np.sqrt(1.0 + (per_rate * speed) ** 2)
        values = motion + sd * np.random.default_rng(seed).standard_normal(motion.shape)
        return angles.assign(joint_angle=(angles["joint_angle"].dims, values)), motion, sd

    return draw


def test_noise_that_grows_with_the_speed(blurred):
    angles, motion, sd = blurred(4.0)
    found = measure(angles, motion)
    assert list(list_found(found)) == ["rate_noise"]
    assert list_found(found)["rate_noise"] == pytest.approx(4.0, rel=0.3)
    np.testing.assert_allclose(found["noise_factor"] * found["noise_sd"], sd, rtol=0.5)


def test_fast_frames_that_seemed_gross_are_judged_again_by_their_speed(blurred):
    angles, motion, sd = blurred(20.0)
    found = measure(angles, motion)
    assert list(list_found(found)) == ["rate_noise"]  # and no outliers
    assert (found["noise_factor"] * found["noise_sd"] > 0.6 * sd).all()


@pytest.mark.parametrize(("per_rate", "name"), [(4.0, "frame_jitter"), (20.0, "rate_noise")])
def test_times_err_by_less_than_an_interval(blurred, per_rate, name):
    """One joint cannot show whether its times err, but 60 ms at 30 frames a second they do not."""
    angles, motion, _ = blurred(per_rate)
    alone = {dim: [0] for dim in ("joint", "other_joint") if dim in angles.dims}
    found = measure(angles.isel(alone), motion[:, :1])
    assert name in list_found(found)


def test_an_error_of_the_time_of_a_frame_is_no_noise_of_the_markers(blurred):
    """It moves all joints together."""
    angles, motion, _ = blurred(0.0)
    late = 0.008 * np.random.default_rng(30).standard_normal((8, 1, len(TIME)))
    values = angles["joint_angle"] + late * np.gradient(motion, TIME, axis=2)
    found = measure(angles.assign(joint_angle=values), motion)
    assert list(list_found(found)) == ["frame_jitter"]
    assert list_found(found)["frame_jitter"] == pytest.approx(0.008, rel=0.3)


def scatter_outliers(angles, share=0.02, seed=4):
    rng = np.random.default_rng(seed)
    values = angles["joint_angle"].values.copy()
    hit = rng.uniform(size=(values.shape[0], values.shape[2])) < share
    size = rng.choice([-1.0, 1.0], values.shape) * rng.uniform(8.0, 30.0, values.shape) * SD
    values += np.where(hit[:, None], size, 0.0)
    return angles.assign(joint_angle=(angles["joint_angle"].dims, values)), hit


def test_gross_errors_are_left_out_and_hardly_anything_else(drawn):
    angles, motion = drawn()
    spoilt, hit = scatter_outliers(angles)
    found = measure(spoilt, motion)
    out = found["outlier_distance"].values > 0
    assert (out & hit).sum() >= 0.97 * hit.sum()
    assert (out & ~hit).sum() <= 2
    assert not found["used"].values[out].any()
    assert list_found(found)["outliers"] == pytest.approx(hit.mean(), rel=0.1)
    np.testing.assert_allclose(found["noise_sd"], SD * np.array([1.0, 0.8, 1.3]), rtol=0.06)


def test_a_trial_that_is_faster_than_the_others_has_no_outliers(make_campaign):
    """Before a model is fitted, its first frames after a change of load are like nobody's."""
    load = [0.0, 0.5, 0.5, 17.0], [0.0, 0.0, 0.045, 0.045]
    rng = np.random.default_rng(20)
    angles = make_campaign(rng, 8, time=TIME, load=load)[0]
    since, size = np.maximum(TIME - 0.5, 0.0), np.full((8, 3, 1), 0.3)
    time_constant = np.full((8, 3, 1), 2.0)
    time_constant[0, 2] = 0.03
    motion = size * (1.0 - np.exp(-since / time_constant))
    values = motion + 5e-4 * rng.standard_normal(motion.shape)
    faster = angles.assign(joint_angle=(angles["joint_angle"].dims, values))
    assert (measure(faster)["outlier_distance"].values[0] == 0.0).all()
    spoilt, hit = scatter_outliers(faster)
    assert (measure(spoilt)["outlier_distance"].values > 0)[hit].mean() > 0.9


def test_what_every_trial_does_after_a_change_of_load_is_no_outlier(drawn):
    angles, motion = drawn()
    since = TIME - np.minimum(TIME // 4.0, 3) * 4.0
    missed = 0.05 * np.exp(-since / 0.05) * np.linspace(0.7, 1.3, 8)[:, None, None]
    found = measure(angles.assign(joint_angle=angles["joint_angle"] + missed), motion)
    assert found["used"].all()


def test_what_a_long_trial_does_in_its_first_frames_is_no_outlier(make_campaign):
    """A single trial, at first ten frames a second: no later frame is as soon after the load."""
    time = np.concatenate([np.arange(0.0, 4.0, 0.1), np.arange(4.0, 60000.0, 30.0)])
    rng, load = np.random.default_rng(20), ([0.0, 60000.0], [0.04, 0.04])
    angles = make_campaign(rng, 1, time=time, load=load, rho=0.0)[0]
    motion = make_campaign(rng, 1, time=time, load=load, rho=0.0, sd=1e-12)[0]
    rings = 0.1 * np.exp(-time / 0.3) * np.cos(time / 0.1)
    still = motion["joint_angle"].values
    missed = still + rings + 0.003 * rng.standard_normal(still.shape)
    angles = angles.assign(joint_angle=(angles["joint_angle"].dims, missed))
    found = measure(angles, motion["joint_angle"].values)
    assert found["used"].values[0, :10].all()


def test_frames_whose_times_jitter_are_no_outliers(drawn):
    """Frames on their way after a step are off by many sds, and are where the motion passes."""
    angles, motion = drawn(sd=0.0003)
    values, noise = angles["joint_angle"].values.copy(), np.random.default_rng(5)
    late = np.clip(0.006 * noise.standard_normal((8, 500)), -0.02, 0.02)
    for place in np.ndindex(8, 3):
        true = motion[place]
        values[place] += np.interp(TIME + late[place[0]], TIME, true) - true
    found = measure(angles.assign(joint_angle=(angles["joint_angle"].dims, values)), motion)
    assert "outliers" not in list_found(found)
    values[2, :, 60] += 0.02
    found = measure(angles.assign(joint_angle=(angles["joint_angle"].dims, values)), motion)
    assert not found["used"].values[2, 60]


@pytest.mark.parametrize("sd_s", [0.002, 0.005])
def test_jitter_gives_no_outliers_beside_noise_that_lasts(drawn, sd_s):
    """The noise is larger than what the times err by, and far smaller from frame to frame.

    A frame at a step is also judged by those beside it, whose times are as wrong.
    """
    angles, motion = drawn()
    rng, rho = np.random.default_rng(6), 0.98
    noise = lfilter([np.sqrt(1 - rho**2)], [1, -rho], rng.standard_normal((8, 3, 800)))[..., 300:]
    values = motion + 0.006 * noise
    late = sd_s * rng.standard_normal((8, 500))
    for place in np.ndindex(8, 3):
        values[place] += np.interp(TIME + late[place[0]], TIME, motion[place]) - motion[place]
    found = measure(angles.assign(joint_angle=(angles["joint_angle"].dims, values)), motion)
    assert (found["outlier_distance"] == 0.0).all()


def test_where_times_are_right_a_frame_on_its_way_may_be_a_gross_error(drawn):
    """One frame lies between its neighbours, but many sds from where all others are."""
    angles, motion = drawn(sd=0.0003)
    values = angles["joint_angle"].values.copy()
    frame = int(np.searchsorted(TIME, 4.0)) + 2
    values[2, :, frame] += 0.7 * (motion[2, :, frame + 1] - motion[2, :, frame])
    found = measure(angles.assign(joint_angle=(angles["joint_angle"].dims, values)), motion)
    assert not found["used"].values[2, frame]
    assert (~found["used"].values).sum() <= 2


def test_held_frames_tell_nothing(drawn):
    angles, motion = drawn()
    values = angles["joint_angle"].values.copy()
    held = np.random.default_rng(5).uniform(size=(8, 500)) < 0.1
    held[:, 0] = False
    for trial, frame in np.argwhere(held):
        values[trial, :, frame] = values[trial, :, frame - 1]
    found = measure(angles.assign(joint_angle=(angles["joint_angle"].dims, values)), motion)
    assert (found["repeated"].values == held).all()
    assert list_found(found) == {"repeated_frames": pytest.approx(held.mean())}


def test_what_repeats_a_frame_that_was_lost_is_no_gross_error(drawn):
    """It is the first of its run to be seen, and older than its time."""
    angles, motion = drawn()
    values = angles["joint_angle"].values.copy()
    frame = int(np.searchsorted(TIME, 4.0)) + 1
    values[2, :, frame + 1 : frame + 7] = values[2, :, frame, None]
    values[2, :, frame - 1 : frame + 3] = np.nan
    found = measure(angles.assign(joint_angle=(angles["joint_angle"].dims, values)), motion)
    assert found["repeated"].values[2, frame + 3 : frame + 7].all()
    assert "outliers" not in list_found(found)


def test_rounded_angles_err_by_their_rounding(drawn):
    angles, motion = drawn(sd=1e-5)
    step = 0.01
    values = np.round(angles["joint_angle"].values / step) * step
    found = measure(angles.assign(joint_angle=(angles["joint_angle"].dims, values)), motion)
    assert not found["repeated"].any()
    assert (found["noise_sd"] >= step / np.sqrt(12) * 0.999).all()
    sd = found["noise_factor"] * found["noise_sd"]
    assert (sd >= step / np.sqrt(12) * 0.999).all()  # in every frame


def test_an_angle_that_flips_between_two_steps_is_no_gross_error(drawn):
    """Four steps in a hundred were left out as outliers where a step is four sds of the noise."""
    angles, motion = drawn(sd=0.001)
    step = 0.004
    values = np.round(angles["joint_angle"].values / step) * step
    wrong = values.copy()
    wrong[2, 1, 40] += 12 * step
    rounded, spoilt = (
        measure(angles.assign(joint_angle=(angles["joint_angle"].dims, some)), motion)
        for some in (values, wrong)
    )
    assert (rounded["outlier_distance"] == 0.0).all()
    assert np.argwhere(spoilt["outlier_distance"].values > 0.0).tolist() == [[2, 40]]
    assert list_found(rounded).keys() <= {"heavy_tails"}


def test_numbers_of_few_digits_repeat_themselves_without_holding(drawn):
    """Their step is ten times larger where the angle is: fine ones show that none is held."""
    angles, motion = drawn(sd=2e-4)
    values = angles["joint_angle"].values
    step = np.where(np.abs(values) < 0.5 * np.abs(values).max(), 1e-5, 1e-3)
    values = np.round(values / step) * step
    equal = (np.diff(values[0]) == 0).mean(axis=1)
    found = measure(angles.assign(joint_angle=(angles["joint_angle"].dims, values)), motion)
    assert equal.min() > 0.1
    assert not found["repeated"].any()


def test_a_declared_sd_is_expected_and_not_enforced(drawn):
    """The artifact has what is declared, and how far each trial is from it."""
    angles, motion = drawn()
    true = SD * np.array([1.0, 0.8, 1.3])
    for declared in (0.003, 0.0015, 0.006):
        angles.attrs["noise_sd_rad"] = declared
        found = measure(angles, motion)
        assert found["noise_sd"].values == pytest.approx([declared] * 3)
        used = declared * found["trial_factor"].values
        np.testing.assert_allclose(used.mean(axis=0), true, rtol=0.06)
        np.testing.assert_allclose(found["recorded_noise_sd"].values, true, rtol=0.06)


def test_noise_is_carried_over_to_other_trials_without_what_they_suffer_from(drawn):
    angles, motion = drawn()
    known = measure(scatter_outliers(angles)[0], motion)
    planned = assume_noise(angles.isel(trial=slice(2)), known)
    assert planned["used"].all()
    np.testing.assert_array_equal(planned["noise_sd"], known["noise_sd"])


def test_frames_that_are_planned_do_not_repeat_each_other(drawn):
    angles, motion = drawn()
    planned = angles.copy(deep=True)
    planned["joint_angle"][:] = 0.0
    assert assume_noise(planned, measure(angles, motion))["used"].all()


def test_a_factor_on_the_noise_divides_rows_and_counts_in_their_measure(drawn):
    angles, motion = drawn()
    known = measure(angles, motion)
    doubled = known.assign(noise_factor=2.0 * known["noise_factor"])
    one, other = prepare_trials(angles, known), prepare_trials(angles, doubled)
    node = np.zeros((8, 3, 2 * one.angle.shape[1]))
    slope = np.ones((*node.shape, 2))
    gram = [reduce_trials(trials, node, slope) for trials in (one, other)]
    np.testing.assert_allclose(gram[0], 4.0 * gram[1])
    rows = one.size[one.protocol]
    np.testing.assert_allclose(other.logdet - one.logdet, 2 * np.log(2.0) * rows)


def gain_of_delay(angles):
    problem, fit = pose_problem(angles)
    base = Candidate(problem.base, fit, fit.log_evidence)
    pieces = [p for p in list_pieces(problem.setting)[0] if p.effect.id == "camera_delay"]
    columns = collect_columns(problem, base, pieces)
    best = rank_pieces(problem, base, columns, lambda items, _: items)[0][0]
    return best.log_evidence - base.log_evidence


def test_an_effect_of_the_first_frames_keeps_its_evidence_among_outliers(make_campaign):
    angles = make_campaign(np.random.default_rng(8), 8, 1, time=TIME, load=LOAD, rho=0.0)[0]
    unknown = {f"link_{k}": ("joint", [np.nan]) for k in ("length", "mass", "centre", "inertia")}
    angles = angles.assign(
        load_time=angles["load_time"] - 0.015,
        started_at=("trial", np.full(8, np.nan)),
        joint_length=np.nan,
        wire_offset=np.nan,
        **unknown,
    )
    clean, spoilt = gain_of_delay(angles), gain_of_delay(scatter_outliers(angles)[0])
    assert clean > 50
    assert spoilt > 0.95 * clean


def test_one_trial_shows_its_noise_and_nothing_between_trials(drawn):
    angles, motion = drawn()
    found = measure(angles.isel(trial=[0]), motion[:1])
    assert list_found(found) == {}
    assert (found["trial_factor"] == 1.0).all()
    np.testing.assert_allclose(found["noise_sd"], SD * np.array([1.0, 0.8, 1.3]), rtol=0.25)


def test_two_trials_show_that_their_noise_differs(drawn):
    angles, motion = drawn()
    louder = disturb(angles, motion, np.array([1.0, 4.0] + [1.0] * 6)[:, None, None])
    found = measure(louder.isel(trial=[0, 1]), motion[:2])
    assert list(list_found(found)) == ["uneven_noise"]
    ratio = found["trial_factor"].values[1] / found["trial_factor"].values[0]
    np.testing.assert_allclose(ratio, 4.0, rtol=0.3)
