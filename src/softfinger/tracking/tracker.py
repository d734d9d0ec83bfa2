"""Follow markers from one picture to the next."""

from dataclasses import dataclass, field

import numpy as np

from softfinger.tracking.body import Body
from softfinger.tracking.detection import find_discs_array
from softfinger.tracking.disc import CONTRAST, RADIUS
from softfinger.tracking.fit import FIT_QUALITY
from softfinger.tracking.follow import (
    drop_stretched_array,
    follow_discs_array,
    follow_markers_array,
    settle_markers_array,
)


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
        fitted, predicted = np.empty_like(self.known), np.empty((len(self.known), 2))
        quality = np.empty((len(self.known), len(FIT_QUALITY)))
        pairs = (self.body.first, self.body.second, self.body.distance)
        moving = (self.velocity, self.lost_for)
        if not follow_markers_array(
            picture, self.weight, self.known, self.margin, *moving, *pairs, predicted, fitted,
            quality,
        ):  # fmt: skip
            self._recover(picture, predicted, fitted, quality)
            settle_markers_array(self.known, *moving, *pairs, fitted)
        return fitted, quality

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
        follow_discs_array(
            picture, self.weight, self.known, self.margin, wanted, predicted, fitted, quality
        )
        pairs = (self.body.first, self.body.second, self.body.distance)
        drop_stretched_array(*pairs, self.known, fitted, quality)
