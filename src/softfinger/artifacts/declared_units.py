"""Artifacts of a specimen in its declared units.

Inside, a specimen's motion is an angle [rad] (`tracking.specimen`); the attributes of
`angles` state what one radian is. For a finger nothing changes.
"""

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from softfinger.artifacts.verdict import Estimate, StatedEffect, Verdict
from softfinger.units import Units, split_unit

POWER = {"rad": 1, "rad2": 2, "rad-1": -1, "N m/rad": -1, "N m s/rad": -1}
OWN_SCALE = (
    "estimate", "estimate_sd", "centre", "centre_sd", "centre_quantile", "rival_centre",
    "bar_edge", "abscissa",
)  # fmt: skip
"""Variables over `parameter` in the parameters' own units."""
PER_OWN_UNIT = ("kept_density", "dropped_density", "two_stage_density", "posterior_density")
LOCATIONS = ("quantile_value", "rival_value", "population_mean", "sd", "population_sd")
"""Variables over `parameter` of the logarithm, and of q_ini itself."""
IN_KEY = re.compile(r"(?P<per>per_)?rad(?P<power>\d*)(?=_|$)")


def state_in_declared_units(artifacts: Mapping[str, Any]) -> dict[str, Any]:
    """Turn all motions into the declared unit.

    Parameters
    ----------
    artifacts : mapping
        Name → Dataset, DataTree or verdict; with `angles`.

    Returns
    -------
    dict
        The same with values in the declared unit, measured from the specimen's zero; each Dataset
        has the attributes ``motion_quantity``, ``motion_unit`` and ``load_unit``. Without
        `assumptions`, which are about a finger.
    """
    attrs = artifacts["angles"].attrs
    if "motion_unit" not in attrs:
        return dict(artifacts)
    stamp = {key: attrs[key] for key in ("motion_quantity", "motion_unit")}
    stamp["load_unit"] = attrs["load_unit"]
    size = float(attrs["motion_per_rad"])
    stated: dict[str, Any] = {}
    for name, artifact in artifacts.items():
        if name == "assumptions":
            continue
        if isinstance(artifact, xr.DataTree):
            stated[name] = artifact.map_over_datasets(lambda part: _state(part, size, stamp))
        elif isinstance(artifact, xr.Dataset):
            stated[name] = _state(artifact, size, stamp)
        elif name == "verdict" and artifact is not None:
            stated[name] = _state_residuals(artifact, size)
        else:
            stated[name] = artifact
    return stated


def _state(dataset: xr.Dataset, size: float, stamp: Mapping[str, str]) -> xr.Dataset:
    changed = {}
    for name, array in dataset.data_vars.items():
        power = POWER.get(str(array.attrs.get("units")), 0)
        if power:
            changed[name] = (array * size**power).assign_attrs(array.attrs)
        elif name == "argument" and "argument_name" in dataset:
            names = dataset["argument_name"].astype(str)
            factor = [split_unit(one, Units(size=size))[2] for one in names.values]
            changed[name] = (array * names.copy(data=factor)).assign_attrs(array.attrs)
        elif "parameter" in array.dims and array.dtype.kind == "f":
            changed[name] = _state_parameter(str(name), array, size)
    return dataset.assign(changed).assign_attrs(stamp)


def _state_parameter(name: str, array: xr.DataArray, size: float) -> xr.DataArray:
    """Parameters in the declared unit of motion."""
    parameter = array["parameter"].astype(str)
    initial = (parameter == "q_ini") | (parameter == "log_q_ini")
    if name in OWN_SCALE:
        return array * xr.where(initial, size, 1.0 / size)
    if name in PER_OWN_UNIT:
        return array * xr.where(initial, 1.0 / size, 1.0)
    if name not in LOCATIONS:
        return array
    stated = array * xr.where(initial, size, 1.0)
    if "sd" in name:
        return stated
    shift = xr.where(initial, 0.0, -np.log(size))
    if "statistic" in array.dims:
        shift = shift * (array["statistic"].astype(str) == "mu")
    return (stated + shift).transpose(*array.dims)


def _state_residuals(verdict: Mapping[str, Any], size: float) -> dict[str, Any]:
    rms = {k: v if v is None else v * size for k, v in verdict["residual_rms_rad"].items()}
    return {**verdict, "residual_rms_rad": rms}


def state_key(key: str, units: Units) -> tuple[str, int]:
    """Parameter name in declared units, with radian's power.

    >>> mm = Units("mm", "N")
    >>> state_key("stop_angle_rad_1", mm), state_key("stiffening_per_rad2_1", mm)
    (('stop_angle_mm_1', 1), ('stiffening_per_mm2_1', -2))
    >>> state_key("stop_stiffness_nm_per_rad_1", Units("1", "Pa"))
    ('stop_stiffness_Pa_1', -1)
    """
    power = sum(
        (-1 if found["per"] else 1) * int(found["power"] or 1) for found in IN_KEY.finditer(key)
    )
    motion, load = ("" if name == "1" else name for name in (units.motion, units.load))
    named = IN_KEY.sub(lambda m: f"{m['per'] or ''}{motion}{m['power']}" if motion else "", key)
    named = re.sub(r"(?<=_)nm(?=_|$)", load, named)
    return re.sub("__+", "_", named).strip("_"), power


def state_sizes(verdict: Verdict, units: Units) -> Verdict:
    """State the sizes of effects in declared units.

    Those of a finger are in them.
    """
    if not units.specimen:
        return verdict
    return verdict.model_copy(
        update={"effects": [_state_effect(e, units) for e in verdict.effects]}
    )


def _state_effect(effect: StatedEffect, units: Units) -> StatedEffect:
    parameters = {}
    for key, value in effect.parameters.items():
        name, power = state_key(key, units)
        parameters[name] = Estimate(**{k: v * units.size**power for k, v in value})
    spread = {state_key(key, units)[0]: value for key, value in effect.spread.items()}
    return effect.model_copy(update={"parameters": parameters, "spread": spread})
