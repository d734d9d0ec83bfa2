"""Rigid links of markers, which find lost ones."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np

from softfinger.compiled import compiled

_STRETCH = 0.25  # how far a distance on a link may be off, in radii
_ADAPTION = 0.05  # share of a changed distance that is believed, per frame
_SEARCH = 8.0  # radii around the predicted place, growing with the time lost
_LONE_SEARCH = 2.5  # the same for a marker that no other one on its link confirms
_SEARCH_GROWTH, _LONGEST_GROWTH = 0.05, 40  # per frame, and frames


@compiled
def mark_stretched_array(
    position: np.ndarray,
    radius: np.ndarray,
    first: np.ndarray,
    second: np.ndarray,
    distance: np.ndarray,
) -> np.ndarray:
    """Markers (marker,) bool of the pairs at a wrong distance.

    `position` is (marker, 2), `radius` (marker,), all in px, the rest (pair,). A pair of which one
    is not seen is right.
    """
    stretched = np.zeros(position.shape[0], np.bool_)
    for k in range(first.size):
        a, b = first[k], second[k]
        gap = math.hypot(position[a, 0] - position[b, 0], position[a, 1] - position[b, 1])
        if abs(gap - distance[k]) > _STRETCH * max(radius[a], radius[b]):
            stretched[a] = stretched[b] = True
    return stretched


@compiled
def adapt_distances_array(
    position: np.ndarray, first: np.ndarray, second: np.ndarray, distance: np.ndarray
) -> None:
    """Let the distances (pair,) follow slowly, in place."""
    for k in range(first.size):
        a, b = first[k], second[k]
        gap = math.hypot(position[a, 0] - position[b, 0], position[a, 1] - position[b, 1])
        if not math.isnan(gap):
            distance[k] += _ADAPTION * (gap - distance[k])


@dataclass(frozen=True)
class _Search:
    """One picture's search for lost markers."""

    place: np.ndarray
    predicted: np.ndarray
    radius: np.ndarray
    reach: np.ndarray
    discs: np.ndarray

    def measure_away(self, marker: int, disc: int) -> float:
        """Distance from a predicted place, in its reach."""
        return float(_measure_gap(self.discs[disc], self.predicted[marker]) / self.reach[marker])


@dataclass(frozen=True)
class Body:
    """Links of markers at fixed distances, chained by joints.

    Parameters
    ----------
    links : tuple of tuples
        Markers of each link, base first. Without a declared geometry every marker is a link.
    first, second : (pair,)
        All pairs of markers on one link.
    distance : (pair,) [px]
    joint : (link,) [px]
        Distance of the next link's joint beyond a link's last marker; NaN = unknown.
    arm : (marker,) [px]
        Distance of a marker from its own link's proximal joint; NaN = unknown.
    """

    links: tuple[tuple[int, ...], ...]
    first: np.ndarray
    second: np.ndarray
    distance: np.ndarray
    joint: np.ndarray
    arm: np.ndarray

    @classmethod
    def measure(
        cls,
        links: Sequence[Sequence[int]],
        position: np.ndarray,
        joint: np.ndarray | None = None,
        arm: np.ndarray | None = None,
    ) -> Body:
        """Learn distances from one picture's markers (marker, axis) [px]."""
        pairs = [pair for link in links for pair in combinations(link, 2)]
        first, second = np.array(pairs, int).reshape(-1, 2).T.copy()
        return cls(
            links=tuple(tuple(link) for link in links),
            first=first,
            second=second,
            distance=_measure_gap(position[first], position[second]),
            joint=np.full(len(links), np.nan) if joint is None else joint,
            arm=np.full(len(position), np.nan) if arm is None else arm,
        )

    def find_stretched(self, position: np.ndarray, radius: np.ndarray) -> np.ndarray:
        """Markers (marker,) bool at a wrong distance.

        Of two such markers on a link, one or both are false.

        Examples
        --------
        >>> body = Body.measure([[0, 1], [2]], np.array([[0.0, 0.0], [10.0, 0.0], [50.0, 0.0]]))
        >>> moved = np.array([[0.0, 0.0], [0.0, 13.0], [60.0, 9.0]])
        >>> body.find_stretched(moved, np.full(3, 5.0))
        array([ True,  True, False])
        """
        return mark_stretched_array(position, radius, self.first, self.second, self.distance)

    def adapt(self, position: np.ndarray) -> None:
        """Let distances follow lens and slant slowly."""
        adapt_distances_array(position, self.first, self.second, self.distance)

    def recover(
        self,
        position: np.ndarray,
        predicted: np.ndarray,
        radius: np.ndarray,
        lost_for: np.ndarray,
        discs: np.ndarray,
    ) -> dict[int, int]:
        """Find which disc is which lost marker.

        A marker that is not there is left out.

        A disc is taken only where it lies at the known distance from the link's other markers;
        among such choices the one with most markers wins, then the one nearest to where the
        motion and the joint before it expect them. A marker that no other one confirms must be
        near its predicted place.

        Parameters
        ----------
        position, predicted : (marker, 2) [px]
            NaN = lost; where it was expected.
        radius : (marker,) [px]
        lost_for : (marker,)
            Frames since each marker was last seen.
        discs : (disc, 2) [px]
        """
        seen = np.isfinite(position[:, 0])
        gap = _measure_gap(discs[:, None], position[seen][None])
        free = [k for k in range(len(discs)) if not (gap[k] < radius[seen]).any()]
        reach = radius * (1.0 + _SEARCH_GROWTH * np.minimum(lost_for, _LONGEST_GROWTH))
        search = _Search(position.copy(), predicted, radius, reach, discs)
        chosen: dict[int, int] = {}
        for number, link in enumerate(self.links):
            lost = [m for m in link if not seen[m]]
            best = min(self._list_choices(number, lost, free, search), default=(0, 0.0, ()))
            for marker, disc in zip(lost, best[2], strict=False):
                if disc >= 0:
                    chosen[marker] = disc
                    search.place[marker] = discs[disc]
                    free.remove(disc)
        return chosen

    def _list_choices(
        self, number: int, lost: Sequence[int], free: Sequence[int], search: _Search
    ) -> Iterator[tuple[int, float, tuple[int, ...]]]:
        """Choices of lost markers' discs: (−taken, cost, discs)."""
        joint = self._find_joint(number, search.place)
        link = list(self.links[number])
        near = [[d for d in free if search.measure_away(m, d) < _SEARCH] for m in lost]
        for choice in product(*([*ds, -1] for ds in near)):
            taken = {m: d for m, d in zip(lost, choice, strict=True) if d >= 0}
            if not taken or len(set(taken.values())) < len(taken):
                continue
            tried = np.full_like(search.place, np.nan)
            tried[link] = search.place[link]
            cost = 0.0
            for marker, disc in taken.items():
                tried[marker] = search.discs[disc]
                cost += float(np.sum((tried[marker] - search.predicted[marker]) ** 2))
                off = _measure_gap(tried[marker], joint) - self.arm[marker]
                cost += float(np.nan_to_num(off) ** 2)
            alone = np.isfinite(tried[:, 0]).sum() == 1
            if alone and max(search.measure_away(m, d) for m, d in taken.items()) > _LONE_SEARCH:
                continue
            if not self.find_stretched(tried, search.radius).any():
                yield -len(taken), cost, choice

    def _find_joint(self, number: int, place: np.ndarray) -> np.ndarray:
        """A link's proximal joint [px], NaN if unseen."""
        if number == 0:
            return np.full(2, np.nan)
        before = self.links[number - 1]
        along = place[before[-1]] - place[before[0]]
        length = np.hypot(*along)
        if not length > 0.0:
            return np.full(2, np.nan)
        return place[before[-1]] + self.joint[number - 1] * along / length


def _measure_gap(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.hypot(a[..., 0] - b[..., 0], a[..., 1] - b[..., 1])
