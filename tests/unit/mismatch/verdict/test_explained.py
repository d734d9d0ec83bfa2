"""What sets of effects explain of the evidence that is missing."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.measurement.trials import prepare_trials
from softfinger.mismatch.candidates.columns import collect_columns
from softfinger.mismatch.candidates.rank import list_pieces, rank_pieces
from softfinger.mismatch.verdict import explained
from softfinger.mismatch.verdict.explained import (
    covers_zero,
    list_explained,
    list_not_tried,
    measure_left,
)


def build(*ids, nats, left=0.0, covers=False):
    fit = SimpleNamespace(
        shared=np.array([1.0]), shared_covariance=np.eye(1) * (1.0 if covers else 0.01)
    )
    model = SimpleNamespace(ids=frozenset(ids), amplitudes=np.array([True]), pieces=())
    return SimpleNamespace(model=model, fit=fit, log_evidence=nats, left=left)


def weigh(monkeypatch, base, best, *others, beyond=()):
    monkeypatch.setattr(explained, "measure_left", lambda _, candidate: candidate.left)
    search = SimpleNamespace(base=base, best=best, beyond=beyond)
    sets = {c.model.ids: c for c in (base, best, *others)}
    problem = SimpleNamespace(setting=SimpleNamespace(duration=8.0))
    return list_explained(problem, search, SimpleNamespace(best=sets), 5.0)


def test_the_best_set_of_the_search_comes_first(monkeypatch):
    best = build("contact_stop", nats=568.0, left=1055.0)
    others = [build(f"effect_{k}", nats=600.0 - k) for k in range(7)]
    faint = build("gravity", nats=4.0)
    found = weigh(monkeypatch, build(nats=0.0), best, *others, faint)
    assert [one.effects for one in found[:2]] == [["contact_stop"], ["effect_0"]]
    assert len(found) == 5
    assert found[0].gain_nats == 568.0
    assert found[0].share == pytest.approx(0.35, abs=1e-3)


def test_a_set_that_gains_no_more_than_chance_is_not_listed(monkeypatch):
    base = build(nats=0.0)
    assert weigh(monkeypatch, base, base, build("gravity", nats=4.0)) == []


def test_an_effect_that_is_none_as_it_turns_back_is_marked(monkeypatch):
    monkeypatch.setattr(explained, "list_turned", lambda _, c: sorted(c.model.ids - {"gravity"}))
    best, other = build("softening_within_trial", nats=568.0), build("gravity", nats=560.0)
    found = weigh(monkeypatch, build(nats=0.0), best, other)
    assert [one.turned_back for one in found] == [["softening_within_trial"], []]


def test_what_further_effects_make_of_the_best_set_comes_first(monkeypatch):
    best, other = build("contact_stop", nats=568.0), build("gravity", nats=560.0)
    larger = build("contact_stop", "inertia", nats=575.0)
    found = weigh(monkeypatch, build(nats=0.0), best, other, beyond=[larger])
    assert [one.effects for one in found] == [
        ["contact_stop", "inertia"], ["contact_stop"], ["gravity"],
    ]  # fmt: skip


def test_an_amplitude_that_is_not_clearly_off_zero_is_told():
    assert covers_zero(build("gravity", nats=9.0, covers=True))
    assert not covers_zero(build("gravity", nats=9.0))


def test_what_was_not_tried_has_its_reason():
    (one,) = list_not_tried({"lens_distortion": "no camera is declared"})
    assert (one.id, one.reason) == ("lens_distortion", "no camera is declared")


def test_noise_of_another_size_leaves_the_share_as_it_is(draw_campaign):
    angles = draw_campaign(1, 0.15)
    problem, fit = pose_problem(angles)

    def share(noise_scale):
        noise = problem.noise.assign(noise_sd=noise_scale * problem.noise["noise_sd"])
        other = replace(problem, noise=noise, trials=prepare_trials(angles, noise))
        again = other.fit(other.base, (fit.own, fit.shared, fit.omega))
        base = Candidate(other.base, again, again.log_evidence)
        pieces = [p for p in list_pieces(other.setting)[0] if p.effect.id == "inertia"]
        columns = collect_columns(other, base, pieces)
        best = rank_pieces(other, base, columns, lambda items, _: items)[0][0]
        left = measure_left(other, base)
        return left / (left + max(best.log_evidence - base.log_evidence, 0.0)), left

    (once, left), (twice, less) = share(1.0), share(2.0)
    assert left > 100.0
    assert less == pytest.approx(left / 4.0, rel=0.1)
    assert twice == pytest.approx(once, abs=0.02)
