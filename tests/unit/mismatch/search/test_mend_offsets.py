"""Clocks of the camera that start in each trial elsewhere."""

import numpy as np
import pytest

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.inference.simulate import (
    build_recording,
    describe_noise,
    draw_angles,
    draw_parameters,
)
from softfinger.measurement.mend import mend_recordings
from softfinger.mechanics.effects.measurement_file import MeasurementEntry
from softfinger.mechanics.three_element import compute_joint_angle_array
from softfinger.mismatch.candidates.columns import collect_columns
from softfinger.mismatch.candidates.rank import list_pieces, rank_pieces
from softfinger.mismatch.posed import Posed, Survey, _add_effect, mend_offsets
from softfinger.mismatch.search.judge import judge
from softfinger.mismatch.search.log_and_clock import find_common, start_clocks

TIME = np.arange(0.0, 12.0, 1 / 30)
LATE = 0.03 * np.array([0.3, -1.4, 0.9, 0.1, 1.2, -0.6, -1.0, 0.5])
UNKNOWN = {f"link_{k}": ("joint", [np.nan]) for k in ("length", "mass", "centre", "inertia")}


def record(late, share=0.0):
    """Record 8 trials of three quick steps by a camera that is `late` (trial,) [s].

    A second Voigt element has a share of the elastic compliance, another in each trial.
    """
    rng, names = np.random.default_rng(9), [f"t{i}" for i in range(8)]
    rows = np.tile([0.0, 2.0, 2.0, 5.0, 5.0, 8.0, 8.0, 12.0], (8, 1))
    load = np.tile([0.0, 0.0, 0.03, 0.03, 0.01, 0.01, 0.05, 0.05], (8, 1))
    recording = build_recording(TIME, rows + late[:, None], load, 1, names)
    mean = np.array([[-2.4, -4.6, 2.9, 0.02]])
    own = draw_parameters(mean, np.array([0.2, 0.4, 0.7, 0.01]), recording, rng)
    noise = describe_noise(np.full(1, 0.002), np.zeros(1), 0.0)
    angles = draw_angles(recording, own, noise, rng)
    if share:
        stiff = own["k_v"] / (share * np.exp(0.3 * rng.standard_normal((8, 1))))
        series = TIME, rows[:, None] + late[:, None, None], load[:, None]
        more = compute_joint_angle_array(stiff, 2.0 * stiff, np.inf, 0.0, *series)
        angles["joint_angle"].values += more
    return angles.assign(
        load_time=(("trial", "knot"), rows),
        started_at=("trial", np.full(8, np.nan)),
        joint_length=np.nan,
        wire_offset=np.nan,
        **UNKNOWN,
    )


def pose(angles, ids=("camera_delay", "load_limit")):
    """Fit the base model and a part of the catalogue."""
    problem, fit = pose_problem(angles)
    base = Candidate(problem.base, fit, fit.log_evidence)
    pieces, refused = list_pieces(problem.setting)
    pieces = [piece for piece in pieces if piece.effect.id in ids]
    columns = collect_columns(problem, base, pieces)
    ranked = rank_pieces(problem, base, columns, lambda items, _: items)
    survey = Survey((pieces, refused), columns, None, 7.0, ranked)
    return Posed(angles, problem, base, survey, {}, MeasurementEntry())


@pytest.fixture(scope="module")
def scattered():
    return pose(record(0.08 + LATE))


def test_each_trial_starts_where_its_motion_has_it(scattered):
    """What the trials have in common is a delay of the camera."""
    again = []

    def pose_again(mended, known):
        again.append((mended, known))
        return scattered

    mend_offsets(scattered, pose_again)
    ((mended, known),) = again
    offset = np.array([mended.clock_offsets_s[f"t{i}"] for i in range(8)])
    np.testing.assert_allclose(offset, LATE.mean() - LATE, atol=0.002)
    sd, nats = known["clock_offset"]
    assert sd == pytest.approx(LATE.std(), rel=0.1)
    assert nats > 100.0
    right = pose(mend_recordings(scattered.angles, mended))
    best = right.survey.ranked[0][0]
    assert best.model.ids == {"camera_delay"}
    assert best.fit.shared[0] == pytest.approx(0.08 + LATE.mean(), abs=0.002)


@pytest.mark.parametrize("late", [0.0, 0.08])
def test_clocks_that_start_together_stay_as_they_are(late):
    posed = pose(record(np.full(8, late)))
    assert mend_offsets(posed, None) is posed
    best = posed.survey.ranked[0][0] if late else posed.base
    found = start_clocks(posed.plain, best, posed.base)
    if found is not None:  # what errors of the offsets explain is not worth their number
        gain = found.candidate.log_evidence - best.log_evidence
        assert gain - found.cost < 3.0


def test_offsets_are_not_set_right_where_an_effect_explains_more(scattered, monkeypatch):
    def judge_well(problem, *rest):
        found = judge(problem, *rest)
        return found._replace(evidence=found.evidence + 1e6 * (problem is scattered.plain))

    monkeypatch.setitem(mend_offsets.__globals__, "judge", judge_well)
    assert mend_offsets(scattered, None) is scattered


def test_a_second_effect_is_no_offset(scattered, monkeypatch):
    """What it leaves under the leader alone is explained in part by offsets."""
    pair = scattered.base._replace(log_evidence=0.0)

    def judge_well(problem, candidate, *rest):
        found = judge(problem, candidate, *rest)
        return found._replace(evidence=found.evidence + 1e6 * (candidate is pair))

    monkeypatch.setitem(mend_offsets.__globals__, "_add_effect", lambda *_: [pair])
    monkeypatch.setitem(mend_offsets.__globals__, "judge", judge_well)
    assert mend_offsets(scattered, None) is scattered


def test_pairs_are_a_leader_and_one_more_effect():
    posed = pose(record(np.full(8, 0.08), 0.3), ("camera_delay", "second_retardation"))
    leader = posed.survey.ranked[0][0]
    assert leader.model.ids == {"camera_delay"}
    best, *_ = _add_effect(posed, leader)
    assert best.model.ids == {"camera_delay", "second_retardation"}
    assert best.log_evidence > leader.log_evidence + 100.0


def test_a_model_without_motion_at_some_offset_has_none(scattered, monkeypatch):
    scan = start_clocks.__globals__["_scan_clocks"]

    def fail(problem, candidate, grid):
        return np.where(grid[:, None] < grid[1], np.nan, scan(problem, candidate, grid))

    monkeypatch.setitem(start_clocks.__globals__, "_scan_clocks", fail)
    monkeypatch.setitem(start_clocks.__globals__, "fit_again", None)  # nothing is fitted
    assert start_clocks(scattered.plain, scattered.base, scattered.base) is None


def test_a_mean_by_chance_stays():
    """What no more than the trials' scatter explains is no delay that they have in common."""
    error = LATE.std(ddof=1) / np.sqrt(len(LATE))
    assert find_common(LATE + 2.0 * error) == 0.0
    assert find_common(LATE - 4.0 * error) == pytest.approx(-4.0 * error)
    assert find_common(np.array([0.02])) == 0.02
