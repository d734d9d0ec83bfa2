"""trackpy's refinement in windows that follow.

It is the best of its kind: the centre of mass of Crocker and Grier, compiled, which two decades of
microscopy have tuned. It starts from where the discs were, so that nothing is searched for, and
refines all discs in one compiled call on a picture whose flat parts are clipped away,
at the share with the smallest error on the very pictures that are rated.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray
from trackpy.refine.center_of_mass import refine_com_arr

MARGIN = 4  # pixels of background around the largest disc


class TrackpyWindows:
    """What is known of the discs before the first picture."""

    def __init__(
        self, places: NDArray, radii: NDArray, level: float, contrast: float, clipped: float
    ) -> None:
        """Start at known places (disc, 2), with known radii (disc,), level and contrast.

        The share `clipped` of the contrast is cut on either side.
        """
        self.places = places[:, ::-1].copy()
        self.radius = int(np.ceil(radii.max())) + MARGIN
        self.dark_from = float(level + clipped * contrast)
        self.most = float(-contrast * (1.0 - 2.0 * clipped))

    def follow(self, picture: NDArray[np.uint8]) -> NDArray[np.float64]:
        """Places (disc, 2) in the next picture."""
        share = cv2.min(cv2.subtract(self.dark_from, picture), self.most)
        found = refine_com_arr(
            share, share, self.radius, self.places, max_iterations=3, engine="numba",
            characterize=False,
        )  # fmt: skip
        self.places = found[:, :2]
        return self.places[:, ::-1].copy()
