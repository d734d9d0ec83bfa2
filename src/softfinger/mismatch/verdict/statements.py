"""Plain sentences with figures, built from fitted effects."""

import math
from collections.abc import Mapping

import numpy as np
import xarray as xr

from softfinger.artifacts.verdict import Estimate
from softfinger.mechanics.effects.effect import Effect
from softfinger.units import RADIANS, Units, split_unit


def format_estimate(mean: float, sd: float) -> str:
    """Write a mean with two digits of its sd.

    >>> format_estimate(5.91234, 0.3987), format_estimate(1234.0, 56.0)
    ('5.91 ± 0.40', '1234 ± 56')
    """
    if not sd > 0:
        return f"{mean:.3g}"
    digits = max(0, 1 - math.floor(math.log10(sd)))
    return f"{mean:.{digits}f} ± {sd:.{digits}f}"


def list_joints(joints: list[int]) -> str:
    """Write joint numbers as words.

    >>> list_joints([2]), list_joints([1, 2, 3]), list_joints([])
    ('joint 2', 'joints 1, 2 and 3', '')
    """
    if len(joints) < 2:
        return "".join(f"joint {j}" for j in joints)
    return f"joints {', '.join(map(str, joints[:-1]))} and {joints[-1]}"


def state_effect(
    effect: Effect,
    form: str,
    joints: list[int],
    probability: float,
    parameters: dict[str, Estimate],
    spread: Mapping[str, float],
    curve: str = "",
    units: Units = RADIANS,
) -> str:
    """State one effect: what, where, how large, how sure.

    `spread` is what its parameters differ by from trial to trial, relatively; `curve` states its
    free law. A specimen has no joints.
    """
    where = f" ({list_joints(joints)})" if joints and not units.specimen else ""
    sentence = effect.sentence if probability >= 0.5 else f"perhaps {effect.sentence}"
    sentence = sentence[0].upper() + sentence[1:]
    sentence = sentence.replace("joint", "specimen") if units.specimen else sentence
    sizes = []
    for name, value in parameters.items():
        words, unit, size = split_unit(name, units)
        known = format_estimate(size * value.mean, size * value.sd)
        sizes.append(f"{words} {known} {unit}".rstrip())
    sure = f"{probability:.3g}" if probability < 0.9995 else "above 0.999"  # none is 1
    best = "; ".join(filter(None, [form.replace("_", " "), ", ".join(sizes)]))
    differs = [
        f" From trial to trial the {split_unit(name)[0]} differs by {100 * size:.2g} %."
        for name, size in spread.items()
    ]
    return (
        f"{sentence}{where}: {effect.id.replace('_', ' ')} was left out, with probability "
        f"{sure}. Best form: {best}.{curve}{''.join(differs)}"
    )


def state_curves(laws: xr.Dataset, effect: str, units: Units = RADIANS) -> str:
    """State where the free laws of an effect end.

    Empty without one. `laws` are those of `compute_law_curves`.
    """
    ends = []
    for row in np.flatnonzero(laws["effect"].values == effect):
        here = laws.isel(law=row, place=-1)
        verb = "adds" if here["kind"] == "sum" else "multiplies by"
        value, low, high = (f"{float(here[name]):.3g}" for name in ("value", "low", "high"))
        words, unit, size = split_unit(str(here["argument_name"].values), units)
        at = f"{words} {size * float(here['argument']):.3g} {unit}".rstrip()
        where = f" in joint {int(here['joint'])}" if here["joint"] and not units.specimen else ""
        ends.append(f"{verb} {value} ({low} to {high}) at {at}{where}")
    return f" Its free law {', '.join(ends)}." if ends else ""
