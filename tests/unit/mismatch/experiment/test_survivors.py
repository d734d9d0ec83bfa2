"""Which models a verdict leaves open."""

from types import SimpleNamespace

import pytest

from softfinger.mismatch.experiment import survivors
from softfinger.mismatch.experiment.survivors import list_survivors

BASE, HEAVY, SLOW = frozenset(), frozenset({"gravity"}), frozenset({"actuator_lag"})


@pytest.fixture
def leave(monkeypatch):
    """Survivors of sets of effects, each with its probability, and whether it was fitted."""
    monkeypatch.setattr(survivors, "measure_uncertainty", lambda *_: None)

    def leave(sets, fitted, equivalent):
        best = {ids: SimpleNamespace(fit=1 if ids in fitted else None) for ids in sets}
        posterior = SimpleNamespace(sets=sets, best=best, equivalent=equivalent)
        return [(one.label, one.probability) for one in list_survivors(None, posterior)]

    return leave


def test_models_that_were_not_fitted_leave_their_probability_to_the_others(leave):
    sets = {HEAVY: 0.6, SLOW: 0.3, BASE: 0.1}
    assert leave(sets, {SLOW, BASE}, [HEAVY, SLOW, BASE]) == [
        ("actuator_lag", pytest.approx(0.75)),
        ("none", pytest.approx(0.25)),
    ]


def test_where_no_likely_model_was_fitted_the_next_that_was_is_left(leave):
    sets = {HEAVY: 1.0, SLOW: 0.0, BASE: 0.0}
    assert leave(sets, {SLOW, BASE}, [HEAVY]) == [("actuator_lag", 1.0)]
    assert leave(sets, {BASE}, [HEAVY]) == [("none", 1.0)]
