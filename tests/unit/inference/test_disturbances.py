"""Wrong logs and clocks: found by evidence, and taken into the noise."""

from dataclasses import replace

import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.inference import disturbances, posterior
from softfinger.inference.disturbance_sizes import fit_disturbances
from softfinger.inference.disturbances import _group_rows, list_disturbances
from softfinger.inference.disturbed import (
    admit_disturbances,
    admit_known,
    locate_disturbances,
)
from softfinger.inference.layout import describe_fit
from softfinger.inference.mixed_effects_linearised import solve_linearised
from softfinger.inference.posterior import prepare_fit
from softfinger.inference.problem import Candidate, pose_problem
from softfinger.inference.reduce import whiten_residual, whiten_slope
from softfinger.inference.simulate import (
    build_recording,
    describe_noise,
    draw_angles,
    draw_parameters,
)
from softfinger.mismatch.checks.summary import compute_excess

TIME = np.arange(500) / 30
LEVELS = np.array([0.02, 0.06, 0.01, 0.05])
UNKNOWN = {f"link_{k}": ("joint", [np.nan] * 2) for k in ("length", "mass", "centre", "inertia")}


@pytest.fixture(scope="module")
def record():
    """Record 8 trials of 2 joints under four levels; the log's errors and the clock's are given."""

    def draw(load_error=0.0, jitter=0.0):
        rng = np.random.default_rng(11)
        edges = np.repeat(np.arange(5) * 4.0, 2)[1:-1]
        load = np.tile(np.repeat(LEVELS, 2), (8, 1))
        names = [f"t{i}" for i in range(8)]
        recording = build_recording(TIME, np.tile(edges, (8, 1)), load, 2, names)
        mean = np.array([[-2.4, -3.6, 2.9, 0.02], [-2.3, -3.5, 3.1, 0.01]])
        own = draw_parameters(mean, np.array([0.2, 0.4, 0.7, 0.01]), recording, rng)
        noise = describe_noise(np.full(2, 0.002), np.zeros(2), -0.5)
        angles = draw_angles(recording, own, noise, rng)
        logged = load * (1.0 + load_error * rng.standard_normal((8, 8)))
        late = jitter * rng.standard_normal((8, 500))
        values = angles["joint_angle"].values.copy()
        for i in range(8):
            for j in range(2):
                values[i, j] = np.interp(TIME + late[i], TIME, values[i, j])
        return angles.assign(
            joint_angle=(angles["joint_angle"].dims, values),
            load_torque=(("trial", "knot"), logged),
            started_at=("trial", np.full(8, np.nan)),
            joint_length=np.nan,
            wire_offset=np.nan,
            **UNKNOWN,
        )

    return draw


@pytest.fixture(scope="module")
def pose(record):
    def make(**knobs):
        problem, fit = pose_problem(record(**knobs))
        return problem, Candidate(problem.base, fit, fit.log_evidence)

    return make


@pytest.fixture(scope="module")
def noisy(pose):
    return pose(load_error=0.02)


def test_clean_recordings_have_no_disturbance(pose):
    assert fit_disturbances(*pose())[0] == {}


def test_a_log_that_scatters_is_found_with_its_size(noisy):
    size, evidence, _ = fit_disturbances(*noisy)
    assert list(size) == ["noisy_load"]
    assert size["noisy_load"] == pytest.approx(0.02, rel=0.3)
    assert evidence["noisy_load"] > 30


def test_what_asks_for_more_than_a_bad_log_is_no_noisy_log(pose):
    """Beyond the sizes of load cells, physics that is missing scatters the motion."""
    problem, base = pose(load_error=0.15)
    sizes = fit_disturbances(problem, base)[0]
    assert "noisy_load" not in sizes
    asked = fit_disturbances(*pose(load_error=0.03))[0]
    assert asked["noisy_load"] == pytest.approx(0.03, rel=0.4)


def test_a_disturbance_that_cannot_be_simulated_is_none(pose, monkeypatch):
    problem, candidate = pose(jitter=0.006)
    drift = disturbances._drift_load
    monkeypatch.setattr(disturbances, "_drift_load", lambda *given: np.nan * drift(*given))
    assert "load_drift" not in list_disturbances(problem, candidate)
    size, _, directions = fit_disturbances(problem, candidate)
    assert list(size) == ["timing_jitter"]
    assert "load_drift" not in directions


def test_frame_times_that_jitter_are_found(pose):
    size, _, _ = fit_disturbances(*pose(jitter=0.006))
    assert list(size) == ["timing_jitter"]
    assert size["timing_jitter"] == pytest.approx(0.006, rel=0.4)


def test_a_frame_before_a_kick_may_have_been_taken_after_it(pose):
    """One that had moved already, 1 ms before a step, was taken for a lag and a delay."""
    problem, candidate = pose()
    before = int(np.flatnonzero(TIME < 4.0)[-1])
    bin_ = int(np.searchsorted(problem.trials.starts[0], before, side="right")) - 1
    node = problem.trials.node.copy()
    node[:, bin_] = 4.0 - 0.001
    problem = replace(problem, trials=problem.trials._replace(node=node))
    columns = list_disturbances(problem, candidate, ("timing_jitter",))["timing_jitter"]
    speed = np.abs(columns[:, :, 2 * bin_]).max(axis=2)
    after = np.abs(columns[:, :, 2 * bin_ + 2]).max(axis=2)
    assert (speed > 0.3 * after).all()


def test_a_long_drift_of_one_trial_leaves_nothing_that_lasts():
    """A walk of four times the noise, as a rheometer's; five shapes would leave a quarter of it."""
    rng = np.random.default_rng(3)
    time = np.arange(3000) * 0.5
    recording = build_recording(time, np.zeros(1), np.full(1, 0.05), 1, ["one"])
    own = draw_parameters(
        np.array([[-2.4, 1.0, 6.0, 0.0]]), np.array([0.1, 0.1, 0.1, 0.001]), recording, rng
    )
    angles = draw_angles(recording, own, describe_noise(np.full(1, 0.002), np.zeros(1)), rng)
    walk = np.cumsum(rng.normal(0.0, 4.0 * 0.002 / np.sqrt(time.size), time.size))
    angles = angles.assign(
        joint_angle=angles["joint_angle"] + walk,
        started_at=("trial", [np.nan]),
        joint_length=np.nan,
        wire_offset=np.nan,
        **{name: (dim, values[:1]) for name, (dim, values) in UNKNOWN.items()},
    )
    problem, fit = pose_problem(angles)
    base = Candidate(problem.base, fit, fit.log_evidence)
    size, _, directions = fit_disturbances(problem, base)
    assert list(size) == ["drift"]
    soft = admit_disturbances(problem, size, directions)
    again = soft.fit(soft.base, (fit.own, fit.shared, fit.omega))
    excess = compute_excess(soft, Candidate(soft.base, again, again.log_evidence))
    assert excess[1] > 1e-3


def test_softened_trials_have_the_evidence_that_was_foreseen(noisy):
    problem, base = noisy
    fit, directions = base.fit, list_disturbances(problem, base)
    softer = admit_disturbances(problem, {"noisy_load": 0.02}, directions)
    assert (softer.trials.logdet > problem.trials.logdet).all()
    gram = softer.linearise(base.model, fit.own, fit.shared)
    white = whiten_slope(problem.trials, 0.02 * directions["noisy_load"], 3)
    angle = problem.simulate(base.model, fit.own, fit.shared)[0]
    left = whiten_residual(problem.trials, angle, 3).ravel()
    covariance = np.eye(len(left)) + white @ white.T
    assert gram[3, -1, -1] == pytest.approx(left @ np.linalg.solve(covariance, left))
    gained = np.linalg.slogdet(covariance)[1]
    assert softer.trials.logdet[3] - problem.trials.logdet[3] == pytest.approx(gained)
    prior, bounds = problem.build_prior(base.model), problem.build_bounds(base.model)
    place = fit.own, fit.shared
    values = [solve_linearised(g, prior, bounds, place, fit.omega)[1] for g in (fit.gram, gram)]
    assert values[1] > values[0] + 30


def test_what_the_log_did_is_taken_from_the_residual(noisy):
    problem, base = noisy
    time = np.tile(TIME, (8, 1))
    assert not locate_disturbances(problem, base, time).any()
    size, _, directions = fit_disturbances(problem, base)
    softer = admit_disturbances(problem, size, directions)
    fit = softer.fit(base.model, (base.fit.own, base.fit.shared, base.fit.omega))
    moved = locate_disturbances(softer, Candidate(base.model, fit, fit.log_evidence), time)
    assert np.sqrt(np.mean(moved**2)) > 0.002


def test_a_gain_that_wanders_is_found_with_its_size_and_no_drift(record):
    """What wanders is in proportion to the deflection, and vanishes where the finger rests."""
    angles = record()
    values = angles["joint_angle"].values.copy()
    walk = np.cumsum(np.random.default_rng(7).standard_normal((8, 2, 500)), axis=2) / np.sqrt(500)
    values *= 1.0 + 0.02 * walk
    problem, fit = pose_problem(angles.assign(joint_angle=(angles["joint_angle"].dims, values)))
    base = Candidate(problem.base, fit, fit.log_evidence)
    size, evidence, directions = fit_disturbances(problem, base)
    assert max(evidence, key=evidence.get) == "gain_drift"
    assert size["gain_drift"] == pytest.approx(0.02, rel=0.4)
    assert evidence["gain_drift"] > 15.0
    assert "drift" not in size
    assert not directions["gain_drift"][:, :, 0].any()


def test_a_camera_that_turns_moves_the_first_joint_alone(record):
    """It wanders, and returns within 0.4 of a trial."""
    angles = record()
    values, noise = angles["joint_angle"].values.copy(), np.random.default_rng(11)
    turn = np.zeros((8, 500))
    for k in range(1, 500):
        turn[:, k] = 0.995 * turn[:, k - 1] + 0.1 * noise.standard_normal(8)
    sd = float(pose_problem(angles)[0].noise["noise_sd"][0])
    values[:, 0] += 1.5 * sd * turn
    problem, fit = pose_problem(angles.assign(joint_angle=(angles["joint_angle"].dims, values)))
    base = Candidate(problem.base, fit, fit.log_evidence)
    size, evidence, directions = fit_disturbances(problem, base)
    assert max(evidence, key=evidence.get) == "picture_turn"
    assert evidence["picture_turn"] > 15.0
    assert "drift" not in size
    assert not directions["picture_turn"][:, 1:].any()


def test_the_markers_of_a_link_move_the_joints_beside_it_apart(record):
    """They swim with the light, in waves of 0.45 of a trial and of half that."""
    angles = record()
    values, noise = angles["joint_angle"].values.copy(), np.random.default_rng(12)
    phase = 2.0 * np.pi * (np.arange(500) / 225.0 + noise.uniform(size=(8, 1)))
    sd = float(pose_problem(angles)[0].noise["noise_sd"][0])
    swims = sd * (np.sin(phase) + 0.5 * np.sin(2.2 * phase))
    values[:, 0] += swims
    values[:, 1] -= swims
    problem, fit = pose_problem(angles.assign(joint_angle=(angles["joint_angle"].dims, values)))
    base = Candidate(problem.base, fit, fit.log_evidence)
    _, evidence, directions = fit_disturbances(problem, base)
    assert max(evidence, key=evidence.get) == "link_turn_1"
    assert evidence["link_turn_1"] > 15.0
    assert not {"drift", "picture_turn"} & set(evidence)
    moved = directions["link_turn_1"]
    assert np.array_equal(moved[:, 0], -moved[:, 1])


def test_noise_that_outlasts_the_windows_is_no_drift(record):
    """Its memory is as long as half a plateau of the staircase, and windows find less of it."""
    angles = record()
    values, rng = angles["joint_angle"].values.copy(), np.random.default_rng(14)
    lasting = rng.standard_normal((8, 2, 500))
    lasting[:, :, 0] /= np.sqrt(1.0 - 0.98**2)
    for k in range(1, 500):
        lasting[:, :, k] += 0.98 * lasting[:, :, k - 1]
    values += 0.01 * lasting
    problem, fit = pose_problem(angles.assign(joint_angle=(angles["joint_angle"].dims, values)))
    base = Candidate(problem.base, fit, fit.log_evidence)
    size, evidence, _ = fit_disturbances(problem, base)
    assert (problem.noise["noise_autocorrelation"] < 0.96).all()
    assert list(size) == ["lasting_noise"]
    assert evidence["lasting_noise"] > 15.0


def test_noise_that_lasts_is_correlated_between_joints_as_the_noise_is(record):
    """As directions are measured: neighbouring joints err against each other."""
    angles = record()
    values, rng = angles["joint_angle"].values.copy(), np.random.default_rng(14)
    direction = rng.standard_normal((8, 3, 500))
    direction[:, :, 0] /= np.sqrt(1.0 - 0.98**2)
    for k in range(1, 500):
        direction[:, :, k] += 0.98 * direction[:, :, k - 1]
    values += 0.01 * np.diff(direction, axis=1)
    problem, fit = pose_problem(angles.assign(joint_angle=(angles["joint_angle"].dims, values)))
    base = Candidate(problem.base, fit, fit.log_evidence)
    size, _, directions = fit_disturbances(problem, base)
    assert list(size) == ["lasting_noise"]
    moved = directions["lasting_noise"].reshape(8, 2, -1)
    known = problem.noise["noise_correlation"].values
    np.testing.assert_allclose(np.corrcoef(moved[0])[0, 1], known[0, 1], atol=0.1)


def draw_flicker(rng, shape):
    """1/f noise of sd 1 (…, frame)."""
    frames = shape[-1]
    spectrum = np.fft.rfft(rng.standard_normal((*shape[:-1], 4 * frames)))
    spectrum /= np.sqrt(np.maximum(np.arange(spectrum.shape[-1]), 1))
    noise = np.fft.irfft(spectrum)[..., :frames]
    return noise / noise.std()


def test_noise_of_equal_power_in_each_octave_is_no_drift(record):
    angles = record()
    rng = np.random.default_rng(16)
    values = angles["joint_angle"].values + 0.004 * draw_flicker(rng, (8, 2, 500))
    problem, fit = pose_problem(angles.assign(joint_angle=(angles["joint_angle"].dims, values)))
    base = Candidate(problem.base, fit, fit.log_evidence)
    size, evidence, _ = fit_disturbances(problem, base)
    assert list(size) == ["flicker_noise"]
    assert evidence["flicker_noise"] > 15.0


def test_noise_that_is_new_in_every_frame_has_no_octaves(noisy):
    problem, base = noisy
    assert (problem.noise["noise_autocorrelation"] < 0.3).all()
    moved = list_disturbances(problem, base, {"flicker_noise"})["flicker_noise"]
    assert moved.shape[3] == 0


def test_noise_that_lasts_is_larger_where_the_noise_is(noisy):
    """With one size for all, the slow waves of loud trials are drifts."""
    problem, base = noisy
    scale = problem.trials.scale.copy()
    scale[2] *= 3.0
    scale[3, 10:] *= 0.5
    other = replace(problem, trials=problem.trials._replace(scale=scale))
    before, after = (
        list_disturbances(some, base, {"lasting_noise"})["lasting_noise"]
        for some in (problem, other)
    )
    factor = np.ones_like(before)
    factor[2] = 3.0
    factor[3, :, 20:] = 0.5
    np.testing.assert_allclose(after, factor * before)
    assert np.ptp(before) > 0.0


@pytest.mark.parametrize(("size", "found"), [(3.0, True), (60.0, False)])
def test_what_asks_for_more_than_a_drift_is_no_drift(record, size, found):
    """A camera drifts by a few times its noise; what is far beyond is physics that is missing."""
    angles = record()
    values, rng = angles["joint_angle"].values.copy(), np.random.default_rng(15)
    walk = np.cumsum(rng.standard_normal((8, 2, 500)), axis=2) / np.sqrt(500)
    values += size * 0.002 * walk
    problem, fit = pose_problem(angles.assign(joint_angle=(angles["joint_angle"].dims, values)))
    base = Candidate(problem.base, fit, fit.log_evidence)
    assert ("drift" in fit_disturbances(problem, base)[0]) is found


def test_a_known_disturbance_is_admitted_with_its_size(noisy):
    problem, base = noisy
    softer, fit = admit_known(problem, base.fit, {"noisy_load": 0.02})
    assert softer.disturbed == {"noisy_load": 0.02}
    assert (softer.trials.logdet > problem.trials.logdet).all()
    level = softer.trials.logdet.sum() - problem.trials.logdet.sum()
    assert fit.log_evidence - 0.5 * level > base.log_evidence + 30
    assert admit_known(problem, base.fit, {}) == (problem, base.fit)


def test_a_link_that_the_finger_lacks_is_refused(noisy):
    problem, base = noisy
    message = (
        r"measurement\.disturbances\.link_turn_3 of the model file: .* 2 joints and .*; remove"
    )
    with pytest.raises(Fault, match=message):
        admit_known(problem, base.fit, {"link_turn_3": 0.01})
    softer, _ = admit_known(problem, base.fit, {"link_turn_2": 0.01})
    assert softer.disturbed == {"link_turn_2": 0.01}


def test_rows_of_a_log_err_alone_unless_there_are_very_many():
    """Two rows of 0.5 s that err as one made a noisy log of 31 rows look like wire friction."""
    few, sd = _group_rows(0.04 + 1e-4 * np.arange(31))
    np.testing.assert_array_equal(few, np.arange(31))
    assert (sd == 1.0).all()
    rest, _ = _group_rows(np.array([2.0, 2.0, 0.0, 3.0, 3.0, 3.0]))  # a plateau is one reading
    assert rest.tolist() == [0, 0, -1, 1, 1, 1]
    many, sd = _group_rows(0.04 + 1e-5 * np.arange(600))
    assert 30 < many.max() < 64
    np.testing.assert_allclose(sd, np.bincount(many)[0] ** -0.5)


def test_one_clean_trial_has_no_disturbance(record):
    problem, fit = pose_problem(record().isel(trial=[0]))
    base = Candidate(problem.base, fit, fit.log_evidence)
    assert fit_disturbances(problem, base)[0] == {}


def test_a_fit_without_a_diagnosis_takes_what_its_residual_shows_into_the_noise(record):
    """A clean campaign's residual shows nothing."""
    plain, noisy = (prepare_fit(record(load_error=error)) for error in (0.0, 0.02))
    assert plain.recorded.problem.disturbed == {}
    assert describe_fit(plain.recorded.problem) == ""
    found = noisy.recorded.problem
    assert list(found.disturbed) == ["noisy_load"]
    assert "The load log scatters by 1.8 %" in describe_fit(found)
    blind, fit = pose_problem(record(load_error=0.02))
    known, naive = noisy.recorded.candidate.fit, fit
    assert known.log_evidence > naive.log_evidence + 30
    assert not blind.disturbed


def test_some_trials_show_what_all_suffer_from(record, monkeypatch):
    smaller = replace(posterior.BUDGET, disturbed_trials=4)
    monkeypatch.setattr(posterior, "BUDGET", smaller)
    found = prepare_fit(record(load_error=0.02)).recorded.problem
    assert found.disturbed["noisy_load"] == pytest.approx(0.02, rel=0.4)
    assert len(found.trials.name) == 8
