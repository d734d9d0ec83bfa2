"""Borrowed structures: what is written through them is there, and nobody counts."""

import numpy as np
import pytest
from numba import njit, types
from numba.experimental import structref

from softfinger.compiled.borrowed import Borrowed, borrow, keep_alive

ROW = types.Array(types.float64, 1, "C")


@structref.register
class InnerType(types.StructRef):
    pass


@structref.register
class OuterType(types.StructRef):
    pass


class Inner(structref.StructRefProxy):
    pass


class Outer(structref.StructRefProxy):
    pass


structref.define_proxy(Inner, InnerType, ["row"])
structref.define_proxy(Outer, OuterType, ["inner", "scale", "row"])
INNER = InnerType([("row", ROW)])
OUTER = OuterType([("inner", INNER), ("scale", types.float64), ("row", ROW)])


@njit
def work_in(outer, n):
    for k in range(n):
        outer.inner.row[k] += outer.scale * outer.row[k]
    return outer.inner.row[:n].sum()


@njit
def write_through(n):
    owner = Outer(Inner(np.zeros(n)), 2.0, np.arange(n) * 1.0)
    total = work_in(borrow(owner), n)
    return total, owner.inner.row


@njit
def allocate_meanwhile(n):
    """Arrays of the same size, which would take the place of a structure that is given back."""
    owner = Outer(Inner(np.zeros(n)), 2.0, np.ones(n))
    outer = borrow(owner)
    other = [np.full(n, 7.0) for _ in range(8)]
    total = work_in(outer, n)
    keep_alive(owner)
    return total, len(other)


@njit
def choose(outer, n):
    """Rows that the compiler cannot tell apart, so that it must count them."""
    row = outer.row
    for k in range(n):
        if row[k] > 2.0:
            row = outer.inner.row
        row[k] += 1.0
    return row[0]


def test_what_is_written_through_a_loan_is_in_its_owner():
    total, row = write_through(5)
    assert total == 20.0
    np.testing.assert_array_equal(row, [0.0, 2.0, 4.0, 6.0, 8.0])


def test_an_owner_lives_until_it_is_no_longer_needed():
    assert allocate_meanwhile(5) == (10.0, 8)


@pytest.mark.parametrize(("kind", "counted"), [(OUTER, True), (Borrowed(OUTER), False)])
def test_references_to_borrowed_arrays_are_not_counted(kind, counted):
    choose.compile((kind, types.int64))
    code = choose.overloads[(kind, types.int64)].library.get_llvm_str()
    calls = [line for line in code.splitlines() if "call" in line and "@NRT_incref" in line]
    assert bool(calls) is counted


def test_the_type_has_the_digest_of_its_lowering():
    assert Borrowed(OUTER) == Borrowed(OUTER)
    assert Borrowed(OUTER) != Borrowed(OUTER, "of another day")
