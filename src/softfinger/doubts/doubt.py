"""A doubt: finding, evidence, cause, and what to do."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from softfinger.faults import list_briefly

# Factors that a slip of the unit makes, and the slip.
FACTORS = {
    1e3: "a prefix: milli, or kilo",
    1e6: "a prefix: micro",
    100.0: "a prefix: centi; or per cent",
    10.0: "a decimal place",
    60.0: "minutes for seconds",
    3600.0: "hours for seconds",
    180.0 / np.pi: "degrees for radians",
    2.0 * np.pi: "turns for radians",
    9.80665: "kilograms for newtons",
    1e3 / 9.80665: "grams for newtons",
    4.448: "pounds for newtons",
    25.4: "inches for millimetres",
    2.0: "a factor of two: a radius for a diameter, every second frame",
}
# Those of them that a column of angles may have.
OF_ANGLES = {
    f: slip for f, slip in FACTORS.items() if "second" not in slip and "newton" not in slip
}
NEAR = 0.15  # of a factor, in its logarithm


@dataclass(frozen=True)
class Doubt:
    """One warning about trials and joints, or all."""

    id: str
    statement: str
    trials: tuple[str, ...] = ()
    joints: tuple[int, ...] = ()


def name_factor(ratio: float, spread: float = NEAR, factors: Mapping[float, str] = FACTORS) -> str:
    """Clause on the slip that makes a ratio.

    >>> name_factor(58.0)
    'a factor of 58, near 57.3 (degrees for radians)'
    >>> name_factor(7e4)
    'a factor of 7e+04'
    """
    size = max(ratio, 1.0 / ratio)
    near = min(factors, key=lambda factor: abs(np.log(size / factor)))
    said = f"a factor of {size:.3g}"
    if abs(np.log(size / near)) > max(NEAR, spread):
        return said
    return f"{said}, near {near:.3g} ({factors[near]})"


def name_trials(names: Sequence[str], of: int) -> str:
    """Trials as the subject of a sentence.

    >>> name_trials(["a"], 8), name_trials(["a", "b"], 2)
    ('trial a', 'all trials')
    """
    if len(names) == of:
        return "all trials" if of > 1 else "the trial"
    return f"trial{'s' * (len(names) > 1)} {list_briefly(names)}"
