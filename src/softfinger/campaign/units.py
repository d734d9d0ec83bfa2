"""Units by name, in pint's and laboratories' spellings."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING

from softfinger.faults import Fault

if TYPE_CHECKING:
    import pint

LONGEST = 40  # characters: no unit is longer
SPELLINGS = {
    "": "1",
    "-": "1",
    "–": "1",
    "none": "1",
    "px": "pixel",
    "Nm": "N*m",
    "Nmm": "N*mm",
    "mNm": "mN*m",
    "Ncm": "N*cm",
    "Sec": "s",
    "secs": "s",
    "hrs": "h",
    "hr": "h",
    "msec": "ms",
    "millisec": "ms",
    "millisecs": "ms",
    "usec": "us",
    "nsec": "ns",
    "min.": "min",
    "sec.": "s",
    "µε": "microstrain",
    "µstrain": "microstrain",
    "ustrain": "microstrain",
    "°/s": "deg/s",
    "Grad": "deg",
    "度": "deg",
    "秒": "s",
    "gf": "gram_force",
    "counts": "count",
}


@cache
def _registry() -> pint.UnitRegistry:
    import pint

    return pint.UnitRegistry(cache_folder=None)


@cache
def parse_unit(text: str) -> pint.Unit:
    """Unit that a text names, by pint.

    "1" where it has none.

    Raises
    ------
    Fault
        Pint does not know it.

    Examples
    --------
    >>> str(parse_unit("Nmm")), str(parse_unit("1/Pa")), str(parse_unit("-"))
    ('millimeter * newton', '1 / pascal', 'dimensionless')
    """
    name = text.strip()
    name = SPELLINGS.get(name, name)
    if len(name) > LONGEST:
        raise Fault(f"unit '{name[:LONGEST]}…' is longer than any unit; write it as in mm or 1/Pa")
    try:
        return _registry().parse_units(re.sub(r"[²³]", lambda m: f"**{'²³'.index(m[0]) + 2}", name))
    except Exception:  # pint raises whatever its parser met
        raise Fault(
            f"unit '{text}' is not known; write it as pint does: mm, N, kPa, percent, 1/Pa, or 1"
        ) from None


def is_unit(text: str) -> bool:
    """Whether a text names a unit.

    >>> is_unit("mm"), is_unit("likelihood")
    (True, False)
    """
    try:
        parse_unit(text)
    except Fault:
        return False
    return True


def find_factor(unit: str, wanted: str) -> float:
    """Factor from one unit to another.

    Raises
    ------
    Fault
        One of them is unknown, or they measure different things.

    Examples
    --------
    >>> find_factor("min", "s")
    60.0
    """
    import pint

    source, target = parse_unit(unit), parse_unit(wanted)
    try:
        zero, one = (_registry().Quantity(x, source).to(target).magnitude for x in (0.0, 1.0))
    except pint.DimensionalityError:
        raise Fault(
            f"'{unit}' cannot be turned into '{wanted}': they measure different things"
        ) from None
    return float(one - zero)
