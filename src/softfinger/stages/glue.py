"""The few lines between a Snakemake job and a stage: names, log, and faults as sentences."""

from __future__ import annotations

import contextlib
import sys
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol

from softfinger.faults import Fault


class Job(Protocol):
    """What a Snakemake job gives to its script: named lists and a log file."""

    input: Any
    output: Any
    params: Any
    log: Sequence[str]


def end_quietly(kind: type[BaseException], error: BaseException, trace: TracebackType) -> None:
    """Print what ended a program, but for Ctrl-C: Snakemake says that once, for all its jobs."""
    if not issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, trace)


sys.excepthook = end_quietly


def run_stage(stage: Callable[..., None], job: Job) -> None:
    """Call a stage with a job's named inputs, outputs and parameters; what it says goes to the log.

    The parameter ``code`` makes Snakemake rerun a job whose library code has changed; the stage
    itself does not need it. A fault is printed as its sentence and ends the job with status 1.
    """
    arguments = {**_named(job.input), **_named(job.output), **_named(job.params)}
    arguments.pop("code", None)
    log = Path(job.log[0])
    with (
        log.open("w", encoding="utf-8") as stream,
        contextlib.redirect_stdout(stream),
        contextlib.redirect_stderr(stream),
    ):
        try:
            stage(**arguments)
        except Fault as fault:
            print(fault, file=stream)
            sys.exit(1)
        except Exception:
            traceback.print_exc(file=stream)
            raise


def _named(items: Any) -> dict[str, Any]:  # noqa: ANN401 (Snakemake's own list with names)
    plain = {}
    for name, value in items.items():
        several = not isinstance(value, str) and isinstance(value, Sequence)
        plain[name] = list(value) if several else value
    return plain
