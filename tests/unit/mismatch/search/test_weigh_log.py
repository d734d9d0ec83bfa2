"""Whether the load follows what its log reads on a plateau, or the log errs."""

from dataclasses import replace
from functools import partial
from importlib import import_module
from itertools import chain
from types import SimpleNamespace

import numpy as np
import pytest

from softfinger.campaign.load_log import build_load_array
from softfinger.inference.disturbance_sizes import fit_disturbances
from softfinger.inference.disturbances import CLOCKS
from softfinger.inference.problem import Candidate, pose_problem
from softfinger.inference.simulate import (
    build_recording,
    describe_noise,
    draw_angles,
    draw_parameters,
)
from softfinger.measurement.measure import add_components
from softfinger.measurement.mend import mend_recordings
from softfinger.measurement.steady import steady_log
from softfinger.mechanics.effects.measurement_file import MeasurementEntry
from softfinger.mismatch import posed as diagnosed
from softfinger.mismatch.posed import Posed, mend_clock, mend_steps, pose_load
from softfinger.mismatch.search.judge import _carry_over
from softfinger.mismatch.search.log_and_clock import find_clock_rate, weigh_log
from softfinger.mismatch.search.place_steps import PlacedSteps, place_steps

whole = import_module("softfinger.mismatch.diagnose")  # the package has a function of this name
TIME = np.arange(300) / 15
ROWS = np.arange(21.0)
UNKNOWN = {f"link_{k}": ("joint", [np.nan]) for k in ("length", "mass", "centre", "inertia")}


def record(follows):
    """Record 6 trials under a load that scatters by 1 %, or only its log does."""
    rng = np.random.default_rng(5)
    steady = np.where(ROWS < 10, 0.03, 0.05) * np.ones((6, 1))
    scattered = steady * (1.0 + 0.01 * rng.standard_normal(steady.shape))
    names = [f"t{i}" for i in range(6)]
    known = scattered if follows else steady
    recording = build_recording(TIME, np.tile(ROWS, (6, 1)), known, 1, names)
    mean = np.array([[-2.4, -3.6, 2.9, 0.02]])
    own = draw_parameters(mean, np.array([0.2, 0.4, 0.7, 0.01]), recording, rng)
    angles = draw_angles(recording, own, describe_noise(np.full(1, 0.001), np.zeros(1), 0.0), rng)
    return angles.assign(
        load_torque=(("trial", "knot"), scattered),
        started_at=("trial", np.full(6, np.nan)),
        joint_length=np.nan,
        wire_offset=np.nan,
        **UNKNOWN,
    )


def steady_lines(angles):
    """Steady plateaus, and a line over the gap in which a step came."""
    return mend_recordings(angles, MeasurementEntry(steady_load=True, steps_open=True))


@pytest.mark.parametrize(("follows", "sign"), [(False, 1.0), (True, -1.0)])
def test_the_motion_decides_whether_the_load_or_its_log_scatters(follows, sign):
    angles = record(follows)
    problem, fit = pose_problem(angles)
    base = Candidate(problem.base, fit, fit.log_evidence)
    assert steady_log(angles)[1] == pytest.approx(0.01, rel=0.25)
    assert sign * weigh_log(problem, base, [], steady_lines(angles), 7.0) > 20.0


@pytest.mark.parametrize("follows", [False, True])
def test_the_steady_log_comes_first_and_stays_where_the_motion_prefers_it(follows):
    angles, posed = record(follows), []

    def pose(mended, known):
        right = mend_recordings(angles, mended)
        problem, fit = pose_problem(right)
        base = Candidate(problem.base, fit, fit.log_evidence)
        survey = SimpleNamespace(ranked=([], []), needed=7.0)
        posed.append(mended.steady_load)
        return Posed(right, problem, base, survey, known, mended)

    found = pose_load(angles, pose)
    assert posed == ([True, True, False] if follows else [True, True])
    assert found.mended.steps_open == (not follows)  # no jump: a line from row to row
    assert found.mended.steady_load == (not follows)
    assert ("noisy_load" in found.known) == (not follows)
    if not follows:
        component = found.plain.noise["component"].values.tolist()
        assert component.count("noisy_load") == 1
    posed.clear()
    angles = steady_log(angles)[0]
    pose_load(angles, pose)
    assert posed == [False, False]  # steady already: its step alone is placed


@pytest.mark.parametrize(("explained", "follows"), [(1000.0, True), (10000.0, False)])
def test_a_log_takes_no_more_than_the_best_effect_may_leave(explained, follows, monkeypatch):
    angles, posed = record(follows=False), []
    problem, fit = pose_problem(steady_lines(angles))
    base = Candidate(problem.base, fit, fit.log_evidence)
    survey = SimpleNamespace(ranked=([], []), needed=7.0)
    leader = base._replace(log_evidence=base.log_evidence + explained)
    monkeypatch.setattr(diagnosed, "weigh_log", lambda *_: 20.0)
    monkeypatch.setattr(diagnosed, "find_leader", lambda *_: leader)

    def pose(mended, known):
        posed.append(mended.steady_load)
        return Posed(angles, problem, base, survey, known, mended)

    pose_load(angles, pose)
    assert posed == ([True, False] if follows else [True])


def test_readings_that_no_model_follows_are_no_evidence(monkeypatch):
    """An infinite evidence went into the verdict, which cannot have one."""
    angles = record(follows=False)
    problem, fit = pose_problem(steady_lines(angles))
    base = Candidate(problem.base, fit, fit.log_evidence)
    survey = SimpleNamespace(ranked=([], []), needed=7.0)
    monkeypatch.setattr(diagnosed, "weigh_log", lambda *_: -np.inf)
    found = pose_load(
        angles, lambda mended, known: Posed(angles, problem, base, survey, known, mended)
    )
    assert found.known == {}


def test_a_log_of_steady_plateaus_stays_as_it_is():
    angles = record(follows=False)
    steady, _ = steady_log(angles)
    again, error = steady_log(steady)
    assert error == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(again["load_torque"], steady["load_torque"])


def test_more_of_a_component_adds_to_what_is_there():
    angles = record(follows=False)
    problem, _ = pose_problem(angles)
    once = add_components(problem.noise, {"noisy_load": 0.003}, {"noisy_load": 10.0})
    twice = add_components(once, {"noisy_load": 0.004}, {"noisy_load": 5.0})
    found = twice.sel(component="noisy_load")
    assert float(found["component_size"]) == pytest.approx(0.005)
    assert float(found["component_evidence"]) == pytest.approx(15.0)


def test_a_clock_that_runs_slow_is_found():
    angles = record(follows=True)
    late = angles.assign(time=angles["time"] / 1.002)
    problem, fit = pose_problem(late)
    rate, nats = find_clock_rate(problem, Candidate(problem.base, fit, fit.log_evidence))
    assert rate == pytest.approx(0.002, rel=0.2)
    assert nats > 20.0
    problem, fit = pose_problem(angles)
    assert find_clock_rate(problem, Candidate(problem.base, fit, fit.log_evidence))[1] < 6.0


def test_under_one_step_a_rate_is_an_offset_that_all_trials_share(monkeypatch):
    """Which of the two a residual shows is decided by rounding."""
    rng, names = np.random.default_rng(6), [f"t{i}" for i in range(8)]
    rows = np.tile([0.0, 1.0, 1.001, 30.0], (8, 1))
    load = np.tile([0.0, 0.0, 0.04, 0.04], (8, 1))
    recording = build_recording(TIME, rows, load, 1, names)
    mean = np.array([[-2.4, -3.6, 2.9, 0.02]])
    own = draw_parameters(mean, np.array([0.2, 0.4, 0.7, 0.01]), recording, rng)
    noise = describe_noise(np.full(1, 0.001), np.zeros(1), 0.0)
    angles = draw_angles(recording, own, noise, rng).assign(
        started_at=("trial", np.full(8, np.nan)), joint_length=np.nan, wire_offset=np.nan, **UNKNOWN
    )
    late = angles.assign(time=angles["time"] / 1.002)
    problem, fit = pose_problem(late)
    base = Candidate(problem.base, fit, fit.log_evidence)
    assert len(fit_disturbances(problem, base)[0].keys() & CLOCKS) == 1
    offset = {"clock_offset": 0.002}
    known = mend_clock.__globals__
    monkeypatch.setitem(known, "fit_disturbances", lambda *_: (offset, {}, {}))
    survey = SimpleNamespace(ranked=([], []), needed=7.0)
    posed = Posed(late, problem, base, survey, {}, MeasurementEntry())
    mended, _ = mend_clock(posed, lambda mended, known: (mended, known))
    assert mended.clock_rate == pytest.approx(0.002, rel=0.2)


def record_steps(early):
    """Record 8 trials of a step sooner than its row.

    `early` is a number or (8, 1) [s]; the rows are 40 ms apart.
    """
    rng, names = np.random.default_rng(6), [f"t{i}" for i in range(8)]
    load = np.tile([0.0, 0.0, 0.04, 0.04], (8, 1))
    came = np.array([0.0, 1.0, 1.0, 20.0]) - early * np.array([0.0, 1.0, 1.0, 0.0])
    came = np.broadcast_to(came, (8, 4))
    recording = build_recording(TIME, came, load, 1, names)
    mean = np.array([[-2.4, -3.6, 2.9, 0.02]])
    own = draw_parameters(mean, np.array([0.2, 0.4, 0.7, 0.01]), recording, rng)
    noise = describe_noise(np.full(1, 0.001), np.zeros(1), 0.0)
    rows = np.tile([0.0, 0.96, 1.0, 1.0, 20.0], (8, 1))
    read = np.tile([0.0, 0.0, 0.0, 0.04, 0.04], (8, 1))
    drawn = draw_angles(recording, own, noise, rng).drop_dims("knot")
    return drawn.assign(
        load_time=(("trial", "knot"), rows),
        load_torque=(("trial", "knot"), read),
        started_at=("trial", np.full(8, np.nan)),
        joint_length=np.nan,
        wire_offset=np.nan,
        **UNKNOWN,
    )


def pose_as(posed, mended, known):
    """Keep what was mended, and nothing else."""
    return posed._replace(mended=mended, known=known)


@pytest.mark.parametrize("early", [0.0, 0.018, 0.04])
def test_a_step_comes_within_the_gap_of_its_log(early):
    angles = record_steps(early)
    problem, fit = pose_problem(angles)
    assert problem.setting.step_gap == pytest.approx(0.04)
    base = Candidate(problem.base, fit, fit.log_evidence)
    share, is_open, each, nats, *_ = place_steps(problem, base, [], 7.0)
    assert share == pytest.approx(early / 0.04, abs=0.05)
    assert not is_open
    assert each is None
    assert (nats > 20.0) == (early > 0.0)
    survey = SimpleNamespace(ranked=([], []), needed=7.0)
    posed = Posed(angles, problem, base, survey, {}, MeasurementEntry())
    found = mend_steps(posed, partial(pose_as, posed))
    if early == 0.0:
        assert found is posed
        return
    assert found.mended.steps_early == share
    assert found.known["step_time"] == (pytest.approx(share * 0.04), nats)
    mended = mend_recordings(angles, found.mended)
    np.testing.assert_allclose(mended["load_time"].values[:, 2:4], 1.0 - early, atol=2e-3)


def test_steps_that_came_at_their_rows_are_left_there_by_one_fit(monkeypatch):
    problem, fit = pose_problem(record_steps(0.0))
    base = Candidate(problem.base, fit, fit.log_evidence)
    fit_again, fits = place_steps.__globals__["fit_again"], []
    count = {"fit_again": lambda *with_: fits.append(with_) or fit_again(*with_)}
    monkeypatch.setitem(place_steps.__globals__, *count.popitem())
    assert place_steps(problem, base, [], 7.0) == PlacedSteps()
    assert len(fits) <= 1 + 2 + 4  # opened steps are fitted twice, placed ones in each round


def explain_all(fit, name, base=None):
    """An effect that explains far more than anything else could, and moves as the base model."""
    moves = {k: getattr(base, k) for k in ("fill_slots", "fill_tangents") if base is not None}
    model = SimpleNamespace(ids=frozenset({name}), **moves)
    return SimpleNamespace(model=model, fit=fit, log_evidence=fit.log_evidence + 1e5)


def test_a_step_stays_where_an_effect_explains_more_at_its_row(monkeypatch):
    angles = record_steps(0.018)
    problem, fit = pose_problem(angles)
    base = Candidate(problem.base, fit, fit.log_evidence)
    effect = explain_all(fit, "inertia", base.model)
    assert place_steps(problem, base, [], 7.0).early > 0.0
    fit_again = place_steps.__globals__["fit_again"]

    def refit(problem, candidate, base):  # the effect gains nothing from sooner steps
        return effect if candidate is effect else fit_again(problem, candidate, base)

    monkeypatch.setitem(place_steps.__globals__, "fit_again", refit)
    assert place_steps(problem, base, [effect], 7.0) == PlacedSteps()


def test_steps_that_come_at_any_moment_of_their_gaps_are_each_placed():
    early = np.random.default_rng(4).uniform(0.0, 0.04, (8, 1))
    angles = record_steps(early)
    problem, fit = pose_problem(angles)
    base = Candidate(problem.base, fit, fit.log_evidence)
    steps = place_steps(problem, base, [], 7.0)
    np.testing.assert_allclose(steps.each * 0.04, early, atol=3e-3)
    assert steps.nats > 20.0
    survey = SimpleNamespace(ranked=([], []), needed=7.0)
    posed = Posed(angles, problem, base, survey, {}, MeasurementEntry())
    _, _, _, _, known, entry = mend_steps(posed, partial(pose_as, posed))
    assert entry == MeasurementEntry(
        step_shares=dict(zip(problem.trials.name, steps.each.tolist(), strict=True))
    )
    assert known == {"step_moments": (pytest.approx(early.mean(), abs=2e-3), steps.nats)}
    mended = mend_recordings(angles, entry)
    placed, fit = pose_problem(mended)
    np.testing.assert_allclose(mended["load_time"][:, 2:4] + early, 1.0, atol=3e-3)
    assert not fit_disturbances(placed, Candidate(placed.base, fit, fit.log_evidence))[0]


@pytest.mark.parametrize(("evidence", "share"), [(50.0, 0.25), (10.0, 0.75)])
def test_steps_are_placed_anew_by_what_leads_once_they_are_placed(monkeypatch, evidence, share):
    problem, fit = pose_problem(record_steps(0.018))
    base = Candidate(problem.base, fit, fit.log_evidence)
    effect = Candidate(SimpleNamespace(ids=frozenset({"inertia"})), fit, fit.log_evidence + 90.0)
    posed = Posed(
        None, problem, base, SimpleNamespace(ranked=([], []), needed=7.0), {}, MeasurementEntry()
    )
    led = SimpleNamespace(ranked=([effect], []), needed=7.0)

    def place(plain, base, singles, needed):
        each = np.full((8, 1), 0.25 if singles else 0.75)
        return PlacedSteps(each=each, nats=5.0, evidence=evidence if singles else 10.0)

    monkeypatch.setattr(diagnosed, "place_steps", place)
    monkeypatch.setattr(diagnosed, "fit_again", lambda plain, candidate, base: candidate)
    found = mend_steps(
        posed, lambda mended, known: posed._replace(survey=led, mended=mended, known=known)
    )
    assert set(chain(*found.mended.step_shares.values())) == {share}


def test_more_steps_than_can_be_placed_are_open(monkeypatch):
    budget = place_steps.__globals__["BUDGET"]
    monkeypatch.setitem(place_steps.__globals__, "BUDGET", replace(budget, placed_steps=0))
    angles = record_steps(np.random.default_rng(4).uniform(0.0, 0.04, (8, 1)))
    problem, fit = pose_problem(angles)
    base = Candidate(problem.base, fit, fit.log_evidence)
    steps = place_steps(problem, base, [], 7.0)
    assert steps.is_open
    assert steps.nats > 20.0
    survey = SimpleNamespace(ranked=([], []), needed=7.0)
    posed = Posed(angles, problem, base, survey, {}, MeasurementEntry())
    _, _, _, _, known, entry = mend_steps(posed, partial(pose_as, posed))
    assert entry == MeasurementEntry(steps_open=True)
    assert known == {}
    mended = mend_recordings(angles, entry)
    opened, fit = pose_problem(mended)
    size, _, _ = fit_disturbances(opened, Candidate(opened.base, fit, fit.log_evidence))
    assert size["step_scatter"] == pytest.approx(1.0, rel=0.5)


def test_what_was_mended_is_kept_where_other_frames_count():
    problem, _ = pose_problem(record(follows=True))
    mended = add_components(problem.noise, {"noisy_load": 0.003}, {"noisy_load": 10.0})
    kept = _carry_over(problem.noise, mended)
    assert float(kept["component_size"].sel(component="noisy_load")) == pytest.approx(0.003)
    placed = add_components(problem.noise, {"step_time": 0.01}, {"step_time": 10.0})
    assert "step_time" in _carry_over(problem.noise, placed)["component"]
    assert _carry_over(problem.noise, problem.noise) is problem.noise


def test_a_clock_is_not_set_where_an_effect_explains_more():
    angles = record(follows=True)
    late = angles.assign(time=angles["time"] / 1.002)
    problem, fit = pose_problem(late)
    base = Candidate(problem.base, fit, fit.log_evidence)
    effect = explain_all(fit, "camera_delay")

    def mend(singles):
        survey = SimpleNamespace(ranked=(singles, []), needed=7.0)
        posed = Posed(late, problem, base, survey, {}, MeasurementEntry())
        return mend_clock(posed, lambda mended, known: (mended, known))

    mended, known = mend([])
    assert mended.clock_rate == pytest.approx(0.002, rel=0.1)
    assert known["clock_rate"][0] == abs(mended.clock_rate)
    assert mend([effect]).angles is late


@pytest.mark.parametrize("follows", [False, True])
def test_chance_is_calibrated_for_the_load_that_counts(follows, monkeypatch):
    calibrated, calibrate = [], whole.calibrate_false_alarms

    def note(columns, problem, *rest):
        calibrated.append(np.ptp(problem.trials.load_torque[0, 1:9]) > 0.0)
        return calibrate(columns, problem, *rest)

    monkeypatch.setattr(whole, "calibrate_false_alarms", note)
    config = {
        "bootstrap_replicates": 99,
        "false_alarm_probability": 0.05,
        "sample_repaired": False,
        "longest_search_s": 600.0,
    }
    whole.diagnose(record(follows), config, 5, lambda items, _: items)
    assert calibrated == ([False, True] if follows else [False])


def pose_base(angles, mended, known):
    """Fit the base model to recordings that were set right."""
    right = mend_recordings(angles, mended)
    problem, fit = pose_problem(right)
    base = Candidate(problem.base, fit, fit.log_evidence)
    survey = SimpleNamespace(ranked=([], []), needed=7.0)
    return Posed(right, problem, base, survey, known, mended)


@pytest.mark.parametrize("stays", [False, True])
def test_the_motion_decides_whether_a_rig_holds_its_set_points(stays):
    """A stair that was read as lines from row to row showed a delay of half a row."""
    angles = record(follows=False)
    rows = np.arange(401) / 20  # nearer to each other than 1.5 frames
    ramp = 0.05 * np.interp(rows, [1.0, 9.0, 17.0], [0.0, 1.0, 0.0])
    log = [np.tile(part, (6, 1)) for part in build_load_array(rows, ramp, 0.1)]
    acting = log if stays else (np.tile(rows, (6, 1)), np.tile(ramp, (6, 1)))
    rng = np.random.default_rng(6)
    recording = build_recording(TIME, *acting, 1, angles["trial"].values.tolist())
    mean = np.array([[-2.4, -3.6, 2.9, 0.02]])
    own = draw_parameters(mean, np.array([0.2, 0.4, 0.7, 0.01]), recording, rng)
    noise = describe_noise(np.full(1, 0.001), np.zeros(1), 0.0)
    moved = draw_angles(recording, own, noise, rng)["joint_angle"]
    named = zip(("load_time", "load_torque"), log, strict=True)
    read = angles.drop_dims("knot").assign(joint_angle=moved)
    read = read.assign({name: (("trial", "knot"), part) for name, part in named})

    assert pose_load(read, partial(pose_base, read)).mended.ramps_held == stays


@pytest.mark.parametrize("zero", [0.0, 0.0004])
def test_the_zero_of_a_load_cell_is_no_load(zero):
    """It began with the log, and showed joints that were not at rest at the start."""
    rng = np.random.default_rng(7)
    offset = zero * rng.standard_normal((6, 1))
    rows = np.tile(np.array([0.0, 2.0, 2.0, 12.0, 12.0, 20.0]), (6, 1))
    acting = np.tile(np.array([0.0, 0.0, 0.04, 0.04, 0.02, 0.02]), (6, 1))
    recording = build_recording(TIME, rows, acting, 1, [f"t{i}" for i in range(6)])
    mean = np.array([[-2.4, -3.6, 2.9, 0.02]])
    own = draw_parameters(mean, np.array([0.2, 0.4, 0.7, 0.01]), recording, rng)
    noise = describe_noise(np.full(1, 0.001), np.zeros(1), 0.0)
    angles = draw_angles(recording, own, noise, rng).assign(
        started_at=("trial", np.full(6, np.nan)),
        joint_length=np.nan,
        wire_offset=np.nan,
        **UNKNOWN,
    )
    before = np.pad(acting + offset, ((0, 0), (1, 0)))
    log = {"load_time": np.pad(rows, ((0, 0), (1, 0))), "load_torque": before}
    read = angles.drop_dims("knot").assign({k: (("trial", "knot"), v) for k, v in log.items()})
    found = pose_load(read, partial(pose_base, read))
    assert found.mended.load_tared == ("load_zero" in found.known) == (zero > 0.0)
    if zero:
        size, nats = found.known["load_zero"]
        assert size == pytest.approx(np.sqrt(np.mean(offset**2)) / 0.04, rel=0.05)
        assert nats > 10.0


def test_a_step_in_a_wide_gap_is_placed_to_a_hundredth_of_it():
    """By a motion that is quick: places an eighth of the gap apart are not enough."""
    rng, time = np.random.default_rng(4), np.arange(0.0, 6.0, 0.02)
    rows = 0.1 * np.arange(60.0)
    share = rng.uniform(size=(6, 2))
    at = rows[[15, 40]] - 0.1 * share
    names = [f"t{i}" for i in range(6)]
    knots = np.column_stack([np.zeros(6), np.repeat(at, 2, axis=1), np.full(6, 6.0)])
    recording = build_recording(
        time, knots, np.tile([0, 0, 0.05, 0.05, 0.02, 0.02], (6, 1)), 1, names
    )
    mean = np.array([[-2.4, -4.4, 2.9, 0.02]])
    own = draw_parameters(mean, np.array([0.2, 0.2, 0.7, 0.01]), recording, rng)
    angles = draw_angles(recording, own, describe_noise(np.full(1, 0.0003), np.zeros(1), 0.0), rng)
    log = np.select([rows < rows[15], rows < rows[40]], [0.0, 0.05], 0.02)
    logged = angles.drop_dims("knot").assign(
        load_time=(("trial", "knot"), np.tile(rows, (6, 1))),
        load_torque=(("trial", "knot"), np.tile(log, (6, 1))),
        started_at=("trial", np.full(6, np.nan)),
        joint_length=np.nan,
        wire_offset=np.nan,
        **UNKNOWN,
    )
    problem, fit = pose_problem(steady_log(logged)[0])
    base = Candidate(problem.base, fit, fit.log_evidence)
    steps = place_steps(problem, base, [], 7.0)
    np.testing.assert_allclose(steps.each, share, atol=0.01)
