"""What sets of effects explain of the evidence that is missing."""

from types import SimpleNamespace

import numpy as np
import pytest

from softfinger.mismatch.verdict import explained
from softfinger.mismatch.verdict.explained import covers_zero, list_explained, list_not_tried


def build(*ids, nats, left=0.0, covers=False):
    fit = SimpleNamespace(
        shared=np.array([1.0]), shared_covariance=np.eye(1) * (1.0 if covers else 0.01)
    )
    model = SimpleNamespace(ids=frozenset(ids), amplitudes=np.array([True]))
    return SimpleNamespace(model=model, fit=fit, log_evidence=nats, left=left)


def weigh(monkeypatch, base, best, *others):
    monkeypatch.setattr(explained, "measure_left", lambda _, candidate: candidate.left)
    search = SimpleNamespace(base=base, best=best)
    sets = {c.model.ids: c for c in (base, best, *others)}
    return list_explained(None, search, SimpleNamespace(best=sets), 5.0)


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


def test_an_amplitude_that_is_not_clearly_off_zero_is_told():
    assert covers_zero(build("gravity", nats=9.0, covers=True))
    assert not covers_zero(build("gravity", nats=9.0))


def test_what_was_not_tried_has_its_reason():
    (one,) = list_not_tried({"lens_distortion": "no camera is declared"})
    assert (one.id, one.reason) == ("lens_distortion", "no camera is declared")
