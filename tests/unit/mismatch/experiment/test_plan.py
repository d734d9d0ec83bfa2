"""The next experiment: lag and delay part under a plan that the old protocol did not show."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from softfinger.faults import Fault, ListedFault
from softfinger.inference.problem import Candidate, pose_problem
from softfinger.mechanics.effects.model_file import FittedTo
from softfinger.mismatch.candidates.rank import list_pieces
from softfinger.mismatch.experiment import plan as planning
from softfinger.mismatch.experiment import proposal
from softfinger.mismatch.experiment.account import describe_plan, tabulate_plan
from softfinger.mismatch.experiment.choice import assess
from softfinger.mismatch.experiment.limits import RigLimits
from softfinger.mismatch.experiment.outlook import measure_largest_angle
from softfinger.mismatch.experiment.plan import REPEATED, plan_next, repeat_protocol
from softfinger.mismatch.experiment.proposal import propose_experiment
from softfinger.mismatch.experiment.purposes import (
    ask_how_much,
    ask_whether,
    ask_which,
    foresee_question,
)
from softfinger.mismatch.experiment.survivors import (
    Survivor,
    describe_survivors,
    measure_uncertainty,
    read_survivors,
    refit_survivors,
    suppose_effects,
    write_survivors,
)

SHA = "a" * 64


@pytest.fixture(scope="module")
def posed(draw_campaign):
    """Recordings under one step each, and the base model."""
    angles = draw_campaign(2, 0.0)
    steps = angles["load_torque"].values.copy()
    steps[:, 2:] = steps[:, :1]
    short = angles.isel(frame=slice(0, 100)).assign(load_torque=(angles["load_torque"].dims, steps))
    problem, fit = pose_problem(short)
    base = Candidate(problem.base, fit, fit.log_evidence)
    return problem, Survivor("none", base, measure_uncertainty(problem, base), 1.0)


@pytest.fixture(scope="module")
def late(posed):
    """A lag and a delay of 60 ms each, as likely."""
    problem, base = posed
    pieces, _ = list_pieces(problem.setting)
    found = []
    for survivor in suppose_effects(problem, base, pieces, ["actuator_lag", "camera_delay"])[1:]:
        fit = survivor.candidate.fit._replace(shared=np.array([0.06]))
        covariance = survivor.covariance.copy()
        covariance[-1, -1] = 0.02**2
        candidate = survivor.candidate._replace(fit=fit)
        found.append(survivor._replace(candidate=candidate, covariance=covariance, probability=0.5))
    return found


def set_limits(problem, **change):
    usual = RigLimits(0.04, 2.0, np.inf, 3.0, 4, 20.0, problem.trials.interval, 500)
    return usual._replace(**change)


@pytest.fixture(scope="module")
def planned(posed, late):
    problem, _ = posed
    return plan_next(problem, ask_which(late), set_limits(problem), np.random.default_rng(1))


def test_a_plan_tells_lag_from_delay_better_than_the_old_protocol(planned):
    first, before = planned.expected[planned.best.name], planned.expected[REPEATED]
    assert first.worth >= max(part.worth for part in planned.expected.values())
    assert first.worth > before.worth
    assert first.sure >= before.sure
    assert first.right <= first.sure + 1e-9


def test_a_plan_keeps_the_angle_under_every_survivor(posed, planned):
    problem, _ = posed
    assert planned.largest_angle <= planned.limits.angle
    survivors = planned.question.survivors
    assert measure_largest_angle(problem, survivors, planned.best.protocol) <= planned.limits.angle


def test_an_angle_that_is_recalled_binds_trials_like_those_recorded_alone(posed, late):
    """Hundreds of drawn trials go further than those recorded."""
    problem, _ = posed
    reached = measure_largest_angle(problem, late, repeat_protocol(problem, 2))
    limits = set_limits(problem, trials=2, minutes=1.0, angle=0.9 * reached)
    drawn, recalled = (
        plan_next(problem, ask_which(late), asked, np.random.default_rng(1), short=True)
        for asked in (limits, limits._replace(recalled=True))
    )
    assert drawn.largest_angle <= limits.angle
    seen = measure_largest_angle(problem, late, recalled.best.protocol)
    assert recalled.largest_angle == seen <= limits.angle
    loads = [plan.best.protocol.load_torque.max() for plan in (drawn, recalled)]
    assert loads[0] < 0.95 * loads[1]


def test_a_plan_is_told_in_a_sentence_and_drawn(posed, planned):
    said = describe_plan(planned, "torque_nm", 1.0)
    assert "actuator_lag and camera_delay apart" in said["statement"]
    assert set(said["expected_gain_nats"]) == {"actuator_lag", "camera_delay"}
    assert REPEATED in said["compared"]
    table = tabulate_plan(posed[0], planned, "synthetic")
    assert np.allclose(table["apart"].isel(survivor=0), 0.0)
    assert float(np.abs(table["apart"].isel(survivor=1)).max()) > 0.5


def test_what_no_protocol_within_the_limits_shows_is_named_with_the_limit(posed):
    """A stop far away: the load would have to be larger."""
    problem, base = posed
    pieces, _ = list_pieces(problem.setting)
    question = ask_whether(suppose_effects(problem, base, pieces, ["stress_nonlinear_flow"]))
    limits = set_limits(problem, load=0.002, trials=2, minutes=1.0)
    found = plan_next(problem, question, limits, np.random.default_rng(1))
    assert set(found.hidden) == {"stress_nonlinear_flow"}
    said = describe_plan(found, "torque_nm", 1.0)
    assert "Nothing within the limits shows stress_nonlinear_flow" in said["statement"]


@pytest.mark.parametrize(("load", "told"), [(0.04, ["actuator_lag", "camera_delay"]), (0.0005, [])])
def test_an_ambiguous_verdict_proposes_a_plan_or_states_the_limit_in_the_way(
    posed, late, monkeypatch, load, told
):
    """Few protocols tried may show nothing; it proposed nothing then."""
    problem, _ = posed
    found = SimpleNamespace(
        problem=problem,
        posterior=SimpleNamespace(equivalent=[("actuator_lag",), ("camera_delay",)]),
        verdict=SimpleNamespace(decision="ambiguous", not_testable=[]),
    )
    names = problem.trials.name
    angles = xr.Dataset(
        {"load_kind": ("trial", np.full(len(names), "torque_nm"))}, {"trial": names}
    )
    limits = set_limits(problem, load=load, trials=2, minutes=1.0, recalled=True)
    monkeypatch.setattr(proposal, "list_survivors", lambda *_: late)
    monkeypatch.setattr(proposal, "recall_limits", lambda *_: limits)
    said = propose_experiment(found, angles)
    assert said["tells_apart"] == told
    assert bool(said["loads"]) == bool(told)
    if not told:
        assert said["statement"] == (
            "Nothing within the limits separates actuator_lag and camera_delay: a camera 10 "
            "times as fast would."
        )


def test_sizes_are_narrowed_and_an_unknown_one_is_refused(posed):
    problem, base = posed
    question = ask_how_much(problem, base, ["k_v", "spread_k_v", "angle_at_5"])
    limits = set_limits(problem, trials=2, minutes=1.0)
    found = plan_next(problem, question, limits, np.random.default_rng(1))
    assert found.expected[found.best.name].worth > 0.0
    assert "narrow k_v" in describe_plan(found, "torque_nm", 1.0)["statement"]
    with pytest.raises(Fault, match="--narrow nothing"):
        ask_how_much(problem, base, ["nothing"])


def test_survivors_are_fitted_again_from_their_file(posed, late, tmp_path):
    problem, base = posed
    fitted = FittedTo(campaign="drawn", sha256=SHA)
    file = tmp_path / "survivors.yaml"
    halves = [base._replace(probability=0.25), late[1]._replace(probability=0.75)]
    write_survivors(describe_survivors(halves, fitted, "ambiguous", ["gravity"]), file)
    content = read_survivors(file, SHA)
    assert content.hidden == ["gravity"]
    again = refit_survivors(problem, base.candidate, content)
    assert [s.label for s in again] == ["none", "camera_delay"]
    assert [s.probability for s in again] == [0.25, 0.75]
    with pytest.raises(Fault, match="other recordings"):
        read_survivors(file, "b" * 64)
    file.write_text("version: 1\n")
    with pytest.raises(ListedFault, match="survivors"):
        read_survivors(file, SHA)


def test_where_a_model_has_no_motion_under_the_best_plan_the_next_is_taken(
    posed, late, monkeypatch
):
    """A lowered load made a swinging finger's motion diverge, and the diagnosis ended."""
    problem, _ = posed
    question, limits = ask_which(late), set_limits(problem)
    first, made = [], planning._make_safe

    def make_safe(problem, question, limits, best, seed):
        safe, largest = made(problem, question, limits, best, seed)
        first.append(safe)
        return safe, largest

    def assess_but_first(protocol, purpose):
        if first and protocol is first[0].protocol:
            return -np.inf
        return assess(protocol, purpose)

    monkeypatch.setattr(planning, "_make_safe", make_safe)
    monkeypatch.setattr(planning, "assess", assess_but_first)
    rng = np.random.default_rng(1)
    plan = plan_next(problem, question, limits, rng, short=True)
    assert plan.best is first[1]
    assert np.isfinite(plan.expected[plan.best.name].worth)
    assert describe_plan(plan, "load", 1.0)["protocol"] == plan.best.name


def test_a_model_without_motion_makes_a_protocol_worthless_without_a_warning(posed, late):
    problem, _ = posed
    lag = late[0]
    wild = lag.candidate.fit._replace(own=np.nan * lag.candidate.fit.own)
    lost = [lag._replace(candidate=lag.candidate._replace(fit=wild)), *late[1:]]
    with pytest.raises(ArithmeticError, match="has no motion"):
        foresee_question(problem, ask_which(lost), repeat_protocol(problem, 2), 2, 0.05)
