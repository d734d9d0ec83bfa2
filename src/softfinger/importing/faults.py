"""Errors of an import.

They give file, sheet, row and column, and what to type instead.
"""

from softfinger.faults import Fault, ListedFault


class ImportFault(Fault):
    """Recordings that cannot be read as asked."""


class ImportFaults(ListedFault):
    """All that is wrong with an import, at once."""
