"""Recordings that are tables: joint angles and marker positions."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from softfinger.campaign.tables import (
    check_columns,
    check_span,
    check_times,
    read_number_table,
    read_text_table,
    to_numbers,
)
from softfinger.faults import TrialFault, show

if TYPE_CHECKING:
    from softfinger.campaign.camera import Camera
    from softfinger.campaign.folder import Campaign
    from softfinger.campaign.trials import Trial

LARGEST_JOINT_ANGLE = 2.0 * np.pi
LARGEST_MOTION = 1e12  # of a specimen, in its own unit
LARGEST_PIXEL = 1e5
LEAST_ROWS = 3  # from which equal numbers are no chance
MARKER_NAME = re.compile(r"^(base|link_[1-9]\d*)_[1-9]\d*$")


def marker_names(camera: Camera) -> list[str]:
    """Names of the declared markers or dots.

    Markers of the base come first: ``base_1, base_2, link_1_1, …``.
    """
    if camera.dots:
        return list(camera.dots)
    links = ["base", *(f"link_{i + 1}" for i in range(len(camera.markers) - 1))]
    return [f"{link}_{k + 1}" for link in links for k in range(len(camera.markers[link]))]


def read_angle_table(campaign: Campaign, trial: Trial) -> xr.Dataset:
    """Read a trial's joint angles or specimen's motion.

    Angles are relative; a motion is in its own unit.

    Rows that share a time stamp (a clock coarser than the recording) become one frame, their mean.

    Returns
    -------
    Dataset
        ``time (frame) [s]``, strictly increasing; ``joint_angle (joint, frame) [rad]``, of a
        specimen in the unit of its motion, NaN where a cell is empty; attribute
        ``repeated_times``: how many rows shared the stamp of the row before.

    Raises
    ------
    TrialFault
        Missing or unknown column, text in a cell, times that run backwards, no usable frame,
        angles that no joint reaches (degrees taken for radians), or a joint that is dead or
        another's copy.
    """
    path = trial.recording
    joints = [f"q{j + 1}_rad" for j in range(campaign.finger.joints)]
    columns = joints if campaign.specimen is None else ["motion"]
    table = read_number_table(path, ["time_s", *columns], optional=columns)
    time = table.pop("time_s")
    check_times(path, time)
    check_span(path, time)
    angle = np.stack([table.pop(column) for column in columns])
    for column, values in zip(columns, angle, strict=True):
        if not np.isfinite(values).any():
            raise TrialFault(f"{path.name}, column '{column}': contains no number")
        largest = np.nanmax(np.abs(values))
        if campaign.specimen is None and largest > LARGEST_JOINT_ANGLE:
            row = int(np.nanargmax(np.abs(values))) + 2
            raise TrialFault(
                f"{path.name}, row {row}, column '{column}': reaches {largest:g} rad; a relative "
                "joint angle stays within 2π rad; is it in degrees?"
            )
        if largest > LARGEST_MOTION:
            raise TrialFault(
                f"{path.name}, column '{column}': reaches {largest:g}; expected at most "
                f"{LARGEST_MOTION:g}; choose a unit in which it is near 1"
            )
    _refuse_dead_joints(path.name, columns, angle)
    frame_time, mean_angle = _average_repeats_array(time, angle)
    return xr.Dataset(
        {"time": ("frame", frame_time), "joint_angle": (("joint", "frame"), mean_angle)},
        attrs={"repeated_times": time.size - frame_time.size},
    )


def _refuse_dead_joints(file_name: str, columns: list[str], angle: np.ndarray) -> None:
    """Refuse a constant joint, and a copied one."""
    for joint, values in enumerate(angle):
        seen = values[np.isfinite(values)]
        if seen.size >= LEAST_ROWS and np.ptp(seen) == 0.0:
            raise TrialFault(
                f"{file_name}, column '{columns[joint]}': is {seen[0]:g} rad in every row; a real "
                "joint moves, or shows noise; check that its sensor was on"
            )
        for other in range(joint):
            if seen.size >= LEAST_ROWS and np.array_equal(values, angle[other], equal_nan=True):
                raise TrialFault(
                    f"{file_name}: the columns '{columns[other]}' and '{columns[joint]}' are "
                    "equal in every row; one is a copy: export the joints again"
                )


def _average_repeats_array(time: np.ndarray, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean of numbers at one time, or NaN."""
    if (np.diff(time) > 0).all():
        return time, angle
    frame_time, frame = np.unique(time, return_inverse=True)
    seen = np.isfinite(angle)
    total = np.zeros((angle.shape[0], frame_time.size))
    count = np.zeros_like(total)
    for joint in range(angle.shape[0]):
        np.add.at(total[joint], frame, np.where(seen[joint], angle[joint], 0.0))
        np.add.at(count[joint], frame, seen[joint])
    return frame_time, np.where(count > 0, total / np.maximum(count, 1), np.nan)


def read_marker_table(campaign: Campaign, trial: Trial) -> xr.Dataset:
    """Read a trial's marker positions from a long table.

    Returns
    -------
    Dataset
        ``time (frame) [s]``, ``marker_position (frame, marker, axis) [px]`` in image coordinates
        (y down), ``marker_position_sd (frame, marker) [px]``; NaN where a marker is not listed.

    Raises
    ------
    TrialFault
        Missing or unknown column, an unknown marker, one that appears twice at a time, times that
        run backwards, or a link with fewer than two markers.
    """
    path = trial.recording
    table = read_text_table(path)
    check_columns(path, table, ["time_s", "marker", "x_px", "y_px"], ["sd_px"])
    time = to_numbers(path, table, "time_s")
    check_times(path, time)
    check_span(path, time)
    name = table["marker"].str.strip()
    names = _order_markers(path.name, name.unique().tolist(), campaign.finger.joints)
    frame_time, frame = np.unique(time, return_inverse=True)
    marker = name.map({n: k for k, n in enumerate(names)}).to_numpy()
    _refuse_repeats(path.name, frame, marker, names, frame_time)
    position = np.full((frame_time.size, len(names), 2), np.nan)
    for axis, column in enumerate(("x_px", "y_px")):
        values = to_numbers(path, table, column, missing_allowed=True)
        if np.nanmax(np.abs(values), initial=0.0) > LARGEST_PIXEL:
            raise TrialFault(
                f"{path.name}, column '{column}': reaches {np.nanmax(np.abs(values)):g} px; "
                f"expected less than {LARGEST_PIXEL:g} px"
            )
        position[frame, marker, axis] = values
    sd = np.full((frame_time.size, len(names)), np.nan)
    if "sd_px" in table.columns:
        sd[frame, marker] = to_numbers(path, table, "sd_px", missing_allowed=True)
        if np.nanmin(sd, initial=np.inf) <= 0.0:
            raise TrialFault(f"{path.name}, column 'sd_px': is {np.nanmin(sd):g}; expected > 0")
    return xr.Dataset(
        {
            "time": ("frame", frame_time),
            "marker_position": (("frame", "marker", "axis"), position),
            "marker_position_sd": (("frame", "marker"), sd),
        },
        coords={"marker": names, "axis": ["x", "y"]},
    )


def _order_markers(file_name: str, found: list[str], joints: int) -> list[str]:
    links = ["base", *(f"link_{i + 1}" for i in range(joints))]
    unknown = [n for n in found if not MARKER_NAME.match(n) or n.rsplit("_", 1)[0] not in links]
    if unknown:
        raise TrialFault(
            f"{file_name}, column 'marker': {show(unknown[0])} is unknown; a finger of {joints} "
            f"joints has base_1, base_2, link_1_1, … link_{joints}_2"
        )
    ordered = sorted(
        found, key=lambda n: (links.index(n.rsplit("_", 1)[0]), int(n.rsplit("_", 1)[1]))
    )
    for link in links:
        count = sum(n.rsplit("_", 1)[0] == link for n in ordered)
        if count < 2:
            raise TrialFault(
                f"{file_name}: {link} has {count} marker{'s' * (count != 1)}; its direction needs "
                "at least two"
            )
    return ordered


def _refuse_repeats(
    file_name: str, frame: np.ndarray, marker: np.ndarray, names: list[str], time: np.ndarray
) -> None:
    cell = frame * len(names) + marker
    order = np.argsort(cell, kind="stable")
    repeated = np.flatnonzero(np.diff(cell[order]) == 0)
    if repeated.size:
        row = int(order[repeated[0] + 1])
        raise TrialFault(
            f"{file_name}, row {row + 2}: marker '{names[marker[row]]}' appears twice at "
            f"{time[frame[row]]:g} s; each marker may appear once at each time"
        )
