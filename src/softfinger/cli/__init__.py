"""The command line, with one verb per stage.

Other verbs go before and around the stages.
"""

import os
import sys

INTERRUPTED = 130  # what shells expect of a program that Ctrl-C ended
SAID = "interrupted; what was finished is kept, what was begun is not"

try:
    from softfinger.cli import (
        campaign,
        demo,
        diagnose,
        effects,
        importing,
        join,
        loop,
        new,
        next,
        recordings,
        results,
        rig,
    )
    from softfinger.cli.application import app
    from softfinger.failure import describe_failure
    from softfinger.faults import Interruption
except KeyboardInterrupt:  # before there was a command line
    print(f"softfinger: {SAID}", file=sys.stderr)
    raise SystemExit(INTERRUPTED) from None

# Each adds its verbs. Only named here, so that the hash of one verb's code has no other verb in it.
__all__ = [
    "app",
    "campaign",
    "demo",
    "diagnose",
    "effects",
    "importing",
    "join",
    "loop",
    "main",
    "new",
    "next",
    "recordings",
    "results",
    "rig",
]


def main() -> None:
    """Run the command line.

    Whatever ends it is one sentence, never a traceback: exit status 1, and 130 after Ctrl-C.
    """
    try:
        try:
            app()
        finally:
            sys.stdout.flush()
    except KeyboardInterrupt as interruption:
        _end(str(interruption) or SAID, INTERRUPTED)
    except Interruption as fault:
        _end(str(fault), INTERRUPTED)
    except Exception as error:
        _end(describe_failure(error), 1)
    except SystemExit as end:  # typer's own way of passing Ctrl-C on
        if end.code == INTERRUPTED:
            _end(SAID, INTERRUPTED)
        raise


def _end(said: str, status: int) -> None:
    print(f"softfinger: {said}", file=sys.stderr)
    try:
        sys.stdout.flush()
    except OSError:  # a full output, on which the interpreter would fail once more
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(status)
