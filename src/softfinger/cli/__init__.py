"""The command line: one verb per stage, and what goes before and around them."""

import sys

from softfinger.cli import campaign, recordings, results, rig
from softfinger.cli.application import app
from softfinger.faults import Fault, Interruption

__all__ = ["app", "campaign", "main", "recordings", "results", "rig"]

INTERRUPTED = 130  # what shells expect of a program that Ctrl-C ended


def main() -> None:
    """Run the command line.

    A fault of the input is one sentence and exit status 1, Ctrl-C one sentence and exit status 130.
    """
    try:
        app()
    except Interruption as fault:
        print(f"softfinger: {fault}", file=sys.stderr)
        sys.exit(INTERRUPTED)
    except Fault as fault:
        print(f"softfinger: {fault}", file=sys.stderr)
        sys.exit(1)
    except SystemExit as end:  # typer's own way of passing Ctrl-C on
        if end.code == INTERRUPTED:
            said = "interrupted; what was finished is kept, what was begun is not"
            print(f"softfinger: {said}", file=sys.stderr)
        raise
