"""Errors that a user can cause and mend: each one is a sentence that says what to do."""

from __future__ import annotations

from collections.abc import Sequence


class Fault(Exception):
    """Base of every error that is the input's and not the program's.

    ``str(fault)`` is one clear sentence that names file, place, value and expectation; the
    command line prints it without a traceback.
    """


class TrialFault(Fault):
    """A recording that cannot be used: its trial is set aside with this reason."""


class Interruption(Fault):
    """Ctrl-C where more than the usual is to be said about it."""


class ListedFault(Fault):
    """A thing that is refused whole, with all of its faults listed at once.

    Examples
    --------
    >>> print(ListedFault("campaign.yaml", ["line 3: a", "line 9: b"]))
    campaign.yaml cannot be used (2 faults):
      - line 3: a
      - line 9: b
    """

    def __init__(self, place: str, faults: Sequence[str]) -> None:
        self.place = place
        self.faults = list(faults)
        count = f"{len(self.faults)} fault{'s' if len(self.faults) != 1 else ''}"
        lines = "".join(f"\n  - {fault}" for fault in self.faults)
        super().__init__(f"{place} cannot be used ({count}):{lines}")


class CampaignFault(ListedFault):
    """A campaign folder that cannot be used at all: nothing is started."""


class ArtifactFault(ListedFault):
    """A file that is not the artifact it is opened or saved as."""
