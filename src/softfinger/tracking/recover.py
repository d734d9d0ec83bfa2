"""Markers that were lost, found again among the discs of a picture by the finger's geometry."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

_STRETCH = 0.25  # how far a distance on a link may be off, in radii
_FIRST_SEARCH = 8.0  # radii around the predicted place, growing with the time lost


@dataclass(frozen=True)
class Body:
    """What is rigid about the markers: which sit on one link, and how far apart they are.

    ``links`` holds the markers of each link; ``distance (marker, marker) [px]`` is used within
    links only. Without a declared geometry every marker is a link of its own.
    """

    links: tuple[tuple[int, ...], ...]
    distance: np.ndarray

    @classmethod
    def measure(cls, links: Sequence[Sequence[int]], position: np.ndarray) -> Body:
        """Learn the distances from the markers' places in one picture (marker, axis) [px]."""
        distance = np.hypot(*(position[:, None] - position[None]).transpose(2, 0, 1))
        return cls(tuple(tuple(link) for link in links), distance)

    def find_stretched(self, position: np.ndarray, radius: np.ndarray) -> np.ndarray:
        """Markers (marker,) whose distances on their link are wrong, so that one of them is false."""
        wrong = np.zeros(len(position), bool)
        for link in self.links:
            for a, b in _list_pairs(link):
                gap = np.hypot(*(position[a] - position[b])) - self.distance[a, b]
                if abs(gap) > _STRETCH * max(radius[a], radius[b]):
                    wrong[[a, b]] = True
        return wrong


def recover_array(
    body: Body,
    position: np.ndarray,
    predicted: np.ndarray,
    radius: np.ndarray,
    lost_for: np.ndarray,
    discs: np.ndarray,
) -> dict[int, int]:
    """Which disc is which lost marker.

    A disc is taken only where it lies at the known distance from the link's other markers; among
    such choices the one with most markers wins, then the one nearest to the prediction.

    Parameters
    ----------
    body : Body
    position : (marker, 2) [px]
        NaN = lost.
    predicted : (marker, 2) [px]
    radius : (marker,) [px]
    lost_for : (marker,)
        Frames since each marker was last seen.
    discs : (disc, 2) [px]

    Returns
    -------
    dict
        Marker → disc; a marker that is not there is missing.
    """
    seen = np.isfinite(position[:, 0])
    gaps = np.hypot(*(discs[:, None] - position[seen][None]).transpose(2, 0, 1))
    free = [k for k in range(len(discs)) if not (gaps[k] < radius[seen]).any()]
    chosen: dict[int, int] = {}
    for link in body.links:
        lost = [m for m in link if not seen[m]]
        reach = _FIRST_SEARCH * radius * (1.0 + 0.25 * np.minimum(lost_for, 40))
        near = [
            [d for d in free if np.hypot(*(discs[d] - predicted[m])) < reach[m]] + [None]
            for m in lost
        ]
        best = min(
            _list_choices(body, link, lost, near, position, predicted, radius, discs),
            default=None,
        )
        if best is not None:
            for marker, disc in zip(lost, best[2], strict=True):
                if disc >= 0:
                    chosen[marker] = disc
                    free.remove(disc)
    return chosen


def _list_choices(
    body: Body,
    link: Sequence[int],
    lost: Sequence[int],
    near: Sequence[Sequence[int | None]],
    position: np.ndarray,
    predicted: np.ndarray,
    radius: np.ndarray,
    discs: np.ndarray,
) -> Iterator[tuple[int, float, tuple[int, ...]]]:
    for choice in product(*near):
        taken = [d for d in choice if d is not None]
        if not taken or len(set(taken)) < len(taken):
            continue
        place = position.copy()
        far = 0.0
        for marker, disc in zip(lost, choice, strict=True):
            if disc is not None:
                place[marker] = discs[disc]
                far += float(np.sum((discs[disc] - predicted[marker]) ** 2))
        here = np.array([m for m in link if np.isfinite(place[m, 0])])
        if (
            len(here) > 1
            and Body((tuple(here),), body.distance).find_stretched(place, radius).any()
        ):
            continue
        yield -len(taken), far, tuple(-1 if d is None else d for d in choice)


def _list_pairs(link: Sequence[int]) -> Iterator[tuple[int, int]]:
    for i, a in enumerate(link):
        for b in link[i + 1 :]:
            yield a, b
