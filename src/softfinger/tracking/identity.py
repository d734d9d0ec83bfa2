"""Which disc is which marker, by geometry."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

_BEAM = 200
_LARGEST_BEND = 2.6  # rad, between neighbouring links


@dataclass(frozen=True)
class Match:
    """Each marker's disc; how inexact the chain is."""

    disc: tuple[int, ...]
    error: float


def match_finger_array(
    position: np.ndarray,
    places: Mapping[str, Sequence[float]],
    link_length: Sequence[float],
    scale: float,
    tolerance: float,
) -> list[Match]:
    r"""Name discs by a chain of rigid links.

    From the base's discs follow the first joint's place and from every link the next one's;
    a link's discs lie on a ray from its joint at the declared distances. Every choice that stays
    within the tolerance is carried on, the best ones first.

    Parameters
    ----------
    position : (disc, 2) [px]
        Centres found in the picture.
    places : mapping
        ``base``, ``link_1``, … → metres along the link from its proximal joint.
    link_length : (joint,) [m]
        Joint centre to joint centre.
    scale : float [m/px]
    tolerance : float [px]
        How far a disc may be from where the chain puts it.

    Returns
    -------
    list of Match
        Best first; empty where no chain fits. `error` is the rms distance [px].
    """
    beam = [
        (chosen, square, joint)
        for chosen, square, joint in _start(position, places, scale, tolerance)
    ]
    for number, length in enumerate(link_length, start=1):
        offsets = np.asarray(places[f"link_{number}"]) / scale
        longer = [
            (chosen + link, square + more, end)
            for chosen, square, joint in beam
            for link, more, end in _extend(
                position, chosen, joint, offsets, length / scale, tolerance
            )
        ]
        beam = sorted(longer, key=lambda entry: entry[1])[:_BEAM]
    count = sum(len(values) for values in places.values())
    return [Match(chosen, float(np.sqrt(square / count))) for chosen, square, _ in beam]


def _start(
    position: np.ndarray, places: Mapping[str, Sequence[float]], scale: float, tolerance: float
) -> Iterator[tuple[tuple[int, ...], float, np.ndarray]]:
    offsets = np.asarray(places["base"]) / scale
    for chosen, square in _list_rows(position, (), offsets, tolerance):
        origin, direction, _ = _fit_line(position[list(chosen)], offsets)
        yield chosen, square, np.concatenate([origin, direction])


def _extend(
    position: np.ndarray,
    used: tuple[int, ...],
    joint: np.ndarray,
    offsets: np.ndarray,
    length: float,
    tolerance: float,
) -> Iterator[tuple[tuple[int, ...], float, np.ndarray]]:
    for chosen, square in _list_rows(position, used, offsets, tolerance, joint[:2]):
        origin, direction, _ = _fit_line(position[list(chosen)], offsets)
        if joint[2:] @ direction < np.cos(_LARGEST_BEND):
            continue
        gap = float(np.sum((origin - joint[:2]) ** 2))
        yield chosen, square + gap, np.concatenate([origin + length * direction, direction])


def _list_rows(
    position: np.ndarray,
    used: tuple[int, ...],
    offsets: np.ndarray,
    tolerance: float,
    joint: np.ndarray | None = None,
) -> Iterator[tuple[tuple[int, ...], float]]:
    """Choices of discs on a line at given offsets."""
    free = [k for k in range(len(position)) if k not in used]
    if joint is None:
        firsts = free
    else:
        distance = np.hypot(*(position - joint).T)
        firsts = [k for k in free if abs(distance[k] - offsets[0]) < 2 * tolerance]
    for first in firsts:
        distance = np.hypot(*(position - position[first]).T)
        last_gap = offsets[-1] - offsets[0]
        for last in free:
            if last == first or abs(distance[last] - last_gap) > 2 * tolerance:
                continue
            direction = (position[last] - position[first]) / distance[last]
            middle = _pick_middle(position, free, first, direction, offsets, tolerance)
            if middle is None:
                continue
            chosen = (first, *middle, last)
            if len(set(chosen)) == len(chosen):
                origin, _, square = _fit_line(position[list(chosen)], offsets)
                if joint is None or np.hypot(*(origin - joint)) < 3 * tolerance:
                    yield chosen, square


def _pick_middle(
    position: np.ndarray,
    free: list[int],
    first: int,
    direction: np.ndarray,
    offsets: np.ndarray,
    tolerance: float,
) -> tuple[int, ...] | None:
    middle = []
    for offset in offsets[1:-1]:
        expected = position[first] + (offset - offsets[0]) * direction
        distance = np.hypot(*(position[free] - expected).T)
        nearest = int(np.argmin(distance))
        if distance[nearest] > 2 * tolerance:
            return None
        middle.append(free[nearest])
    return tuple(middle)


def _fit_line(points: np.ndarray, offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Joint, direction and squared error of a row."""
    mean, mean_offset = points.mean(axis=0), offsets.mean()
    vector = (offsets - mean_offset) @ (points - mean)
    direction = vector / np.hypot(*vector)
    origin = mean - mean_offset * direction
    residual = points - (origin + offsets[:, None] * direction)
    return origin, direction, float(np.sum(residual**2))
