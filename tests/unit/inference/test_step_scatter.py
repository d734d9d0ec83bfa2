"""Steps of the load that come between the rows of a slow log."""

from dataclasses import replace

import numpy as np
import pytest

from softfinger.inference.disturbance_sizes import fit_disturbances
from softfinger.inference.disturbances import list_disturbances
from softfinger.inference.problem import Candidate, pose_problem
from softfinger.inference.simulate import (
    build_recording,
    describe_noise,
    draw_angles,
    draw_parameters,
)

TIME = np.arange(500) / 30
STEPS = np.array([0.53, 4.07, 8.02, 12.06])
LEVELS = np.array([0.02, 0.06, 0.01, 0.05])
GAP = 0.1
UNKNOWN = {f"link_{k}": ("joint", [np.nan] * 2) for k in ("length", "mass", "centre", "inertia")}


def record(phase):
    """Record 8 trials of 2 joints; the log has a row each 0.1 s, from the trial's phase on."""
    rng = np.random.default_rng(11)
    load = np.concatenate([[0.0], np.repeat(LEVELS, 2)[:-1]])
    recording = build_recording(
        TIME,
        np.tile(np.repeat(STEPS, 2), (8, 1)),
        np.tile(load, (8, 1)),
        2,
        [f"t{i}" for i in range(8)],
    )
    mean = np.array([[-2.4, -3.6, 2.9, 0.02], [-2.3, -3.5, 3.1, 0.01]])
    own = draw_parameters(mean, np.array([0.2, 0.4, 0.7, 0.01]), recording, rng)
    noise = describe_noise(np.full(2, 0.002), np.zeros(2), -0.5)
    angles = draw_angles(recording, own, noise, rng).drop_dims("knot")
    rows = np.asarray(phase(rng))[:, None] + GAP * np.arange(165)
    read = np.append(0.0, LEVELS)[np.searchsorted(STEPS, rows, side="right")]
    return angles.assign(
        load_time=(("trial", "knot"), rows),
        load_torque=(("trial", "knot"), read),
        started_at=("trial", np.full(8, np.nan)),
        joint_length=np.nan,
        wire_offset=np.nan,
        **UNKNOWN,
    )


@pytest.fixture(scope="module")
def slow():
    """Pose recordings under a log whose rows have another phase in each trial."""
    problem, fit = pose_problem(record(lambda rng: rng.uniform(0.0, GAP, 8)))
    return problem, Candidate(problem.base, fit, fit.log_evidence)


def test_steps_between_the_rows_of_a_slow_log_are_found(slow):
    problem, _ = slow
    assert problem.setting.step_gap == pytest.approx(GAP)
    size, evidence, _ = fit_disturbances(*slow)
    assert max(evidence, key=evidence.get) == "step_scatter"
    assert size["step_scatter"] == pytest.approx(1.0, rel=0.4)
    assert evidence["step_scatter"] > 1000.0


def test_a_load_that_runs_from_row_to_row_has_no_steps_to_scatter(slow):
    """The same log, and a finger that the load moved as the log has it."""
    problem, base = slow
    rng = np.random.default_rng(5)
    angle, _ = problem.simulate(base.model, base.fit.own, base.fit.shared, np.zeros(0, np.int64))
    mean = angle.reshape(8, 2, -1, 2).mean(axis=3).transpose(0, 2, 1)
    sd = np.sqrt(1.0 / np.diff(problem.trials.starts[0]))[:, None] * 0.002
    moved = mean.copy()
    moved[:, : len(sd)] += sd * rng.standard_normal((8, len(sd), 2))
    right = replace(problem, trials=problem.trials._replace(angle=moved))
    fit = right.fit(base.model, (base.fit.own, base.fit.shared, base.fit.omega))
    size, _, directions = fit_disturbances(right, Candidate(base.model, fit, fit.log_evidence))
    assert "step_scatter" in directions
    assert "step_scatter" not in size


def test_the_bridges_move_the_angles_as_steps_at_any_moment_do(slow):
    problem, base = slow
    columns = list_disturbances(problem, base, {"step_scatter"})["step_scatter"]
    trials, draws = problem.trials, []
    gap = int(np.flatnonzero(np.diff(trials.load_torque[0]))[0])
    first, last = trials.load_time[0, gap : gap + 2]
    for share in (np.arange(60) + 0.5) / 60:
        knots, torque = trials.load_time.copy(), trials.load_torque.copy()
        knots[0, gap - 1 : gap + 1] = first + share * GAP
        torque[0, gap] = torque[0, gap + 1]
        stepped = replace(problem, trials=trials._replace(load_time=knots, load_torque=torque))
        draws.append(stepped.simulate(base.model, base.fit.own, base.fit.shared)[0][0])
    node = trials.node[0].ravel()
    hats = columns.shape[3] // len(STEPS)
    foreseen = np.sqrt((columns[0, 0, :, :hats] ** 2).sum(axis=1))
    scatters = np.std(draws, axis=0)[0]
    after = (node > last + GAP) & (node < STEPS[1] - GAP)
    within = (node > first + 0.2 * GAP) & (node < last)
    assert within.sum() >= 4
    np.testing.assert_allclose(foreseen[after], scatters[after], rtol=0.05)
    np.testing.assert_allclose(foreseen[within], scatters[within], rtol=0.25)
    assert not columns[0, :, node < first].any()


def test_a_load_that_always_moves_has_no_steps(slow):
    """In more gaps than there can be hats."""
    problem, base = slow
    trials = problem.trials
    wave = np.where(trials.load_time > 3.0, 0.03 + 0.02 * np.cos(2.0 * trials.load_time), 0.0)
    moving = replace(problem, trials=trials._replace(load_torque=wave))
    assert "step_scatter" not in list_disturbances(moving, base)
