"""Specimens: a motion of any unit becomes angles."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from softfinger.campaign import Specimen
from softfinger.faults import TrialFault
from softfinger.measurement.flags import JUMP, MISSING

# ASSUME: a typical trial bends by half a radian, as the priors of a finger expect. A motion of any
# quantity has no natural size of its own; with this one a change of its unit changes nothing else.
TYPICAL_RANGE_RAD = 0.5
LOADED = 0.1  # of the largest load
HELD, RELAXED = 0.02, 0.1  # shares of the largest motion and load
PARTS = 10  # medians of a test: noise shows little in them
SUDDEN = 0.8  # share of the load's change between two parts: it was taken off, and did not relax


def scale_motion(
    specimen: Specimen, trials: Sequence[xr.Dataset]
) -> tuple[list[xr.Dataset], dict[str, str | float]]:
    """Turn the motion of a specimen into angles [rad].

    Parameters
    ----------
    specimen : Specimen
        Its declared units.
    trials : sequence of Dataset
        ``time``, ``joint_angle (joint, frame)`` in the declared unit, ``angle_flag``, ``load_time``
        and ``load_torque`` of each trial.

    Returns
    -------
    trials : list of Dataset
        ``joint_angle = (motion - motion_zero) / motion_per_rad``.
    attrs : dict
        ``motion_quantity``, ``motion_unit``, ``motion_per_rad``, ``motion_zero`` (both in that
        unit), ``load_quantity``, ``load_unit`` and ``noise_sd_rad``.

    Notes
    -----
    The zero is the median motion before any load, over trials, and 0 where all are loaded from
    their first frame on. One radian is twice the median range of a trial, from that zero on where
    it is loaded from its first frame on.
    """
    rests = [_select_motion(one)[0] for one in trials if not _is_loaded_at_first(one)]
    zero = float(np.median(rests)) if rests else 0.0
    per_rad = float(np.median([_measure_range(one, zero) for one in trials])) / TYPICAL_RANGE_RAD
    per_rad = per_rad if per_rad > 0.0 else 1.0
    noise = specimen.motion.noise_sd
    attrs = {
        "motion_quantity": specimen.motion.quantity,
        "motion_unit": specimen.motion.unit,
        "motion_per_rad": per_rad,
        "motion_zero": zero,
        "load_quantity": specimen.load.quantity,
        "load_unit": specimen.load.unit,
        "noise_sd_rad": np.nan if noise is None else noise / per_rad,
    }
    scaled = [
        one.assign(
            joint_angle=(one["joint_angle"] - zero) / per_rad,
            joint_angle_covariance=one["joint_angle_covariance"] / per_rad**2,
        )
        for one in trials
    ]
    return scaled, attrs


def _is_loaded_at_first(trial: xr.Dataset) -> bool:
    time = trial["time"].to_numpy()[np.argmax(_is_good(trial))]
    load = trial["load_torque"].to_numpy()
    first = np.interp(time, trial["load_time"], load, left=0.0)
    return bool(abs(first) > LOADED * np.abs(load).max())


def _measure_range(trial: xr.Dataset, zero: float) -> float:
    motion = _select_motion(trial)
    return float(np.ptp([*motion, zero] if _is_loaded_at_first(trial) else motion))


def refuse_relaxation(file_name: str, trial: xr.Dataset) -> None:
    """Refuse a relaxation test.

    There the motion is kept constant and the load relaxes.

    The second half of a recording, by frames, is cut into ten parts; the motion is held where their
    medians stay within 2 % of the largest motion, and the load relaxes where their medians change
    by more than 10 % of the largest load, and not at once.

    Raises
    ------
    TrialFault
        It is such a test.
    """
    good = np.flatnonzero(_is_good(trial))
    time = trial["time"].to_numpy()[good]
    motion = trial["joint_angle"].isel(joint=0).to_numpy()[good]
    load = np.interp(time, trial["load_time"], trial["load_torque"], left=0.0)
    if good.size < 4 * PARTS or not (np.ptp(motion) > 0 and np.any(load)):
        return
    path, pull = _take_parts(motion - motion[0]), _take_parts(load)
    fell = np.ptp(pull)
    if np.ptp(path) < HELD and fell > RELAXED and np.abs(np.diff(pull)).max() < SUDDEN * fell:
        raise TrialFault(
            f"{file_name}: the motion is constant and the load falls by {fell:.0%} of its "
            "largest: a "
            "test at constant strain (relaxation). The models here describe the motion under a "
            "load; "
            "record a test at constant load (creep)"
        )


def _take_parts(values: np.ndarray) -> np.ndarray:
    """Medians of the later parts, over the largest."""
    parts = [np.median(part) for part in np.array_split(values[values.size // 2 :], PARTS)]
    return np.array(parts) / np.abs(values).max()


def _is_good(trial: xr.Dataset) -> np.ndarray:
    flag = trial["angle_flag"].isel(joint=0).to_numpy()
    angle = trial["joint_angle"].isel(joint=0).to_numpy()
    return ((flag & (MISSING | JUMP)) == 0) & np.isfinite(angle)


def _select_motion(trial: xr.Dataset) -> np.ndarray:
    return trial["joint_angle"].isel(joint=0).to_numpy()[_is_good(trial)]
