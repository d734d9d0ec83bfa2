"""What further effects explain, where none is named."""

from types import SimpleNamespace

import pytest

from softfinger.mismatch.candidates.rank import list_pieces
from softfinger.mismatch.search.beyond import go_beyond
from softfinger.mismatch.search.demand import Demand
from softfinger.mismatch.search.extend import Task


@pytest.fixture
def begin(named):
    """A search that ends with the base model, though a second retardation is there."""

    def quiet(items, _):
        return items

    problem, base = named.problem, named.search.base
    pieces, refused = list_pieces(problem.setting)
    pieces = [p for p in pieces if p.effect.id in ("second_retardation", "inertia")]
    task = Task(problem, base, pieces, refused, None, [], [], quiet)
    return task, named.search._replace(candidates=[], best=base)


def test_further_effects_are_explained_and_not_named(begin, named):
    task, search = begin
    found = go_beyond(task, search, Demand(10.0, 10.0))
    (larger,) = found.beyond
    assert larger.model.ids == {"second_retardation"}
    assert larger.log_evidence == pytest.approx(named.search.best.log_evidence, abs=1.0)
    assert found._replace(beyond=()) == search


def test_what_gains_less_than_is_asked_is_not_explained(begin, named):
    task, search = begin
    gain = named.search.best.log_evidence - search.base.log_evidence
    assert go_beyond(task, search, Demand(gain + 10.0, gain + 10.0)).beyond == ()


def test_a_measurement_of_its_own_counts_for_the_set_that_has_it(begin):
    task, search = begin
    ahead = search.base._replace(log_evidence=search.base.log_evidence + 1e4)
    assert go_beyond(task, search._replace(best=ahead), Demand(10.0, 10.0)).beyond == ()


def test_a_set_of_as_many_effects_as_a_search_tries_is_not_enlarged(begin):
    """A fourth and a fifth effect cost much, and named nothing."""
    task, search = begin
    full = SimpleNamespace(ids=frozenset({"gravity", "contact_stop", "moment_arm"}))
    best = search.base._replace(model=full)
    assert go_beyond(task, search._replace(best=best), Demand(10.0, 10.0)).beyond == ()
