"""Refuse, with value and bound, what no finger has."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softfinger.faults import Fault


def require_positive(name: str, value: ArrayLike, unit: str, *, infinite: bool = False) -> None:
    """Refuse values not > 0 or, unless `infinite`, infinite."""
    array = np.asarray(value, float)
    bad = ~(array > 0) if infinite else ~((array > 0) & (array < np.inf))
    if bad.any():
        _raise_first(name, array, bad, f"positive{'' if infinite else ' and finite'} [{unit}]")


def require_nonnegative(name: str, value: ArrayLike, unit: str) -> None:
    """Raise `Fault` unless values are finite and >= 0."""
    array = np.asarray(value, float)
    bad = ~((array >= 0) & (array < np.inf))
    if bad.any():
        _raise_first(name, array, bad, f"finite and at least 0 [{unit}]")


def require_finite(name: str, value: ArrayLike, unit: str) -> None:
    """Raise `Fault` unless every value is finite."""
    array = np.asarray(value, float)
    bad = ~np.isfinite(array)
    if bad.any():
        _raise_first(name, array, bad, f"finite [{unit}]")


def require_forward_in_time(name: str, time: ArrayLike, *, padded: bool = False) -> None:
    """Raise `Fault` where times [s] decrease.

    They run along the last axis.

    With `padded`, rows may end in NaN.
    """
    array = np.asarray(time, float)
    usable = array if not padded else np.where(np.isnan(array), np.inf, array)
    bad = np.isnan(usable) | (usable == -np.inf) | ((usable == np.inf) & (not padded))
    if bad.any():
        _raise_first(name, array, bad, "finite [s]")
    backwards = usable[..., 1:] < usable[..., :-1]
    if backwards.any():
        place = tuple(int(i) for i in np.argwhere(backwards)[0])
        after = (*place[:-1], place[-1] + 1)
        raise Fault(
            f"{name}{list(after)} = {array[after]:g} s runs backwards: "
            f"it must be at least the time before it, {array[place]:g} s"
        )


def _raise_first(name: str, array: NDArray, bad: NDArray, expected: str) -> None:
    place = tuple(int(i) for i in np.argwhere(bad)[0])
    where = str(list(place)) if place else ""
    raise Fault(f"{name}{where} = {array[place]:g}: it must be {expected}")
