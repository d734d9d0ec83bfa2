"""What motion and load are measured in.

Inside, both are in rad and N m; a name's suffix states the unit of its value.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

UNIT_ATTRS = ("motion_quantity", "motion_unit", "motion_per_rad", "load_unit")
IN_NAME = {  # suffix of a name → powers of motion, load and second
    "_nm_per_rad": (-1, 1, 0),
    "_per_nm2": (0, -2, 0),
    "_per_rad2": (-2, 0, 0),
    "_per_rad": (-1, 0, 0),
    "_nm": (0, 1, 0),
    "_rad_per_s": (1, 0, -1),
    "_rad": (1, 0, 0),
    "_s": (0, 0, 1),
}
FIXED = {"_per_m2": "m⁻²", "_n": "N"}
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class Units(NamedTuple):
    """What motion and load are measured in.

    Attributes
    ----------
    motion, load
        Names of the units.
    size
        One radian in that of the motion.
    specimen
        Whether there is one motion, and no joint.
    """

    motion: str = "rad"
    load: str = "N m"
    size: float = 1.0
    specimen: bool = False


RADIANS = Units()


def read_units(attrs: Mapping[str, Any]) -> Units:
    """Read units from the attributes of a Dataset."""
    if "motion_unit" not in attrs:
        return RADIANS
    size = float(attrs.get("motion_per_rad", 1.0))
    return Units(str(attrs["motion_unit"]), str(attrs["load_unit"]), size, specimen=True)


def select_units(attrs: Mapping[str, Any]) -> dict[str, Any]:
    """Select the attributes that `read_units` reads."""
    return {key: attrs[key] for key in UNIT_ATTRS if key in attrs}


def split_unit(name: str, units: Units = RADIANS) -> tuple[str, str, float]:
    """Split a name into words, unit, and factor.

    The factor turns a value in radians into that unit.

    >>> split_unit("lag_s"), split_unit("play_rad_2", Units("mm", "N", 20.0))
    (('lag', 's', 1.0), ('play 2', 'mm', 20.0))
    >>> split_unit("stop_stiffness_nm_per_rad", Units("1", "Pa", 0.5))
    ('stop stiffness', 'Pa', 2.0)
    """
    quantity = name.rstrip("_0123456789")
    known = [*IN_NAME, *FIXED]
    suffix = next((suffix for suffix in known if quantity.endswith(suffix)), "")
    words = (quantity.removesuffix(suffix) + name.removeprefix(quantity)).replace("_", " ")
    if suffix not in IN_NAME:
        return words, FIXED.get(suffix, ""), 1.0
    powers = IN_NAME[suffix]
    unit = write_unit(*zip((units.motion, units.load, "s"), powers, strict=True))
    return words, unit, units.size ** powers[0]


def write_unit(*powers: tuple[str, int]) -> str:
    """Write a product of units; "1" is none.

    >>> write_unit(("N m", 1), ("rad", -1)), write_unit(("N m", -2))
    ('N m/rad', '(N m)⁻²')
    >>> write_unit(("1", 1), ("s", -1)), write_unit(("V", 1), ("V", -1))
    ('s⁻¹', 'V/V')
    """
    known = [(name, power) for name, power in powers if power and name != "1"]
    up = [_raise(name, power) for name, power in known if power > 0]
    if not up:
        return " ".join(_raise(name, power) for name, power in known)
    down = [_raise(name, -power) for name, power in known if power < 0]
    return "/".join([" ".join(up), *down])


def label_thousandth(unit: str) -> str:
    """Label a thousandth of a unit.

    >>> label_thousandth("rad"), label_thousandth("mm"), label_thousandth("1")
    ('mrad', '10⁻³ mm', '10⁻³')
    """
    return "mrad" if unit == "rad" else f"10⁻³ {unit if unit != '1' else ''}".rstrip()


def _raise(name: str, power: int) -> str:
    if power == 1:
        return name
    base = f"({name})" if set(name) & set("/* ") else name
    return base + str(power).translate(SUPERSCRIPT)
