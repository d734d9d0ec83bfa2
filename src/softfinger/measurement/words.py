"""Components of a measurement in words."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
import xarray as xr

from softfinger.mechanics.effects.measurement_file import LINK_TURN
from softfinger.units import Units, read_units, split_unit


class Words(NamedTuple):
    """How a component appears in a verdict.

    Key of the size, the sentence from size and measurement, the verdict's id if another, and
    whether it is a fault of the recordings; how long noise lasts is none.
    """

    key: str
    say: Callable[[float, xr.Dataset], str]
    id: str = ""
    fault: bool = True


def describe_components(measurement: xr.Dataset, names: Iterable[str]) -> list[str]:
    """Describe some components, a sentence each."""
    sizes = measurement["component_size"]
    return [find_words(n).say(float(sizes.sel(component=n)), measurement) for n in names]


def find_words(name: str) -> Words:
    """The words for a component; which link turns, they state."""
    if not name.startswith(LINK_TURN):
        return WORDS[name]
    link = name.removeprefix(LINK_TURN)
    return Words("noise_sd", lambda s, _: TURNS.format(link=link, size=s), "drift")


def list_moved_joints(name: str, joints: int) -> list[int]:
    """Joints, from 1, that a component moves; empty where that is all.

    >>> list_moved_joints("link_turn_2", 3), list_moved_joints("drift", 3)
    ([2, 3], [])
    """
    if name == "picture_turn":
        return [1]
    if not name.startswith(LINK_TURN):
        return []
    link = int(name.removeprefix(LINK_TURN))
    return [link, link + 1] if link < joints else [link]


def scale_trials(measurement: xr.Dataset) -> xr.DataArray:
    """Noise (trial,) over the campaign's, joints averaged."""
    return np.exp(np.log(measurement["trial_factor"]).mean("joint"))


def write_time(seconds: float) -> str:
    """Write a time with two digits.

    >>> write_time(2.04), write_time(0.00034)
    ('2000 ms', '0.34 ms')
    """
    return f"{float(f'{1e3 * seconds:.2g}'):g} ms"


def write_motion(angle: float, units: Units) -> str:
    """Write a small angle with two digits.

    >>> write_motion(0.00234, Units()), write_motion(0.00234, Units("mm", "N", 20.0, True))
    ('2.3 mrad', '0.047 mm')
    """
    if not units.specimen:
        return f"{float(f'{1e3 * angle:.2g}'):g} mrad"
    return f"{angle * units.size:.2g} {'' if units.motion == '1' else units.motion}".rstrip()


def _say_jitter(size: float, _: xr.Dataset) -> str:
    return f"The times of the frames jitter by {write_time(size)}."


def _say_uneven(size: float, measurement: xr.Dataset) -> str:
    factor = scale_trials(measurement)
    worst = factor["trial"].values[np.abs(np.log(factor.values)).argmax()]
    return (
        f"The noise differs between trials by {100 * np.expm1(size):.0f} %; that of {worst} is "
        f"{float(factor.sel(trial=worst)):.2g} times the campaign's."
    )


def _say_growth(cause: str, by: str) -> Callable[[float, xr.Dataset], str]:
    def say(size: float, measurement: xr.Dataset) -> str:
        units = read_units(measurement.attrs)
        sd = float(np.sqrt((measurement["noise_sd"] ** 2).mean()))
        least, grown = (write_motion(one, units) for one in (sd, sd * np.sqrt(1.0 + size**2)))
        _, unit, one = split_unit(by, units)
        place = f"{one:.3g} {unit}".rstrip()
        return f"The noise grows with the {cause}: from {least} at rest to {grown} at {place}."

    return say


def _say_hum(size: float, measurement: xr.Dataset) -> str:
    tones = list(dict.fromkeys(f"{f:.3g}" for f in measurement["hum_frequency"].values))
    listed = " and ".join([", ".join(tones[:-1]), tones[-1]] if len(tones) > 1 else tones)
    units = read_units(measurement.attrs)
    what = "motion hums" if units.specimen else "angles hum"
    return f"The {what} at {listed} Hz with {write_motion(size, units)}, whatever the load does."


def _name_motion(measurement: xr.Dataset) -> str:
    return "The motion drifts" if read_units(measurement.attrs).specimen else "The angles drift"


TURNS = "Link {link} seems to turn within a trial by {size:.2g} times the noise: its markers drift."
WORDS = {
    "outliers": Words(
        "share", lambda s, _: f"{100 * s:.2g} % of the frames are gross errors, and are left out."
    ),
    "heavy_tails": Words(
        "freedom",
        lambda s, _: (
            f"The noise has heavy tails, like Student's t with {s:.0f} degrees of freedom."
        ),
    ),
    "repeated_frames": Words(
        "share",
        lambda s, _: f"{100 * s:.2g} % of the frames repeat the one before, and are left out.",
    ),
    "saturated_sensor": Words(
        "share",
        lambda s, _: (
            f"{100 * s:.2g} % of the frames are at or after a limit of their sensor, and are left "
            "out."
        ),
    ),
    "lost_frames": Words("share", lambda s, _: f"{100 * s:.2g} % of the frames are missing."),
    "uneven_noise": Words("log_sd", _say_uneven),
    "signal_noise": Words("per_rad", _say_growth("deflection", "one_rad")),
    "rate_noise": Words("per_rad_s", _say_growth("speed", "one_rad_per_s"), "signal_noise"),
    "noisy_load": Words(
        "relative_sd",
        lambda s, _: f"The load log scatters by {100 * s:.2g} %: {10 * s:.2g} N at 10 N.",
    ),
    "load_drift": Words(
        "relative_sd",
        lambda s, _: f"The gain of the load cell drifts within a trial by {100 * s:.2g} %.",
        "noisy_load",
    ),
    "load_zero": Words(
        "relative_sd",
        lambda s, _: f"The zero of the load log is off by {100 * s:.2g} % of the largest load.",
        "noisy_load",
    ),
    "timing_jitter": Words("sd_s", _say_jitter),
    "frame_jitter": Words("sd_s", _say_jitter, "timing_jitter"),
    "clock_offset": Words(
        "sd_s",
        lambda s, _: f"Camera and load log are apart by {write_time(s)}, trial by trial.",
    ),
    "step_time": Words(
        "sd_s",
        lambda s, _: (
            f"Steps of the load come {write_time(s)} before the rows of the log that state them."
        ),
        "clock_offset",
    ),
    "step_moments": Words(
        "sd_s",
        lambda s, _: (
            "The load log reads too seldom to show when its steps came: by the motion "
            f"{write_time(s)} before its rows on average, each at a moment of its own."
        ),
        "clock_offset",
    ),
    "step_scatter": Words(
        "gap_share",
        lambda s, _: (
            "The load log reads too seldom to show when its steps came: they scatter "
            f"{s:.2g} times as much as any moment between two of its rows would."
        ),
        "clock_offset",
    ),
    "clock_rate": Words(
        "relative_sd",
        lambda s, _: f"The clocks of camera and load log differ by {100 * s:.2g} % in rate.",
    ),
    "drift": Words(
        "noise_sd",
        lambda s, m: f"{_name_motion(m)} within a trial by {s:.2g} times the noise.",
    ),
    "gain_drift": Words(
        "relative_sd",
        lambda s, _: f"The gain of the motion's sensor drifts within a trial by {100 * s:.2g} %.",
        "drift",
    ),
    "picture_turn": Words(
        "noise_sd",
        lambda s, _: (
            f"The picture turns within a trial by {s:.2g} times the noise: the first joint drifts."
        ),
        "drift",
    ),
    "lasting_noise": Words(
        "noise_sd",
        lambda s, _: (
            f"The noise lasts longer than quiet windows show: it has {s:.2g} times the slow waves "
            "that twice the memory would add."
        ),
        fault=False,
    ),
    "flicker_noise": Words(
        "noise_sd",
        lambda s, _: (
            "The noise has equal power in each octave: what windows do not show of it is "
            f"{s:.2g} times what they do."
        ),
        fault=False,
    ),
    "hum": Words("amplitude_rad", _say_hum, "drift"),
}
