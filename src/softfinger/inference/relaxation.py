"""Repeated changes, each of which takes about the last one back."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.budget import BUDGET


class Relaxation(NamedTuple):
    """How much of a wanted change may be taken.

    Attributes
    ----------
    most
        Largest fraction of the next change.
    wanted, fraction
        The last change that was wanted, and the fraction of it that was taken.
    count
        Changes so far.
    """

    most: float = 1.0
    wanted: NDArray[np.float64] | None = None
    fraction: float = 1.0
    count: int = 0

    def limit(self, now: NDArray[np.float64]) -> float:
        """Fraction of a wanted change that comes to rest.

        Near its end a wanted change s leaves (1 − c f) s when a fraction f of it is taken: c > 1
        overshoots, and 1/c of the next is right. The fraction grows again, but slower
        with each change: where c itself changes, a fraction that grew freely would never settle.

        >>> Relaxation().take(1.0, np.array([1.0]), 1.0).limit(np.array([-0.9])).round(3)
        np.float64(0.526)
        """
        if self.wanted is None:
            return 1.0
        left = self.wanted @ now / max(self.wanted @ self.wanted, 1e-300)
        right = self.fraction / max(1.0 - left, 1e-300)
        return np.clip(min(right, (1 + 1 / self.count) * self.most), BUDGET.least_fraction, 1.0)

    def take(self, most: float, wanted: NDArray[np.float64], fraction: float) -> "Relaxation":
        """Remember a change, its fraction taken, `most` allowed."""
        return Relaxation(most, wanted, fraction, self.count + 1)
