"""Every number that decides has its reason, and a test that is there."""

import re
import sys

import pytest

from softfinger.provenance import PROJECT

sys.path.insert(0, str(PROJECT / "docs/extensions"))
from decisions_page import KINDS, describe_decisions, list_numbers

NUMBERS = list(list_numbers())


def test_every_number_has_what_it_is_and_why():
    assert {number.kind for number in NUMBERS} == set(KINDS)
    assert [n.name for n in NUMBERS if not n.what.endswith((".", ".)"))] == []
    bare = [f"{n.room}.{n.name}" for n in NUMBERS if n.kind != "budget" and len(n.why) < 8]
    assert bare == []


@pytest.mark.parametrize("number", NUMBERS, ids=lambda n: f"{n.room}.{n.name}")
def test_every_decision_names_a_test_that_is_there(number):
    assert number.tests or number.kind != "decisions"
    for test in number.tests:
        file, _, name = test.partition("::")
        found = list((PROJECT / "tests").rglob(file))
        held = [p for p in found if re.search(rf"^def {name}\(", p.read_text(), re.M)]
        assert len(held) == 1, f"{test} is in {held}"


def test_the_page_has_all_of_them():
    page = describe_decisions()
    assert all(f"`{n.room}.{n.name}`" in page for n in NUMBERS)
