"""A softening that rises again is none."""

from types import SimpleNamespace

import numpy as np
import pytest

from softfinger.inference.problem import Candidate
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.demonstration import describe_finger_of_the_paper
from softfinger.mechanics.effects.law import build_terms
from softfinger.mechanics.effects.model import EffectModel, Piece
from softfinger.mechanics.forward.curve import build_weights
from softfinger.mismatch.checks.turned import list_turned, turns_back

SETTING = describe_finger_of_the_paper()
X = np.linspace(0.0, 1.0, 60)


def fit_course(course, sd):
    """A candidate whose free law of joint 1 has a course, each term known to sd."""
    effect = list_effects()["softening_within_trial"]
    form = next(f for f in effect.list_forms(SETTING) if f.name == "free_viscosities")
    model = EffectModel(SETTING, (Piece(effect, form, ((0,), (1,), (2,))),))
    curves = build_weights(X) @ build_terms(form.law.terms).T
    terms = np.linalg.lstsq(curves, course(X), rcond=None)[0]
    shared = np.zeros(len(model.entries))
    for k, entry in enumerate(model.entries):
        if entry.parameter.term and entry.place == (0,):
            shared[k] = terms[int(entry.parameter.name.rsplit("_", 1)[1]) - 1]
        elif not entry.parameter.term:
            shared[k] = entry.parameter.mean if entry.parameter.log else 0.0
    covariance = sd**2 * np.eye(len(shared))
    return Candidate(model, SimpleNamespace(shared=shared, shared_covariance=covariance), 0.0)


def judge(course, sd=1e-3, known=frozenset()):
    problem = SimpleNamespace(setting=SETTING, base=SimpleNamespace(ids=known))
    return list_turned(problem, fit_course(course, sd))


def fall(x):
    return -0.5 * x**2


def turn(x):
    return -0.4 * np.sin(np.pi * x)


def test_a_course_that_falls_is_a_softening():
    assert judge(fall) == []


def test_a_course_that_comes_back_is_none():
    assert judge(turn) == ["softening_within_trial"]


def test_a_course_that_is_hardly_known_may_be_one():
    assert judge(turn, sd=0.3) == []


def test_what_the_user_has_put_into_the_base_is_not_judged():
    assert judge(turn, known=frozenset({"softening_within_trial"})) == []


@pytest.mark.parametrize(("back", "turned"), [(0.45, False), (0.55, True)])
def test_half_of_a_fall_may_come_back(back, turned):
    course = np.array([[0.0, -0.3, -1.0, -1.0 + back]])
    assert turns_back(course, np.zeros((1, 4, 4))) is turned


def test_any_joint_may_turn_back():
    course = np.array([[0.0, -0.5, -1.0], [0.0, -0.5, 0.0]])
    assert turns_back(course, np.zeros((2, 3, 3)))
