"""Columns that are coordinates of points."""

import re
from collections.abc import Iterable
from dataclasses import dataclass

from softfinger.importing.vocabulary import score_words

PATTERNS = (
    re.compile(
        r"(?P<p>.*?)[ _.:/-]*(?:position|pos|center|centre|tvec|translation)?[ _.]*(?P<a>[xyz])$"
    ),
    re.compile(r"(?P<p>.*?)[ _.:/-]*c(?P<a>[xy])$"),
    re.compile(r"(?P<p>[^\W\d_]*\d*[ _]?[A-Za-z]?)(?P<a>[xyz])(?P<q>\d+)$"),
    re.compile(r"(?P<p>.*?)[ _.:-](?P<a>[xyz])[ _.:-](?P<q>.+)$"),
    re.compile(r"(?P<a>[xyz])[ _.:-]*(?P<q>.+)$"),
)
TRUST = re.compile(
    r"(?P<p>.*?)[ _.:/-]*(?:instance[ _.])?"
    r"(likelihood|score|confidence|conf|prob|probability|visibility)$"
)
NAMELESS = "point"
NOT_PLACES = (
    "force torque moment vel velocity speed acc accel acceleration gyro imu orientation angular "
    "mag gravity quaternion rotation rvec rotvec std sd error uv"
)
LEFT, RIGHT = ("l", "left", "cam1", "camera1"), ("r", "right", "cam2", "camera2")


@dataclass(frozen=True)
class Point:
    """A point, by the columns of its coordinates."""

    name: str
    x: str
    y: str
    z: str = ""
    trust: str = ""


def find_points(columns: Iterable[str]) -> list[Point]:
    """Points among columns, in the columns' order.

    A point counts where both its x and its y are logged under names of one pattern.

    >>> [p.name for p in find_points(["time", "nose x", "nose y", "tip_x", "tip_y", "max"])]
    ['nose', 'tip']
    >>> find_points(["tagid_x_101", "tagid_y_101"])[0].name, find_points(["Lx1", "Ly1"])[0].name
    ('tagid 101', 'L1')
    """
    columns = [column for column in columns if score_words(column, NOT_PLACES) < 2.0]
    places: dict[str, dict[str, str]] = {}
    for pattern in PATTERNS:
        taken = {column for axes in places.values() for column in axes.values()}
        found: dict[str, dict[str, str]] = {}
        for column in columns:
            match = None if column in taken else pattern.match(column.strip().lower())
            if match:
                name = _name(column, match)
                found.setdefault(name, {}).setdefault(match["a"], column)
        places |= {
            n: axes for n, axes in found.items() if {"x", "y"} <= set(axes) and n not in places
        }
    order = {column: i for i, column in enumerate(columns)}
    trust = {m["p"].strip(): c for c in columns if (m := TRUST.match(c.strip().lower()))}
    points = [
        Point(
            name or NAMELESS, axes["x"], axes["y"], axes.get("z", ""), trust.get(name.lower(), "")
        )
        for name, axes in places.items()
    ]
    return sorted(points, key=lambda point: order[point.x])


def _name(column: str, match: re.Match) -> str:
    parts = [match.groupdict().get(key) for key in ("p", "q")]
    spans = [match.span(key) for key in ("p", "q") if match.groupdict().get(key)]
    whole = [column.strip()[a:b].strip(" _.:/-") for a, b in spans]
    joint = "" if match.re is PATTERNS[2] else " "
    return joint.join(part for part in whole if part) if any(parts) else ""


def list_point_columns(columns: Iterable[str]) -> set[str]:
    """Columns of points, as ``3 speed`` beside ``3 x``."""
    columns = list(columns)
    points = find_points(columns)
    owned = {c for point in points for c in (point.x, point.y, point.z, point.trust) if c}
    names = tuple(f"{point.name} " for point in points if point.name != NAMELESS)
    return owned | {column for column in columns if names and column.startswith(names)}


def choose_camera(points: list[Point]) -> tuple[list[Point], list[Point]]:
    """Points of the first of two cameras.

    Both cameras see the same points. Those of the other are returned too.

    >>> first, other = choose_camera(find_points(["Lx1", "Ly1", "Rx1", "Ry1"]))
    >>> [p.name for p in first], [p.name for p in other]
    (['L1'], ['R1'])
    """
    sides: dict[int, list[Point]] = {0: [], 1: []}
    rest: dict[int, list[str]] = {0: [], 1: []}
    for point in points:
        found = re.search(r"(?:^|[ _.])(left|right|l|r|cam(?:era)?[ _]?[12])[ _.]?(\d*)$|"
                          r"(?:^|[ _.])(l|r)(\d+)$", point.name.lower())  # fmt: skip
        word = (found[1] or found[3] or "").replace(" ", "").replace("_", "") if found else ""
        side = 0 if word in LEFT else 1 if word in RIGHT else None
        if side is None or found is None:
            return points, []
        sides[side].append(point)
        rest[side].append(point.name.lower()[: found.start()] + (found[2] or found[4] or ""))
    if sides[0] and all(rest[0]) and sorted(rest[0]) == sorted(rest[1]):
        return sides[0], sides[1]
    return points, []
