"""Recordings set right by what is known to be wrong.

Every step that fits, predicts or compares sees the same recordings: those that this function
gives. What cannot be set right, because its size alone is known, is part of the noise instead
(`inference.disturbed`).
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.measurement.frames import compute_frame_interval_array
from softfinger.measurement.steady import steady_log
from softfinger.measurement.step_time import (
    advance_steps_array,
    list_steps_array,
    open_steps_array,
    place_steps_array,
)
from softfinger.measurement.tare import tare_log
from softfinger.mechanics.effects.measurement_file import Amplitudes, HumEntry, MeasurementEntry

Array = NDArray[np.float64]

MENDED = frozenset({"step_time", "step_moments", "load_zero"})
"""Components of what was set right that are no disturbance of the noise."""


def mend_recordings(angles: xr.Dataset, known: MeasurementEntry) -> xr.Dataset:
    """Mend log and clock, and take hums off.

    Parameters
    ----------
    angles
        The `angles` artifact.
    known
        What is wrong with it; trials that a hum does not name keep their angles, and those without
        an offset their times.

    Returns
    -------
    Dataset
        As `angles`, with time multiplied by 1 + rate, and later by each trial's offset; plateaus of
        the load at their mean, its zero taken off, its steps sooner by a share of their gaps (one
        for all, or one each) or straight lines over them; and each hum a cos ωt + b sin ωt taken
        off, t being the time that was set right.

    Raises
    ------
    Fault
        `known` has more steps than a trial's load, or a hum of other joints: it is not of `angles`.
    """
    if known.steady_load:
        angles = steady_log(angles, held=known.ramps_held)[0]
    if known.load_tared:
        angles = tare_log(angles)[0]
    if known.steps_early or known.steps_open or known.step_shares:
        angles = _move_steps(angles, known)
    if known.clock_rate:
        angles = angles.assign(time=angles["time"] * (1.0 + known.clock_rate))
    if known.clock_offsets_s:
        later = [known.clock_offsets_s.get(str(name), 0.0) for name in angles["trial"].values]
        angles = angles.assign(time=angles["time"] + xr.DataArray(later, dims="trial"))
    if known.hums:
        angle = angles["joint_angle"].transpose("trial", "joint", "frame")
        moved = sum(_move_hum(angles, hum) for hum in known.hums)
        angles = angles.assign(joint_angle=angle - moved)
    return angles


def read_every_row(known: MeasurementEntry) -> MeasurementEntry:
    """Leave every reading of the load as it is.

    Its rows state more steps than a steady load has: all come as much sooner as those on average.

    >>> read_every_row(MeasurementEntry(step_shares={"a": [0.25, 0.75]})).steps_early
    0.5
    """
    return _average_steps(known).model_copy(update={"steady_load": False})


def _hold_ramps(known: MeasurementEntry) -> MeasurementEntry:
    """Let each row of a ramp last until the next.

    Such rows are steps, or none. So all come as much sooner as those known on average.

    >>> _hold_ramps(MeasurementEntry(step_shares={"a": [0.25, 0.75]})).steps_early
    0.5
    """
    return _average_steps(known).model_copy(update={"ramps_held": True})


def _tare_load(known: MeasurementEntry) -> MeasurementEntry:
    """Take what a log reads at first for its zero."""
    return known.model_copy(update={"load_tared": True})


def _average_steps(known: MeasurementEntry) -> MeasurementEntry:
    shares = [share for some in known.step_shares.values() for share in some]
    early = float(np.mean(shares)) if shares else known.steps_early
    return known.model_copy(update={"step_shares": {}, "steps_early": early})


READINGS = {"ramps_held": _hold_ramps, "load_tared": _tare_load}
"""Other ways to read a log: field → what is known, read so."""


def _move_steps(angles: xr.Dataset, known: MeasurementEntry) -> xr.Dataset:
    time = angles["time"].transpose("trial", "frame").values
    knots, torque = (
        angles[name].transpose("trial", "knot") for name in ("load_time", "load_torque")
    )
    load = knots.values, torque.values
    interval = compute_frame_interval_array(time, np.isfinite(time))
    if known.steps_open:
        moved = open_steps_array(*load, interval)
    elif known.step_shares:
        moved = place_steps_array(*load, _list_shares(angles, known, load, interval), interval)
    else:
        moved = advance_steps_array(*load, known.steps_early, interval)
    return angles.assign(load_time=(knots.dims, moved))


def _list_shares(
    angles: xr.Dataset, known: MeasurementEntry, load: tuple[Array, Array], interval: float
) -> Array:
    """Shares (trial, step) of gaps.

    Steps that are not known stay at their rows.
    """
    gaps = list_steps_array(*load, interval)
    shares = np.zeros(gaps.shape)
    for row, gap, trial in zip(shares, gaps, angles["trial"].values, strict=True):
        some = known.step_shares.get(str(trial), [])
        if len(some) > np.count_nonzero(gap):
            raise Fault(
                f"measurement.step_shares.{trial}: {len(some)} listed, expected at most "
                f"{np.count_nonzero(gap)}, one for each step of the trial's load between two rows; "
                "take the others out, or diagnose again"
            )
        row[: len(some)] = some
    return shares


def _move_hum(angles: xr.Dataset, hum: HumEntry) -> Array:
    """Angles (trial, joint, frame) [rad] of a hum."""
    phase = 2.0 * np.pi * hum.frequency_hz * angles["time"].transpose("trial", "frame").values
    cosine, sine = (_list_amplitudes(angles, part) for part in (hum.cosine_rad, hum.sine_rad))
    return cosine * np.cos(phase)[:, None] + sine * np.sin(phase)[:, None]


def _list_amplitudes(angles: xr.Dataset, known: Amplitudes) -> Array:
    """Amplitudes (trial, joint, 1) [rad]; 0 in trials that are not named."""
    joints = angles.sizes["joint"]
    amplitudes = np.zeros((angles.sizes["trial"], joints))
    for row, trial in zip(amplitudes, angles["trial"].values, strict=True):
        some = known.get(str(trial), [0.0] * joints)
        if len(some) != joints:
            raise Fault(
                f"measurement.hums: {len(some)} amplitudes in trial {trial}, expected {joints}, "
                "one a joint of the recordings; diagnose again"
            )
        row[:] = some
    return amplitudes[:, :, None]
