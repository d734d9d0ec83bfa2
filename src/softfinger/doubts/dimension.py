"""Doubtful sizes: loads, stiffness, masses, lengths."""

from collections.abc import Iterator, Sequence

import numpy as np
import xarray as xr

from softfinger.doubts.doubt import Doubt, name_factor
from softfinger.doubts.features import TrialFeatures

GRAVITY = 9.81
# (low, high): far outside of what soft fingers are.
TENSION_N = (0.05, 250.0)
TORQUE_NM = (1e-5, 20.0)
STIFFNESS_OVER_WEIGHT = (0.2, 700.0)
DENSITY = (2.0, 50_000.0)  # mass over the cube of the length [kg/m³]
ARM_OVER_LINK = (0.02, 1.0)
JOINT_OVER_LINK = (0.02, 1.3)
UNEQUAL = 30.0  # ratio of two links
# A slow noise looks small from frame to frame, so a declared one may be some times larger.
DECLARED_NOISE = (0.2, 30.0)


def doubt_dimension(trials: Sequence[TrialFeatures], angles: xr.Dataset) -> Iterator[Doubt]:
    """Doubt what is out of range in all trials."""
    kind = str(angles["load_kind"].values[0])
    length, mass = (angles[name].to_numpy() for name in ("link_length", "link_mass"))
    arm, joint = float(angles["wire_offset"]), float(angles["joint_length"])
    if kind in ("tension_n", "torque_nm"):
        weight = GRAVITY * float(np.sum(mass * (np.cumsum(length) - 0.5 * length)))
        yield from _doubt_load(trials, kind, arm, weight)
    yield from doubt_range(
        "a link's mass over the cube of its length",
        float(np.median(mass / length**3)),
        DENSITY,
        "kg/m³",
        "grams in place of kilograms, or the unit of a length",
    )
    yield from doubt_range(
        "the wire's offset over a link's length",
        arm / float(np.median(length)),
        ARM_OVER_LINK,
        "",
        "the unit of wire_offset_m",
    )
    yield from doubt_range(
        "a joint's length over a link's",
        joint / float(np.median(length)),
        JOINT_OVER_LINK,
        "",
        "the unit of joint_length_m",
    )
    for name, values in (("link_length_m", length), ("link_mass_kg", mass)):
        yield from doubt_range(
            f"the largest over the smallest of {name}",
            float(values.max() / values.min()) if np.isfinite(values).all() else np.nan,
            (0.0, UNEQUAL),
            "",
            "a lost decimal point",
        )
    yield from _doubt_noise(trials, float(angles.attrs["noise_sd_rad"]))


def _doubt_load(
    trials: Sequence[TrialFeatures], kind: str, arm: float, weight: float
) -> Iterator[Doubt]:
    largest = float(np.median([trial.largest_load for trial in trials]))
    unit = "the load logs' unit"
    if kind == "tension_n":
        yield from doubt_range("the wire's largest tension", largest / arm, TENSION_N, "N", unit)
    else:
        yield from doubt_range("the largest torque", largest, TORQUE_NM, "N m", unit)
    stiffness = 1.0 / max(float(np.median([np.abs(t.gain).mean() for t in trials])), 1e-300)
    yield from doubt_range(
        "stiffness over the weight's torque per radian",
        stiffness / weight,
        STIFFNESS_OVER_WEIGHT,
        "",
        "the unit of load, angles, masses or lengths",
    )


def doubt_range(
    what: str, value: float, bounds: tuple[float, float], unit: str, cause: str
) -> Iterator[Doubt]:
    """Doubt a number outside its bounds.

    A number that was not declared is NaN and raises no doubt.
    """
    if not np.isfinite(value) or bounds[0] <= value <= bounds[1]:
        return
    said = f"{value:.3g} {unit}".strip()
    yield Doubt(
        "dimension",
        f"{what} is {said}; expected {bounds[0]:g} to {bounds[1]:g}; likely {cause}; see "
        "campaign.yaml and the headings of the tables",
    )


def _doubt_noise(trials: Sequence[TrialFeatures], declared: float) -> Iterator[Doubt]:
    noise = np.concatenate([trial.noise for trial in trials])
    shown = noise[noise > 0]
    if not np.isfinite(declared) or not shown.size:
        return
    seen = float(np.median(shown))
    ratio = declared / seen
    if not DECLARED_NOISE[0] <= ratio <= DECLARED_NOISE[1]:
        yield Doubt(
            "declared_noise",
            f"noise_sd_rad is {declared:.3g}, but the frames show {seen:.3g} rad: "
            f"{name_factor(ratio)}; likely degrees, or a value of another rig; remove the key to "
            "have it estimated",
        )
