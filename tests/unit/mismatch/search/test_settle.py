from types import SimpleNamespace

import numpy as np
import pytest

from softfinger.inference.problem import pose_problem
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.model import EffectModel, Piece
from softfinger.mismatch.candidates.rank import Candidate
from softfinger.mismatch.checks.findings import Findings
from softfinger.mismatch.search.calibrate import FalseAlarms
from softfinger.mismatch.search.settle import (
    drop_lent,
    drop_negligible,
    join_ids,
    settle_search,
    weigh_models,
)
from softfinger.mismatch.search.stepwise import Search


def model(*ids):
    return SimpleNamespace(ids=frozenset(ids))


def test_base_and_effects_share_the_prior_by_halves():
    base = Candidate(model(), None, 0.0)
    others = [Candidate(model("a"), None, 0.0), Candidate(model("b"), None, 0.0)]
    posterior = weigh_models(base, others)
    assert posterior.sets[frozenset()] == pytest.approx(0.5)
    assert posterior.inclusion == pytest.approx({"a": 0.25, "b": 0.25})


def test_forms_of_one_effect_share_what_it_has():
    base = Candidate(model(), None, 0.0)
    many = [Candidate(model("a"), None, 3.0) for _ in range(7)]
    one = [Candidate(model("b"), None, 3.0)]
    posterior = weigh_models(base, many + one)
    assert posterior.inclusion["a"] == pytest.approx(posterior.inclusion["b"])


def test_strong_evidence_names_one_set_and_close_evidence_does_not():
    base = Candidate(model(), None, 0.0)
    clear = [Candidate(model("a"), None, 30.0), Candidate(model("b"), None, 20.0)]
    posterior = weigh_models(base, clear)
    assert posterior.equivalent == [frozenset("a")]
    assert posterior.best[frozenset("a")].log_evidence == 30.0
    close = [Candidate(model("a"), None, 30.0), Candidate(model("b", "c"), None, 29.0)]
    posterior = weigh_models(base, close)
    assert [join_ids(ids) for ids in posterior.equivalent] == ["a", "b+c"]
    assert posterior.inclusion["b"] == posterior.inclusion["c"] < 0.5


def test_a_lead_within_the_error_of_shared_textbook_forms_is_none():
    base, shared = Candidate(model(), None, 0.0), Candidate(model("a"), None, 1000.0)
    sets = [shared, Candidate(model("a", "b"), None, 1100.0)]
    sets += [Candidate(model("a", "c"), None, 1096.0), Candidate(model("a", "d"), None, 1080.0)]
    named = weigh_models(base, sets, frozenset("abcd"))
    assert named.equivalent == [frozenset("ab")]
    close = weigh_models(base, sets, frozenset("bcd"))
    assert close.sets[frozenset("ab")] == pytest.approx(close.sets[frozenset("ac")])
    assert set(close.equivalent) == {frozenset("ab"), frozenset("ac")}


def test_threshold_and_p_value_of_chance_agree():
    gain = np.random.default_rng(4).exponential(2.0, 400)
    alarms = FalseAlarms(gain)
    threshold = alarms.threshold(0.01)
    assert threshold == pytest.approx(2.0 * np.log(100.0), rel=0.25)
    assert alarms.p_value(threshold) == pytest.approx(0.01, rel=1e-6)
    assert alarms.p_value(np.median(gain)) == pytest.approx(0.5, abs=0.01)


def search(*candidates):
    ordered = sorted(candidates, key=lambda c: -c.log_evidence)
    return Search(Candidate(model(), "fit", 0.0), ordered, [], ordered[0], 0.0, {}, [])


def test_what_close_sets_share_is_settled_where_they_add_hardly_anything():
    one, pairs = (
        Candidate(model("a"), "fit", 990.0),
        [Candidate(model("a", second), "fit", 1000.0) for second in "bcd"],
    )
    found = search(one, *pairs, Candidate(model("b"), "fit", 40.0))
    settled = settle_search(found)
    assert settled.best is one
    assert [c.model.ids for c in settled.candidates] == [frozenset("a"), frozenset("b")]
    assert settled.rejected == pairs
    posterior = weigh_models(settled.base, settled.candidates)
    assert posterior.sets[frozenset("a")] > 0.99


def test_a_slight_third_effect_takes_no_pair_its_name():
    """A lag of three stages is one of two and a slight delay."""
    pairs = [Candidate(model("a", "b"), "fit", 8560.0), Candidate(model("a", "c"), "fit", 6700.0)]
    for gain, best in ((40.0, "ab"), (200.0, "abc")):
        triple = Candidate(model("a", "b", "c"), "fit", 8560.0 + gain)
        settled = settle_search(search(triple, *pairs, Candidate(model("b"), "fit", 90.0)))
        assert settled.best.model.ids == frozenset(best)


def test_sets_stand_where_they_add_much_or_what_they_share_was_not_fitted():
    pairs = [Candidate(model("a", second), "fit", 1000.0) for second in "bc"]
    rival = Candidate(model("b"), "fit", 950.0)
    for one in (Candidate(model("a"), "fit", 900.0), Candidate(model("a"), None, 990.0)):
        found = search(one, rival, *pairs)
        assert settle_search(found) is found


def test_where_the_base_model_is_the_most_probable_it_stays():
    weak = [Candidate(model(name), "fit", 1.0) for name in "abcdef"]
    weak.append(Candidate(model("g"), "fit", 1.5))
    assert settle_search(search(*weak)).best.model.ids == frozenset()
    strong = search(*weak, Candidate(model("h"), "fit", 9.0))
    assert settle_search(strong).best.model.ids == frozenset("h")


def test_sets_without_a_shared_effect_and_a_sure_one_stand():
    for others in (
        [Candidate(model("a"), "fit", 50.0), Candidate(model("b"), "fit", 50.0)],
        [Candidate(model("a"), "fit", 50.0), Candidate(model("a", "b"), "fit", 80.0)],
    ):
        found = search(*others)
        assert settle_search(found) is found


@pytest.mark.parametrize(("play", "kept"), [(0.0, False), (0.02, True)])
def test_play_without_a_gap_is_a_stiffening_and_competes_as_that(draw_campaign, play, kept):
    setting = pose_problem(draw_campaign(2, 0.15))[0].setting
    free = next(f for f in list_effects()["joint_play"].list_forms(setting) if f.is_free)
    borrowed = EffectModel(setting, (Piece(list_effects()["joint_play"], free, ((0,),)),))
    shared = np.where(borrowed.terms, 0.3, play)
    fit = SimpleNamespace(shared=shared, shared_covariance=0.005**2 * np.eye(len(shared)))
    stiffer = Candidate(model("strain_stiffening"), "fit", 30.0)
    found = drop_lent(search(stiffer, Candidate(borrowed, fit, 29.0)))
    assert len(found.candidates) == 1 + kept
    assert found.candidates[0] is stiffer


def small(*ids, negligible, nats=30.0):
    """A fitted model some of whose effects lie below their floors."""
    content = SimpleNamespace(
        ids=frozenset(ids), list_negligible=lambda _: frozenset(negligible) & frozenset(ids)
    )
    return Candidate(content, SimpleNamespace(shared=None), nats)


def refuse(candidate, ids):
    """Nothing else can be fitted."""


def test_what_lies_below_its_floor_is_not_claimed_and_neither_are_its_rivals():
    found = search(small("a", negligible="a"), small("b", negligible="", nats=25.0))
    settled = drop_negligible(found, refuse)
    assert settled.best is found.base
    assert settled.candidates == []
    assert settled.rejected == found.candidates


def test_of_two_effects_the_one_above_its_floor_is_kept():
    one, other = small("a", negligible="", nats=90.0), small("b", negligible="b", nats=40.0)
    pair = small("a", "b", negligible="b", nats=100.0)
    settled = drop_negligible(search(one, other, pair), refuse)
    assert settled.best is one
    assert settled.candidates == [one, other]
    assert settled.rejected == [pair]
    assert drop_negligible(settled, refuse) is settled


def test_what_is_left_above_its_floor_is_fitted_where_the_search_had_not():
    """The set without the negligible effect was no candidate: it is known, not the base model."""
    three = small("a", "b", "c", negligible="c", nats=100.0)
    left = small("a", "b", negligible="", nats=95.0)
    asked = []

    def refit(candidate, ids):
        asked.append((candidate, ids))
        return left

    found = search(three, small("d", negligible="", nats=10.0))
    settled = drop_negligible(found, refit)
    assert asked == [(three, frozenset("c"))]
    assert settled.best is left
    assert settled.candidates[0] is left
    assert settled.rejected == [three]


@pytest.mark.parametrize(("floor", "best"), [("b", "c"), ("bc", "a")])
def test_where_an_effect_is_taken_back_the_most_probable_of_the_others_is_claimed(floor, best):
    """A set was named with probability 1e-10, for another of its size had more evidence."""
    one, other = small("a", negligible="", nats=60.0), small("c", negligible=floor, nats=80.0)
    pair = small("a", "b", negligible="b", nats=100.0)
    settled = drop_negligible(search(one, other, pair), refuse)
    assert settled.best.model.ids == frozenset(best)


@pytest.mark.parametrize(
    ("shape", "p", "unlisted"), [(45.0, 1.0, False), (55.0, 1.0, True), (0.0, 5e-4, True)]
)
def test_effects_that_leave_much_do_not_explain(shape, p, unlisted):
    quiet = SimpleNamespace(gain=-1.0)
    findings = Findings(
        excess=0.6,
        p_value=p,
        line=quiet,
        slips=quiet,
        free=SimpleNamespace(gain=shape),
        gain=1000.0,
    )
    assert findings.is_unlisted(7.0) is unlisted
