"""What is rigid about the markers, and lost ones found again by it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np

_STRETCH = 0.25  # how far a distance on a link may be off, in radii
_SEARCH = 8.0  # radii around the predicted place, growing with the time lost
_SEARCH_GROWTH, _LONGEST_GROWTH = 0.25, 40  # per frame, and frames


@dataclass(frozen=True)
class Body:
    """Links of markers that keep their distances, chained by joints.

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
        """Learn the distances from the markers' places in one picture (marker, axis) [px]."""
        pairs = [pair for link in links for pair in combinations(link, 2)]
        first, second = np.array(pairs, int).reshape(-1, 2).T
        return cls(
            links=tuple(tuple(link) for link in links),
            first=first,
            second=second,
            distance=_measure_gap(position[first], position[second]),
            joint=np.full(len(links), np.nan) if joint is None else joint,
            arm=np.full(len(position), np.nan) if arm is None else arm,
        )

    def find_stretched(self, position: np.ndarray, radius: np.ndarray) -> np.ndarray:
        """Markers (marker,) bool at a wrong distance from one on their link: one of both is false.

        Examples
        --------
        >>> body = Body.measure([[0, 1], [2]], np.array([[0.0, 0.0], [10.0, 0.0], [50.0, 0.0]]))
        >>> moved = np.array([[0.0, 0.0], [0.0, 13.0], [60.0, 9.0]])
        >>> body.find_stretched(moved, np.full(3, 5.0))
        array([ True,  True, False])
        """
        off = np.abs(_measure_gap(position[self.first], position[self.second]) - self.distance)
        wrong = off > _STRETCH * np.maximum(radius[self.first], radius[self.second])
        stretched = np.zeros(len(position), bool)
        stretched[self.first[wrong]] = True
        stretched[self.second[wrong]] = True
        return stretched

    def recover(
        self,
        position: np.ndarray,
        predicted: np.ndarray,
        radius: np.ndarray,
        lost_for: np.ndarray,
        discs: np.ndarray,
    ) -> dict[int, int]:
        """Which disc is which lost marker; a marker that is not there is left out.

        A disc is taken only where it lies at the known distance from the link's other markers;
        among such choices the one with most markers wins, then the one nearest to where the
        motion and the joint before it expect them.

        Parameters
        ----------
        position, predicted : (marker, 2) [px]
            NaN = lost; where it was expected.
        radius : (marker,) [px]
        lost_for : (marker,)
            Frames since each marker was last seen.
        discs : (disc, 2) [px]
        """
        place = position.copy()
        seen = np.isfinite(position[:, 0])
        gap = _measure_gap(discs[:, None], position[seen][None])
        free = [k for k in range(len(discs)) if not (gap[k] < radius[seen]).any()]
        growth = 1.0 + _SEARCH_GROWTH * np.minimum(lost_for, _LONGEST_GROWTH)
        reach = _SEARCH * radius * growth
        chosen: dict[int, int] = {}
        for number, link in enumerate(self.links):
            lost = [m for m in link if not seen[m]]
            near = [
                [d for d in free if _measure_gap(discs[d], predicted[m]) < reach[m]] + [-1]
                for m in lost
            ]
            best = min(
                self._list_choices(number, lost, near, place, predicted, radius, discs),
                default=(0, 0.0, ()),
            )
            for marker, disc in zip(lost, best[2], strict=False):
                if disc >= 0:
                    chosen[marker] = disc
                    place[marker] = discs[disc]
                    free.remove(disc)
        return chosen

    def _list_choices(
        self,
        number: int,
        lost: Sequence[int],
        near: Sequence[Sequence[int]],
        place: np.ndarray,
        predicted: np.ndarray,
        radius: np.ndarray,
        discs: np.ndarray,
    ) -> Iterator[tuple[int, float, tuple[int, ...]]]:
        """Choices of discs (−1 = none) for a link's lost markers: (−number taken, cost, discs)."""
        joint = self._find_joint(number, place)
        for choice in product(*near):
            taken = [d for d in choice if d >= 0]
            if not taken or len(set(taken)) < len(taken):
                continue
            tried = np.full_like(place, np.nan)
            link = list(self.links[number])
            tried[link] = place[link]
            cost = 0.0
            for marker, disc in zip(lost, choice, strict=True):
                if disc >= 0:
                    tried[marker] = discs[disc]
                    cost += float(np.sum((discs[disc] - predicted[marker]) ** 2))
                    off = _measure_gap(discs[disc], joint) - self.arm[marker]
                    cost += float(np.nan_to_num(off) ** 2)
            if not self.find_stretched(tried, radius).any():
                yield -len(taken), cost, tuple(choice)

    def _find_joint(self, number: int, place: np.ndarray) -> np.ndarray:
        """Proximal joint of a link [px], from the link before; NaN where that is not seen."""
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
