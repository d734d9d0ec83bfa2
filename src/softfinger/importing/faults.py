"""Errors of an import: place, and what to type."""

from softfinger.faults import Fault, ListedFault


class ImportFault(Fault):
    """Recordings that cannot be read as asked."""


class ImportFaults(ListedFault):
    """All that is wrong with an import, at once."""
