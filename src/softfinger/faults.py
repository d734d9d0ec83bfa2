"""Errors that a user can cause and mend."""

from collections.abc import Sequence

MOST_LISTED = 100


class Fault(Exception):
    """Base of every error that the input causes.

    ``str(fault)`` is one clear sentence that names file, place, value and expectation; the
    command line prints it without a traceback. Characters of the input that cannot be printed, or
    stored in an artifact, are written as escapes.
    """

    def __init__(self, said: object = "") -> None:
        super().__init__("\n".join(make_printable(line) for line in str(said).split("\n")))


class TrialFault(Fault):
    """Why a recording's trial is set aside."""


class Interruption(Fault):
    """Ctrl-C with a message of its own."""


class ListedFault(Fault):
    """A refusal that lists all faults at once.

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
        listed = self.faults[:MOST_LISTED]
        if len(self.faults) > MOST_LISTED:
            listed.append(f"and {len(self.faults) - MOST_LISTED} others")
        lines = "".join(f"\n  - {fault}" for fault in listed)
        super().__init__(f"{place} cannot be used ({count}):{lines}")


class CampaignFault(ListedFault):
    """A campaign folder that cannot be used."""


class ArtifactFault(ListedFault):
    """A file that is not the expected artifact."""


def make_printable(text: str) -> str:
    r"""Text with what cannot be printed as escapes.

    >>> make_printable("a\0b")
    'a\\x00b'
    """
    if text.isprintable():
        return text
    return "".join(
        sign if sign.isprintable() else sign.encode("unicode_escape").decode("ascii")
        for sign in text
    )


def show(text: str, longest: int = 60) -> str:
    """A piece of foreign text, quoted, printable and short.

    >>> show("a" * 9, longest=5)
    "'aaaaa…'"
    """
    short = text if len(text) <= longest else text[:longest] + "…"
    return f"'{make_printable(short)}'"


def list_briefly(names: Sequence[str], most: int = 8) -> str:
    """The first few names and the others' number.

    >>> list_briefly(["a", "b", "c", "d"], most=2)
    'a, b and 2 others'
    """
    shown, others = names[:most], len(names) - most
    ending = f" and {others} other{'s' * (others != 1)}" if others > 0 else ""
    return ", ".join(shown) + ending
