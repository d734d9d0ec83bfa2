"""Which decision a posterior leads to."""

from types import SimpleNamespace

import pytest

from softfinger.mismatch.search.settle import Posterior
from softfinger.mismatch.verdict.conclude import choose_decision

FOUND = SimpleNamespace(base="base", best="effects")


def weigh(**sets):
    """Probabilities of sets of effects, one letter each."""
    return Posterior({frozenset(ids): share for ids, share in sets.items()}, {}, {})


def test_three_effects_that_are_needed_are_no_name():
    """A finger that softens by its largest strain was given three other causes, surely."""
    assert choose_decision(FOUND, weigh(abc=1.0), unlisted=False) == "unlisted"
    assert choose_decision(FOUND, weigh(abc=0.6, abe=0.4), unlisted=False) == "unlisted"
    assert choose_decision(FOUND, weigh(ab=1.0), unlisted=False) == "named"


def test_three_effects_may_be_needed_where_two_compete_with_them():
    assert choose_decision(FOUND, weigh(abc=0.6, ab=0.4), unlisted=False) == "ambiguous"


@pytest.mark.parametrize(("ids", "many"), [("", False), ("ab", False), ("abc", True)])
def test_a_name_has_two_effects_at_most(ids, many):
    assert weigh(**{ids: 1.0}).needs_many is many
