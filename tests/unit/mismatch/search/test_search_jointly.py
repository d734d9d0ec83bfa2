"""The search with the measurement that leads, and the one without disturbances."""

from types import SimpleNamespace

import pytest

from softfinger.mismatch.diagnose import search_jointly
from softfinger.mismatch.posed import Posed


class Searched:
    """A survey that keeps what each search is worth."""

    needed, demand = 5.0, None
    ranked = ([], [])
    catalogue = ([], {})

    def __init__(self, best):
        self.best, self.worth = SimpleNamespace(log_evidence=best), []

    def join_leaders(self, _problem, _base, leaders):
        self.leaders = leaders
        return self

    def search(self, _problem, base, _patience, worth=0.0):
        self.worth.append(worth)
        return SimpleNamespace(best=self.best, base=base)


@pytest.mark.parametrize(("needed", "searches"), [(True, [45.0]), (False, [])])
def test_without_disturbances_is_sought_what_comes_near_where_one_is_needed(
    monkeypatch, needed, searches
):
    plain, problem, base = object(), object(), SimpleNamespace(log_evidence=-100.0)
    bare, softer = Searched(-20.0), Searched(-30.0)
    for name, answer in {
        "list_leaders": lambda *_: ["leader"],
        "settle_measurement": lambda *_: (problem, base),
        "needs_disturbance": lambda at, best: needed and at is plain and best is softer.best,
        "compare_levels": lambda *_: -5.0,  # what the disturbance costs
        "list_best": lambda search: [search.best],
        "judge_finalists": lambda *given: (given[1], given[2:4]),
    }.items():
        monkeypatch.setitem(search_jointly.__globals__, name, answer)
    posed = Posed(None, plain, base, bare, {}, None)
    _, found, (search, rivals) = search_jointly(posed, lambda *_: softer, None)
    assert found is softer
    assert softer.leaders == ["leader"]
    assert search.best is softer.best
    assert bare.worth == searches
    assert rivals == ([bare.best] if needed else [])
    assert softer.worth == [0.0]
