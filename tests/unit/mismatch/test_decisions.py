"""What each number that decides does: the effect of those that no other test shows."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.mismatch.candidates.rank import competing_nats
from softfinger.mismatch.checks import slips as slips_module
from softfinger.mismatch.checks.free_form import _list_joints
from softfinger.mismatch.checks.free_form_terms import list_terms
from softfinger.mismatch.checks.lines import find_line
from softfinger.mismatch.checks.locate import label_phase, list_trial_covariates, locate_within
from softfinger.mismatch.checks.slips import find_slips
from softfinger.mismatch.checks.summary import compute_excess
from softfinger.mismatch.experiment import proposal
from softfinger.mismatch.experiment.choice import Choice
from softfinger.mismatch.experiment.plan import Expected, NextExperiment
from softfinger.mismatch.experiment.protocols import PlannedProtocol, build_design
from softfinger.mismatch.search import judge as judge_module
from softfinger.mismatch.tables.predict import list_levels
from softfinger.mismatch.tables.repair import share_inside
from softfinger.mismatch.verdict import conclude as conclude_module
from softfinger.mismatch.verdict.conclude import describe_remaining, keep_likely, locate_misfit


@pytest.fixture(scope="module")
def posed(draw_campaign):
    angles = draw_campaign(2, 0.0)
    problem, fit = pose_problem(angles)
    return problem, Candidate(problem.base, fit, fit.log_evidence), angles


def test_models_compete_within_nats_or_a_share():
    assert competing_nats(20.0) == 10.0
    assert competing_nats(1000.0) == pytest.approx(150.0)


@pytest.mark.parametrize(("sds", "joints"), [(2.5, []), (3.5, [2])])
def test_a_joint_is_listed_where_its_spline_is_clearly_off_zero(sds, joints):
    shape = xr.Dataset(
        {
            "value": (("quantity", "place"), [[0.0, 0.01], [0.0, -0.02 * sds]]),
            "sd": (("quantity", "place"), np.full((2, 2), 0.02)),
        },
        {"quantity": ["angle_1", "angle_2"]},
    )
    assert _list_joints(shape) == joints


def locate(monkeypatch, q_value):
    """Cells of two windows in two joints, of which one misses."""
    value = np.full((2, 1, 2), 1.0)
    value[1, 0, 1] = q_value
    dims = ("joint", "phase", "window")
    cells = xr.Dataset(
        {"q_value": (dims, value), "p_value": (dims, value)},
        {"joint": [1, 2], "phase": ["holding"], "window": [0.0, 0.1]},
    )
    monkeypatch.setattr(conclude_module, "locate_within", lambda *_: cells)
    monkeypatch.setattr(conclude_module, "list_trial_covariates", lambda _: {"trial_number": 0})


NOTHING = SimpleNamespace(gain=0.0, trials=[], joints=[])


@pytest.mark.parametrize(("q_value", "times"), [(0.04, (0.1, 0.3)), (0.06, None)])
def test_a_misfit_is_located_where_false_discoveries_are_few(monkeypatch, q_value, times):
    locate(monkeypatch, q_value)
    findings = SimpleNamespace(excess=0.5, p_value=0.01, slips=NOTHING, free=None, left=0.0)
    for specimen, word in ((False, "joint 2, holding"), (True, "holding")):
        whose = SimpleNamespace(setting=SimpleNamespace(specimen=specimen))
        where = describe_remaining(whose, None, findings).where
        assert where.startswith(word if times else "nowhere")
    problem = SimpleNamespace(setting=SimpleNamespace(duration=30.0))
    assert locate_misfit(problem, None, findings).times_s == times


@pytest.mark.parametrize("between", [False, True])
def test_a_joint_that_slips_has_the_p_value_that_its_evidence_bounds(monkeypatch, between):
    locate(monkeypatch, 0.5)
    shown = SimpleNamespace(gain=9.0, trials=["t"], joints=[1], argument="trial_number")
    slips, free = (NOTHING, shown) if between else (shown, None)
    findings = SimpleNamespace(slips=slips, free=free, left=9.0)
    problem = SimpleNamespace(setting=SimpleNamespace(duration=30.0))
    found = locate_misfit(problem, None, findings)
    assert found.level == ("between_trials" if between else "measurement")
    assert found.joints["1"] == pytest.approx(np.exp(-9.0))
    assert found.joints["2"] == 1.0


def test_of_what_is_unlisted_likely_parts_are_stated():
    effects = [SimpleNamespace(probability=p) for p in (0.45, 0.55)]
    assert [effect.probability for effect in keep_likely(effects)] == [0.55]


def test_no_protocol_is_proposed_that_shows_too_little(clean, draw_campaign, monkeypatch):
    hidden = clean.verdict.model_copy(update={"not_testable": ["yield_threshold"]})
    told = draw_campaign(2, 0.0).assign(load_kind=("trial", np.full(7, "torque_nm")))
    step = Choice("step", PlannedProtocol(np.array([[0.0, 5.0]]), np.full((1, 2), 0.02)), 1.0)
    for gain in (14.0, 16.0):
        expected = {"step": Expected(1.0, np.full((2, 2), gain), 0.5, 0.5)}

        def plan(_, question, limits, *__, found=expected, **___):
            return NextExperiment(question, limits, step, found, 1.0, {})

        monkeypatch.setattr(proposal, "plan_next", plan)
        found = proposal.propose_experiment(clean._replace(verdict=hidden), told)
        assert (found is None) == (gain < 15.0)


def test_an_experiment_is_of_a_dozen_trials(posed):
    problem, base, _ = posed
    protocol = PlannedProtocol(np.array([[0.0, 5.0]]), np.array([[0.02, 0.02]]))
    assert len(build_design(problem, base, protocol)[0].trials.name) == 12


def test_cells_of_few_numbers_are_not_judged(posed):
    cells = locate_within(*posed[:2])
    count = cells["count"].values
    assert cells["window"].values.tolist() == [0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0]
    assert ((count > 0) & (count < 8)).any()
    np.testing.assert_array_equal(np.isfinite(cells["p_value"].values), count >= 8)


def test_phases_follow_the_load():
    time = np.arange(0.0, 10.0, 0.5)
    knots = np.array([0.0, 2.0, 4.0, 6.0, 6.0, 10.0])
    load = np.array([0.0, 1.0, 1.0, 1.1, 0.04, 0.04])  # a pull, a hold, a slow drift, a rest
    trials = SimpleNamespace(
        node=np.stack([time, time], axis=-1)[None],
        bins=[time.size],
        load_time=knots[None],
        load_torque=load[None],
    )
    phase = label_phase(SimpleNamespace(trials=trials), 0)
    assert set(phase[1:4]) == {1}
    assert set(phase[5:8]) == {2}
    assert set(phase[14:]) == {0}


@pytest.mark.parametrize(("trials", "tested"), [(5, False), (6, True)])
def test_a_covariate_of_few_trials_is_not_tested(trials, tested):
    setting = SimpleNamespace(
        rest_time=np.full(trials, np.nan), number=np.arange(trials), covariates={}
    )
    loads = SimpleNamespace(load_torque=np.ones((trials, 2)))
    found = list_trial_covariates(SimpleNamespace(setting=setting, trials=loads))
    assert ("trial_number" in found) == tested


def test_a_spline_needs_values_to_go_through(posed):
    """Seven trials have seven numbers, and three loads."""
    problem, base, _ = posed
    known = list_trial_covariates(problem)
    arguments = {term.argument for term in list_terms(problem, base)}
    assert {"trial_number", "largest_load"} <= set(known)
    assert "trial_number" in arguments
    assert "largest_load" not in arguments


def test_short_trials_are_not_searched_for_slips_or_waves(posed, monkeypatch):
    problem, base, angles = posed
    for quiet, found in ((9, False), (10, True)):
        mask = np.isin(np.arange(200), 20 + np.arange(quiet))
        monkeypatch.setattr(slips_module, "find_quiet_array", lambda t, *_, m=mask: m[: len(t)])
        assert np.any(find_slips(problem, base, angles).gain != 0.0) == found
    rng = np.random.default_rng(1)
    for frames, found in ((23, False), (24, True)):
        residual, time = rng.normal(size=(3, 1, frames)), np.tile(np.arange(frames), (3, 1)) * 0.08
        assert (abs(find_line(problem, residual, time).gain) > 1e-9) == found


def test_a_slow_wave_is_drift(posed):
    problem = posed[0]
    time = np.tile(np.arange(160) * 0.08, (7, 1))
    noise = np.random.default_rng(1).normal(size=(7, 1, 160)) * 0.3
    gains = []
    for periods in (1.5, 4.0):
        wave = np.sin(2 * np.pi * periods / problem.setting.duration * time)
        gains.append(find_line(problem, noise + wave[:, None], time).gain)
    assert gains[0] < 10.0 < gains[1]


@pytest.mark.parametrize(("difference", "levels"), [(0.04, 0), (0.06, 2)])
def test_loads_that_differ_little_are_of_one_level(difference, levels):
    load = np.repeat([[1.0], [1.0 - difference]], 3, axis=0)
    problem = SimpleNamespace(trials=SimpleNamespace(load_torque=load))
    assert len(list_levels(problem)) == levels


def test_bands_are_of_a_half_and_of_nine_tenths():
    rank = np.array([[[0.5, 0.2, 0.96, 0.1]]])
    assert share_inside(rank).tolist() == [[[0.25, 0.75]]]


def test_a_disturbance_costs_its_prior(posed, monkeypatch):
    problem, base, _ = posed
    plain = judge_module.judge(problem, base, problem, base)
    monkeypatch.setattr(
        judge_module, "fit_disturbances", lambda *_: ({"drift": 0.1}, {"drift": 9.0}, {})
    )
    monkeypatch.setattr(judge_module, "admit_disturbances", lambda known, *_: known)
    monkeypatch.setattr(judge_module, "fit_again", lambda *_: base)
    judged = judge_module.judge(problem, base, None, base)
    assert plain.evidence - judged.evidence == pytest.approx(3.0)


def test_noise_of_another_size_is_no_excess_and_what_lasts_is(posed):
    problem, base, _ = posed
    excess, p_value = compute_excess(problem, base)
    assert abs(excess) < 0.1
    assert p_value > 0.001
    angle = problem.trials.angle
    fitted = problem.simulate(base.model, base.fit.own, base.fit.shared, np.zeros(0, int))[0]
    mean = fitted.reshape(*fitted.shape[:2], -1, 2).mean(axis=3).transpose(0, 2, 1)
    louder = problem.trials._replace(angle=mean + 3.0 * (angle - mean))
    same = compute_excess(replace(problem, trials=louder), base)
    assert same[0] == pytest.approx(excess, rel=1e-6)
    assert same[1] == pytest.approx(p_value, rel=0.2)
    wave = 0.02 * np.sin(np.arange(angle.shape[1]) / 5.0)[:, None]
    lasting = problem.trials._replace(angle=angle + wave)
    excess, p_value = compute_excess(replace(problem, trials=lasting), base)
    assert excess > 0.3
    assert p_value < 1e-6
    quiet = problem.trials._replace(angle=mean + 0.01 * (lasting.angle - mean))
    small, p_value = compute_excess(replace(problem, trials=quiet), base)
    assert small == pytest.approx(excess, rel=0.1)
    assert p_value > 0.1  # what lasts lies below the noise
