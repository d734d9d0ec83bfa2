"""The command line: one verb per stage, and what goes before and around them."""

import sys

from softfinger.cli import campaign, recordings, results, rig
from softfinger.cli.application import app
from softfinger.faults import Fault

__all__ = ["app", "campaign", "main", "recordings", "results", "rig"]


def main() -> None:
    """Run the command line; a fault of the input is one sentence and exit status 1."""
    try:
        app()
    except Fault as fault:
        print(f"softfinger: {fault}", file=sys.stderr)
        sys.exit(1)
