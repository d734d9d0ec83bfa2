"""A short error where array shapes differ.

Numba's own spells out both shapes. The text is made by code that goes into every function with such
an assignment, and into all that call it, and all of it is compiled.
"""

from collections.abc import Callable

from numba.core.extending import overload
from numba.np import arrayobj


def refuse_shape(source: tuple, target: tuple) -> None:
    """Refuse to assign an array of another shape.

    Raises
    ------
    ValueError
        Always: it is called where the shapes differ.
    """
    raise ValueError("an array is assigned to a part of another shape")


@overload(refuse_shape)
def _refuse_shape(source: tuple, target: tuple) -> Callable:
    return refuse_shape


def shorten_errors() -> None:
    """Have numba refuse an array's shape in short."""
    arrayobj.raise_with_shape_context = refuse_shape
