"""A run's motion: columns, or points of pictures."""

from collections.abc import Sequence

import numpy as np

from softfinger.campaign.units import find_factor
from softfinger.importing.description import ImportDescription, Points
from softfinger.importing.faults import ImportFault
from softfinger.importing.points import Point, find_points
from softfinger.importing.table import RawTable
from softfinger.importing.trials import Run


def find_last(motion: np.ndarray) -> int:
    """Last row (row, column) of numbers, or −1."""
    moved = np.flatnonzero(np.isfinite(motion).any(axis=1))
    return int(moved[-1]) if moved.size else -1


def read_motion(
    run: Run, description: ImportDescription
) -> tuple[RawTable, np.ndarray, tuple[str, ...]]:
    """Read the motion of a run.

    The function returns the table, values (row, column), with their sign and start, and names of
    points.
    """
    asked = description.motion
    if asked.points is not None:
        table, motion, names = _read_points(run, asked.points)
        if names:
            return table, motion, names
    else:
        found = [run.find(column) for column in asked.columns or ()]
        if not found:
            raise ImportFault("motion: name its columns or its points")
        table = found[0][0]
        if any(other is not table for other, _ in found):
            raise ImportFault("motion.columns: they are of several files; name columns of one")
        unit = asked.unit or "1"
        motion = np.column_stack([table.read(name, unit) for _, name in found])
        if asked.quantity == "angle":
            motion = motion * find_factor(unit, "rad")
    if asked.start == "first row":
        first = np.isfinite(motion).argmax(axis=0)
        motion = motion - motion[first, np.arange(motion.shape[1])]
    return table, motion * (asked.sign or 1), ()


def _read_points(run: Run, asked: Points) -> tuple[RawTable, np.ndarray, tuple[str, ...]]:
    holders = [(t, find_points(t.columns)) for t in run.tables.values()]
    table, known = max(holders, key=lambda holder: len(holder[1]))
    by_name = {point.name: point for point in known}
    names = asked.names or tuple(by_name)
    unknown = [name for name in names if name not in by_name]
    if unknown:
        raise ImportFault(
            f"trial {run.name}: there is no point '{unknown[0]}'; there are {', '.join(by_name)}"
        )
    points = [by_name[name] for name in names]
    axes = choose_plane(table, points)
    place = np.stack([read_point(table, point, asked, axes) for point in points], axis=1)
    if asked.up == "y":
        place = place * np.array([1.0, -1.0])
    if asked.read_as == "markers":
        return table, place.reshape(len(place), -1), tuple(names)
    read = {"bending": _bend, "direction": _turn, "displacement": _move}[asked.read_as or "bending"]
    return table, read(place)[:, None], ()


def choose_plane(table: RawTable, points: Sequence[Point]) -> str:
    """Axes of the plane in which points move.

    It is ``xy`` unless a third coordinate varies more than one of these: it takes that one's place.
    """
    if not all(point.z for point in points):
        return "xy"
    spread = {
        axis: max(np.nanstd(table.read_leniently(getattr(point, axis))) for point in points)
        for axis in "xyz"
    }
    least = min(spread, key=lambda axis: spread[axis])
    return "xy" if least == "z" or spread["z"] <= spread[least] else "xyz".replace(least, "")


def read_point(table: RawTable, point: Point, asked: Points, axes: str = "xy") -> np.ndarray:
    """Places (row, 2) of a point, NaN if lost."""
    place = np.column_stack([table.read(getattr(point, axis)) for axis in axes])
    lost = ~np.isfinite(place).all(axis=1)
    if asked.lost == "zero":
        lost |= (place == 0.0).all(axis=1)
    if asked.least_trust is not None and point.trust:
        lost |= ~(table.read(point.trust) >= asked.least_trust)
    place[lost] = np.nan
    return place


def _bend(place: np.ndarray) -> np.ndarray:
    """Bending [rad] of a chain of points.

    It is the direction of the last segment against the first, counter-clockwise.
    """
    return _unwrap(_direction(place[:, -2], place[:, -1]) - _direction(place[:, 0], place[:, 1]))


def _turn(place: np.ndarray) -> np.ndarray:
    """Direction [rad] from first to last point."""
    angle = _unwrap(_direction(place[:, 0], place[:, -1]))
    return angle - angle[np.isfinite(angle).argmax()]


def _move(place: np.ndarray) -> np.ndarray:
    """Displacement of the last point, along most motion."""
    path = place[:, -1]
    seen = np.isfinite(path).all(axis=1)
    first = path[seen][0]
    axis = np.linalg.svd(path[seen] - path[seen].mean(axis=0), full_matrices=False)[2][0]
    return (path - first) @ axis


def _direction(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    delta = end - start
    return np.arctan2(-delta[:, 1], delta[:, 0])


def _unwrap(angle: np.ndarray) -> np.ndarray:
    seen = np.isfinite(angle)
    whole = angle.copy()
    whole[seen] = np.unwrap(angle[seen])
    turns = np.round(np.median(whole[seen]) / (2 * np.pi)) if seen.any() else 0.0
    return whole - 2 * np.pi * turns
