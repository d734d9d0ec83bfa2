"""An array that does not fit into a part of another is refused in short."""

import numpy as np
import pytest
from numba import njit

import softfinger.compiled  # noqa: F401


@njit
def assign(whole, part):
    whole[1:3] = part
    return whole


def test_an_array_that_fits_is_assigned():
    assert assign(np.zeros(4), np.ones(2)).tolist() == [0.0, 1.0, 1.0, 0.0]


def test_another_shape_is_refused_without_text_in_the_machine_code():
    with pytest.raises(ValueError, match="to a part of another shape"):
        assign(np.zeros(4), np.ones(3))
    code = assign.inspect_llvm(assign.signatures[0])
    assert "unicode" not in code  # numba's own error spells the shapes out
