"""A limit of time for the search of sets of effects.

The best answer so far is then the answer, and the verdict warns of it.
"""

from collections.abc import Iterable, Iterator
from time import monotonic

from softfinger.mismatch.candidates.rank import Progress


class Patience:
    """Loops that end early once a time is over; each does at least its first item.

    >>> hurried = Patience(0.0, lambda items, _: items)
    >>> list(hurried([3, 4, 5], "counting")), hurried.was_lost
    ([3], True)
    """

    def __init__(self, seconds: float, progress: Progress) -> None:
        self._end = monotonic() + seconds
        self._progress = progress
        self.was_lost = False

    def __call__(self, items: Iterable, description: str) -> Iterator:
        """Go through the items while there is time."""
        for number, item in enumerate(self._progress(items, description)):
            if number > 0 and monotonic() > self._end:
                self.was_lost = True
                return
            yield item
