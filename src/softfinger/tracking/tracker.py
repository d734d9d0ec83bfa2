"""Follow markers from one picture to the next."""

from dataclasses import dataclass, field

import numpy as np

from softfinger.tracking.body import Body
from softfinger.tracking.detection import find_discs_array
from softfinger.tracking.disc import CONTRAST, RADIUS, X
from softfinger.tracking.fit import FIT_QUALITY
from softfinger.tracking.follow import follow_discs_array


@dataclass
class Tracker:
    """What is known of each marker.

    Parameters
    ----------
    weight : (channel,)
        Light = Σ weight · channel.
    known : (marker, 8)
        How each marker looked when it was last seen.
    body : Body
        What is rigid about them.
    margin : (marker,) [px]
        Width of the background that each one is fitted with.
    """

    weight: np.ndarray
    known: np.ndarray
    body: Body
    margin: np.ndarray
    velocity: np.ndarray = field(init=False)
    lost_for: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        """Start at rest, with every marker seen."""
        self.velocity = np.zeros((len(self.known), 2))
        self.lost_for = np.zeros(len(self.known), int)

    def follow(self, picture: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Find every marker in the next picture.

        The picture is (row, column, channel).

        Returns
        -------
        fitted (marker, 8), quality (marker, 5)
            NaN where a marker is not seen.
        """
        fitted = np.full_like(self.known, np.nan)
        quality = np.full((len(self.known), len(FIT_QUALITY)), np.nan)
        predicted = self.known[:, :2] + self.velocity
        self._fit(picture, self.lost_for == 0, predicted, fitted, quality)
        if np.isnan(fitted[:, X]).any():
            self._recover(picture, predicted, fitted, quality)
        seen = np.isfinite(fitted[:, X])
        fresh = seen & (self.lost_for == 0)
        self.velocity = np.where(fresh[:, None], fitted[:, :2] - self.known[:, :2], 0.0)
        self.known[seen] = fitted[seen]
        self.body.adapt(fitted[:, :2])
        self.lost_for = np.where(seen, 0, self.lost_for + 1)
        return fitted, quality

    def _fit(
        self,
        picture: np.ndarray,
        wanted: np.ndarray,
        predicted: np.ndarray,
        fitted: np.ndarray,
        quality: np.ndarray,
    ) -> None:
        """Fit the wanted markers, without those off distance."""
        follow_discs_array(
            picture, self.weight, self.known, self.margin, wanted, predicted, fitted, quality
        )
        stretched = self.body.find_stretched(fitted[:, :2], self.known[:, RADIUS])
        if stretched.any():
            fitted[stretched], quality[stretched] = np.nan, np.nan

    def _recover(
        self, picture: np.ndarray, predicted: np.ndarray, fitted: np.ndarray, quality: np.ndarray
    ) -> None:
        radius = self.known[:, RADIUS]
        polarity = int(np.sign(np.median(self.known[:, CONTRAST])))
        discs = find_discs_array(picture, self.weight, float(np.median(radius)), polarity)
        chosen = self.body.recover(fitted[:, :2], predicted, radius, self.lost_for, discs[:, :2])
        wanted = np.zeros(len(self.known), bool)
        for marker, disc in chosen.items():
            wanted[marker] = True
            predicted[marker] = discs[disc, :2]
        self._fit(picture, wanted, predicted, fitted, quality)
