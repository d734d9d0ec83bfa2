"""Parameters of effects that differ from trial to trial: found by evidence, and stated."""

from dataclasses import replace

import numpy as np
import pytest

from softfinger.inference.disturbance_sizes import fit_disturbances
from softfinger.inference.disturbed import (
    admit_disturbances,
    admit_known,
    forget_spreads,
    spread_disturbances,
)
from softfinger.inference.problem import Candidate, pose_problem
from softfinger.inference.simulate import build_recording, describe_noise, draw_noise_array
from softfinger.inference.spreads import is_spread, list_spreads
from softfinger.measurement.measure import add_components
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.model import EffectModel, Piece
from softfinger.mechanics.forward.simulate import (
    describe_unknown_finger,
    simulate_joint_angle_array,
)
from softfinger.mechanics.forward.slots import build_slots
from softfinger.mismatch.verdict.estimates import find_spread
from softfinger.mismatch.verdict.sufferings import describe_measurement

TRIALS, NAME = 16, "strain_stiffening:stiffening_per_rad2"
TIME = np.arange(400) / 25
LINK = ("length", "mass", "centre", "inertia")


@pytest.fixture(scope="module")
def pose():
    """Pose a campaign whose stiffening differs between trials, with its own model fitted."""

    def make(spread):
        rng = np.random.default_rng(5)
        edges = np.repeat(np.arange(5) * 4.0, 2)[1:-1]
        load = np.tile(np.repeat([0.02, 0.06, 0.01, 0.05], 2), (TRIALS, 1))
        names = [f"t{i}" for i in range(TRIALS)]
        recording = build_recording(TIME, np.tile(edges, (TRIALS, 1)), load, 1, names)
        mean, sd = np.array([-2.4, -3.6, 2.9, 0.02]), np.array([0.2, 0.4, 0.7, 0.01])
        own = (mean + sd * rng.standard_normal((TRIALS, 4)))[:, None]
        stiffening = np.exp(spread * rng.standard_normal((TRIALS, 1)))
        motion, _ = simulate_joint_angle_array(
            own,
            build_slots(TRIALS, 1, {"stiffening_square": stiffening}),
            [],
            describe_unknown_finger(1),
            np.tile(TIME, (TRIALS, 1)),
            np.tile(edges, (TRIALS, 1)),
            load,
        )
        noise = describe_noise(np.full(1, 0.002), np.zeros(1), 0.0)
        motion = motion + draw_noise_array(TIME * 25, noise, TRIALS, rng)
        unknown = {
            f"link_{k}": ("joint", [np.nan]) for k in ("length", "mass", "centre", "inertia")
        }
        angles = recording.assign(
            joint_angle=(("trial", "joint", "frame"), motion),
            started_at=("trial", np.full(TRIALS, np.nan)),
            joint_length=np.nan,
            wire_offset=np.nan,
            **unknown,
        )
        problem, fit = pose_problem(angles)
        effect = list_effects()["strain_stiffening"]
        form = effect.list_forms(problem.setting)[0]
        model = problem.base.extend(Piece(effect, form, ((0,),)))
        fitted = problem.fit(model, (fit.own, np.array([0.5]), fit.omega))
        return problem, Candidate(model, fitted, fitted.log_evidence)

    return make


@pytest.fixture(scope="module")
def scattered(pose):
    return pose(0.3)


def test_a_parameter_that_differs_between_trials_is_found_with_its_spread(scattered):
    size, evidence, _ = fit_disturbances(*scattered)
    assert list(size) == [NAME]
    assert size[NAME] == pytest.approx(0.3, rel=0.35)
    assert evidence[NAME] > 30


def test_a_parameter_that_is_the_same_in_all_trials_has_no_spread(pose):
    assert fit_disturbances(*pose(0.0))[0] == {}


def test_a_spread_is_that_of_the_effect_and_not_of_the_measurement(scattered):
    problem, candidate = scattered
    noise = add_components(problem.noise, {NAME: 0.3}, {NAME: 40.0})
    assert find_spread(noise, candidate, 0) == {"stiffening_per_rad2": 0.3}
    assert NAME not in [one.id for one in describe_measurement(noise)]
    assert is_spread(NAME)


def test_a_fit_with_a_model_file_has_the_spread_of_its_effect(scattered):
    problem, candidate = scattered
    repaired = replace(problem, repaired=candidate.model)
    softer, fit = admit_known(repaired, candidate.fit, {NAME: 0.3})
    assert softer.disturbed == {NAME: 0.3}
    assert fit.log_evidence > candidate.fit.log_evidence + 30.0
    moved = spread_disturbances(softer, np.arange(2), np.tile(TIME[::40], (2, 1)))
    assert moved.shape == (2, 1, 10, 1)
    assert np.abs(moved).max() > 0.01


def test_one_trial_has_no_spread_and_a_law_between_trials_has_none(scattered):
    problem, candidate = scattered
    fit = candidate.fit
    slope = problem.simulate(candidate.model, fit.own, fit.shared)[1]
    assert list(list_spreads(candidate, slope)) == [NAME]
    assert list_spreads(candidate, slope[:1]) == {}
    piece = candidate.model.pieces[0]
    between = replace(piece, effect=replace(piece.effect, level="between_trials"))
    model = EffectModel(candidate.model.setting, (between,))
    assert list_spreads(candidate._replace(model=model), slope) == {}


@pytest.mark.parametrize("drift", [{}, {"drift": 1.0}])
def test_a_model_without_the_effect_does_not_suffer_from_its_spread(scattered, drift):
    problem, candidate = scattered
    _, _, directions = fit_disturbances(problem, candidate)
    size = drift | {NAME: 0.3}
    noise = add_components(problem.noise, size, dict.fromkeys(size, 40.0))
    softer = replace(admit_disturbances(problem, size, directions), noise=noise)
    left = forget_spreads(problem, softer, candidate)
    assert left.disturbed == drift
    alone = admit_disturbances(problem, drift, directions) if drift else problem
    np.testing.assert_allclose(left.trials.logdet, alone.trials.logdet)
    assert NAME not in left.noise["component"].values
    assert forget_spreads(problem, left, candidate) is left
