"""Glue between a Snakemake job and a stage."""

import contextlib
import inspect
import signal
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol

from softfinger.failure import describe_failure


class Job(Protocol):
    """A job's named lists, log and cores."""

    input: Any
    output: Any
    params: Any
    log: Sequence[str]
    threads: int


def end_quietly(kind: type[BaseException], error: BaseException, trace: TracebackType) -> None:
    """Print what ended a program, but for Ctrl-C."""
    if not issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, trace)


sys.excepthook = end_quietly
# What ends a job from outside lets it remove what it has half written.
signal.signal(signal.SIGTERM, signal.default_int_handler)


def run_stage(stage: Callable[..., None], job: Job) -> None:
    """Call a stage with a job's inputs and outputs.

    The job's parameters are given too, all by name. What the stage prints goes to the log.

    The parameters ``code``, ``environment`` and ``settings`` make Snakemake rerun a job whose code,
    libraries or defaults have changed; the stage itself does not need them. A stage that takes
    ``cores`` gets the job's threads, which are no parameter: another number reruns nothing.
    Whatever ends it is one sentence in the log, and exit status 1.
    """
    arguments = {**_named(job.input), **_named(job.output), **_named(job.params)}
    for name in ("code", "environment", "settings"):
        arguments.pop(name, None)
    if "cores" in inspect.signature(stage).parameters:
        arguments["cores"] = job.threads
    log = Path(job.log[0])
    with (
        log.open("w", encoding="utf-8") as stream,
        contextlib.redirect_stdout(stream),
        contextlib.redirect_stderr(stream),
    ):
        try:
            stage(**arguments)
        except Exception as error:
            print(describe_failure(error), file=stream)
            sys.exit(1)


def _named(items: Any) -> dict[str, Any]:  # noqa: ANN401 (Snakemake's own list with names)
    plain = {}
    for name, value in items.items():
        several = not isinstance(value, str) and isinstance(value, Sequence)
        plain[name] = list(value) if several else value
    return plain
