"""What of a measurement could not be estimated."""

import numpy as np
import xarray as xr

from softfinger.artifacts.verdict import Warned
from softfinger.measurement.decisions import DECISIONS as MEASURING
from softfinger.measurement.unused import explain_unused
from softfinger.measurement.words import write_motion
from softfinger.units import read_units


def list_unused(angles: xr.Dataset, used: list[str]) -> list[Warned]:
    """List trials that inform nothing, with the reason."""
    return [
        Warned(
            id="trial_left_out",
            trials=[name],
            statement=(
                f"Trial {name} is left out, for fewer than {MEASURING.least_frames} of its frames "
                f"inform: {reason}."
            ),
        )
        for name, reason in explain_unused(angles, used).items()
    ]


def list_assumed(measurement: xr.Dataset, *, load_known: bool) -> list[Warned]:
    """List what is assumed where it cannot be estimated."""
    said = []
    blind = measurement["joint"].values[measurement["window_count"].values == 0]
    if blind.size:
        units = read_units(measurement.attrs)
        sd = write_motion(float(np.median(measurement["noise_sd"].sel(joint=blind))), units)
        joints = ", ".join(str(joint) for joint in blind)
        whose = "the motion" if units.specimen else f"joint {joints}"
        others = "" if units.specimen else " or of the other joints"
        said.append(
            f"No quiet stretch shows the noise of {whose}: it is assumed to be white, with "
            f"the sd {sd} of its second differences{others}; record a few seconds at rest."
        )
    if not load_known:
        said.append(
            "There is no load log: a load of 1 from the first frame is assumed, without scatter "
            "and by the camera's clock; record the load."
        )
    return [Warned(id="assumed_measurement", trials=[], statement=words) for words in said]
