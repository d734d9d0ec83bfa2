"""Orientations that are logged as quaternions."""

import re
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from softfinger.importing.table import RawTable

COMPONENT = re.compile(r"(?i)^(?P<stem>.*?)[ _.\-]?(?P<axis>[wxyz0123])$")
ORDERS = ("xyzw", "xyz0", "1230")  # the scalar last
LENGTH = 0.02  # by which a unit quaternion's length may err
MOSTLY = 0.9  # of the rows are unit quaternions


def turn_quaternions(table: RawTable) -> RawTable:
    """Replace the four columns of a quaternion by how far it turns.

    That is the rotation from the first orientation about the axis about which most of it is, in
    rad: a component alone is no angle.
    """
    stems: dict[str, dict[str, str]] = {}
    for column in table.columns:
        if found := COMPONENT.match(column):
            stems.setdefault(found["stem"], {})[found["axis"].lower()] = column
    for stem, members in stems.items():
        order = next((order for order in ORDERS if set(order) <= set(members)), None)
        if order is None:
            continue
        columns = [members[axis] for axis in order]
        values = np.column_stack([table.read_leniently(column) for column in columns])
        if not _are_units(values):
            continue
        name = f"{stem} rotation".strip(" _.-")
        cells = table.cells.drop(columns=columns).assign(**{name: turn_array(values)})
        said = f"'{', '.join(columns)}' are a quaternion, read as the angle '{name}'"
        unit = {c: u for c, u in table.unit.items() if c not in columns} | {name: "rad"}
        group = {c: g for c, g in table.group.items() if c not in columns}
        dropped = (*table.dropped, said)
        table = replace(table, cells=cells, unit=unit, group=group, dropped=dropped)
    return table


def _are_units(values: np.ndarray) -> bool:
    seen = values[np.isfinite(values).all(axis=1)]
    if len(seen) < 2:
        return False
    return bool((abs(np.linalg.norm(seen, axis=1) - 1.0) < LENGTH).mean() >= MOSTLY)


def turn_array(quaternion: np.ndarray) -> np.ndarray:
    """Angle [rad] (row,) from the first orientation.

    Quaternions are (row, 4), the scalar last.

    >>> half = np.deg2rad([0.0, 15.0, 30.0, 45.0])
    >>> angle = turn_array(np.array([0 * half, np.sin(half), 0 * half, np.cos(half)]).T)
    >>> [abs(round(degrees)) for degrees in np.rad2deg(angle)]
    [0, 30, 60, 90]
    """
    angle = np.full(len(quaternion), np.nan)
    seen = np.isfinite(quaternion).all(axis=1) & (np.linalg.norm(quaternion, axis=1) > 0.5)
    turned = Rotation.from_quat(quaternion[seen])
    vector = (turned[0].inv() * turned).as_rotvec()
    axis = np.linalg.svd(vector, full_matrices=False)[2][0]
    along = np.unwrap(vector @ axis)
    angle[seen] = along if along.sum() >= 0.0 else -along
    return angle
