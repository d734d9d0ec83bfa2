"""Finalists are judged in turn, the base model first."""

from types import SimpleNamespace

import numpy as np
import pytest

from softfinger.inference.problem import Candidate
from softfinger.mismatch.search import judge as module
from softfinger.mismatch.search.demand import Demand, choose_simplest
from softfinger.mismatch.search.finalists import list_best, list_finalists
from softfinger.mismatch.search.judge import Judged, judge_finalists
from softfinger.mismatch.search.patience import Patience
from softfinger.mismatch.search.stepwise import Search


def stand_in(evidence, *ids, form="textbook"):
    pieces = [SimpleNamespace(label=f"{name}/{form}") for name in ids]
    return Candidate(SimpleNamespace(ids=frozenset(ids), pieces=pieces), object(), evidence)


def pose(disturbed=()):
    return SimpleNamespace(disturbed=dict(disturbed))


BASE, BEST, THIRD = stand_in(0.0), stand_in(500.0, "gravity"), stand_in(90.0, "inertia")
DEMAND = Demand(5.0, 8.0)


def quiet(items, _):
    return items


SEARCH = Search(BASE, [BEST, THIRD], [], BEST, 500.0, {}, [])


def test_the_base_model_is_never_given_up_and_no_other_goes_on_far_behind(monkeypatch):
    asked = {}

    def judge(problem, candidate, _fitted, _base, worth):
        asked[candidate.model.ids] = worth
        return Judged(problem, candidate, candidate.log_evidence)

    plain = object()
    monkeypatch.setattr(module, "judge", judge)
    monkeypatch.setattr(module, "measure_again", lambda problem, *_: problem)
    rival = stand_in(300.0, "wire_friction")
    judge_finalists(plain, plain, SEARCH, [rival], None, DEMAND, [], quiet)
    assert list(asked) == [BASE.model.ids, BEST.model.ids, rival.model.ids, THIRD.model.ids]
    assert asked[BASE.model.ids] == -np.inf
    assert asked[BEST.model.ids] == -20.0  # behind the base model, the best so far
    assert asked[THIRD.model.ids] == 250.0  # behind the best by half of its gain


@pytest.mark.parametrize(("gain", "leads"), [(4.0, "base"), (6.0, "effect")])
def test_the_measurement_is_that_of_the_model_that_leads(monkeypatch, gain, leads):
    """A noisy log was forgotten, for an effect without it had 0.4 nats more."""
    problems = {"base": pose(), "effect": pose()}

    def judge(_problem, candidate, _fitted, _base, _worth):
        own = problems["effect" if candidate.model.ids else "base"]
        return Judged(own, candidate, gain if candidate.model.ids else 0.0)

    monkeypatch.setattr(module, "judge", judge)
    monkeypatch.setattr(module, "measure_again", lambda problem, *_: problem)
    no_better = {"log_evidence": -9.0}  # with the measurement of the other
    monkeypatch.setattr(module, "fit_again", lambda _problem, c, _base: c._replace(**no_better))
    found = Search(BASE, [BEST], [], BEST, 500.0, {}, [])
    problem, search = judge_finalists(
        problems["effect"], problems["effect"], found, [], None, DEMAND, [], quiet
    )
    assert problem is problems[leads]
    assert search.best.model.ids == (BEST if leads == "effect" else BASE).model.ids


@pytest.mark.parametrize(
    ("disturbed", "leads", "gained"),
    [({"drift": 1.0}, "base", 2.0), ({"gravity:tilt_rad": 0.3}, "effect", 10.0)],
)
def test_a_model_is_at_its_best_with_the_measurement_of_another(
    monkeypatch, disturbed, leads, gained
):
    """A base model whose own measurement was not the best lost to an effect by 10 nats.

    That an effect's parameter differs between trials is no measurement for a model without it.
    """
    problems = {"base": pose(), "effect": pose(disturbed)}

    def judge(_problem, candidate, _fitted, _base, _worth):
        own = problems["effect" if candidate.model.ids else "base"]
        gain = 10.0 if candidate.model.ids else 0.0
        return Judged(own, candidate._replace(log_evidence=gain), gain)

    monkeypatch.setattr(module, "judge", judge)
    monkeypatch.setattr(module, "measure_again", lambda problem, *_: problem)
    monkeypatch.setattr(
        module, "fit_again", lambda _problem, candidate, _base: candidate._replace(log_evidence=8.0)
    )
    found = Search(BASE, [BEST], [], BEST, 10.0, {}, [])
    problem, search = judge_finalists(
        problems["base"], problems["base"], found, [], None, DEMAND, [], quiet
    )
    assert problem is problems["effect"]
    assert (search.best is search.base) is (leads == "base")
    gain = search.candidates[0].log_evidence - search.base.log_evidence
    assert gain == pytest.approx(gained)


def test_a_further_effect_is_held_against_finer_laws_with_the_measurement_of_its_own(monkeypatch):
    """A moment arm beside a stop gained 37 nats of what a finer law of the stop gains."""
    single, pair = stand_in(80.0, "contact_stop"), stand_in(100.0, "contact_stop", "moment_arm")
    own, asked = pose({"drift": 1.0}), []

    def fit_finer(problem, top, found, pieces, _progress):
        asked.append((problem, top.model.ids, {c.model.ids for c in found}, pieces))
        return [stand_in(95.0, "contact_stop", form="free_finer")]

    monkeypatch.setattr(module, "judge", lambda _, c, *__: Judged(own, c, c.log_evidence))
    monkeypatch.setattr(module, "measure_again", lambda problem, *_: problem)
    monkeypatch.setattr(module, "fit_finer", fit_finer)
    plain, found = pose(), Search(BASE, [pair, single], [], pair, 80.0, {}, [])
    problem, search = judge_finalists(plain, plain, found, [], None, DEMAND, ["catalogue"], quiet)
    assert problem is own
    assert asked == [(own, pair.model.ids, {pair.model.ids, single.model.ids}, ["catalogue"])]
    assert search.best.model.pieces[0].label == "contact_stop/free_finer"


def test_the_best_sets_of_a_search_are_beside_its_base():
    assert list_best(SEARCH) == [BEST, THIRD]
    other = stand_in(480.0, "gravity", form="free")
    assert list_best(SEARCH._replace(candidates=[BEST, other, THIRD])) == [BEST, THIRD]
    assert list_best(SEARCH._replace(best=BASE, candidates=[])) == []


def test_a_set_is_held_against_the_best_form_of_what_it_adds_to():
    """A third effect gained 14 nats beside a pair's first form, and 8 beside its best."""
    triple = stand_in(519.0, "gravity", "inertia", "load_limit")
    pair = stand_in(511.0, "gravity", "inertia", form="finer")
    behind = stand_in(505.0, "gravity", "inertia")
    others = [stand_in(510.0 + k, "gravity", "inertia", name) for k, name in enumerate("ab")]
    search = SEARCH._replace(best=triple, candidates=[triple, *others, pair, behind, BEST])
    assert list_best(search) == [triple, *others, pair]


@pytest.mark.parametrize(("gain", "claimed"), [(7.9, False), (8.1, True)])
def test_of_a_further_effect_more_is_demanded(gain, claimed):
    base, one = stand_in(0.0), stand_in(100.0, "gravity")
    pair = stand_in(100.0 + gain, "gravity", "inertia")
    best = choose_simplest([base, one, pair], base.model.ids, DEMAND)
    assert best is (pair if claimed else one)
    other = stand_in(100.0 + gain, "load_limit", "inertia")
    assert choose_simplest([base, one, other], base.model.ids, DEMAND) is (
        other if claimed else one
    )
    first = stand_in(gain - 2.9, "gravity")
    assert choose_simplest([base, first], base.model.ids, DEMAND) is (first if claimed else base)


@pytest.mark.parametrize(("gain", "claimed"), [(47.0, False), (49.0, True)])
def test_a_third_effect_gains_more_than_a_textbook_form_may_err(gain, claimed):
    base, pair = stand_in(0.0), stand_in(8000.0, "actuator_lag", "gravity")
    third = stand_in(8000.0 + gain, "actuator_lag", "gravity", "camera_delay")
    asked = DEMAND._replace(free=frozenset({"gravity"}))
    best = choose_simplest([base, pair, third], base.model.ids, asked)
    assert best is (third if claimed else pair)


def test_effects_are_taken_back_one_by_one():
    base, one, pair = stand_in(0.0), stand_in(4.0, "gravity"), stand_in(11.0, "gravity", "inertia")
    assert choose_simplest([pair, base, one], base.model.ids, DEMAND) is base
    assert choose_simplest([pair, base], base.model.ids, DEMAND) is pair


def test_a_rival_of_another_form_competes_and_the_same_pieces_do_once():
    """A free law that led without a disturbance was not judged: another form had its set."""
    free = stand_in(300.0, "gravity", form="free")
    pair, turned = stand_in(510.0, "gravity", "inertia"), stand_in(505.0, "inertia", "gravity")
    found = list_finalists(SEARCH._replace(candidates=[pair, BEST, THIRD]), [free, turned])
    assert found == [BASE, pair, BEST, THIRD, free]


def test_of_sets_of_more_effects_than_are_named_the_best_alone_is_a_finalist():
    """Three triples were judged, and none could have been named."""
    names = ("gravity", "inertia", "load_limit", "fatigue_softening")
    first, second = stand_in(600.0, *names[:3]), stand_in(590.0, *names[:2], names[3])
    leading = stand_in(610.0, *names[1:])
    search = SEARCH._replace(best=leading, candidates=[leading, first, second, BEST])
    assert list_finalists(search, []) == [BASE, BEST, leading]
    assert list_finalists(search, [first, second, THIRD]) == [BASE, BEST, leading, first, THIRD]


def test_once_the_time_is_over_base_and_best_are_still_judged(monkeypatch):
    asked = []

    def judge(problem, candidate, *_):
        asked.append(candidate)
        return Judged(problem, candidate, candidate.log_evidence)

    plain, hurried = pose(), Patience(0.0, quiet)
    monkeypatch.setattr(module, "judge", judge)
    monkeypatch.setattr(module, "measure_again", lambda problem, *_: problem)
    _, search = judge_finalists(plain, plain, SEARCH, [], None, DEMAND, [], hurried)
    assert asked == [BASE, BEST]
    assert hurried.was_lost
    assert search.best is BEST
