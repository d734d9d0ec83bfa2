"""Lent structures: what is written through them is there, and nobody counts."""

import numpy as np
from numba import njit, types
from numba.experimental import structref

from softfinger.compiled.lent import Lent, keep_alive, lend

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
def work_in(lent, n):
    for k in range(n):
        lent.inner.row[k] += lent.scale * lent.row[k]
    return lent.inner.row[:n].sum()


@njit
def borrow(n):
    owner = Outer(Inner(np.zeros(n)), 2.0, np.arange(n) * 1.0)
    total = work_in(lend(owner), n)
    keep_alive(owner)
    return total, owner.inner.row


def test_what_is_written_through_a_loan_is_in_its_owner():
    total, row = borrow(5)
    assert total == 20.0
    np.testing.assert_array_equal(row, [0.0, 2.0, 4.0, 6.0, 8.0])


def test_a_loan_counts_no_references():
    """Two atomic instructions for each array took half of the forward model's time."""
    work_in.compile((Lent(OUTER), types.int64))
    code = next(text for kind, text in work_in.inspect_llvm().items() if isinstance(kind[0], Lent))
    body = code[code.index("define") :]
    counted = [line for line in body.splitlines() if "call" in line and "NRT_incref" in line]
    assert not [line for line in counted if "null" not in line]


def test_the_type_has_the_digest_of_its_lowering():
    assert Lent(OUTER) == Lent(OUTER)
    assert Lent(OUTER) != Lent(OUTER, "of another day")
