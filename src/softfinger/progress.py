"""Progress bars: seen on a terminal, silent elsewhere."""

import os
from collections.abc import Callable, Iterable, Iterator, Sized
from contextlib import contextmanager

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

QUIET = "SOFTFINGER_QUIET"
"""Variable of the environment that silences the bars, in the jobs of a workflow as well."""


def silence_progress() -> None:
    """Show no more bars in this and child processes."""
    os.environ[QUIET] = "1"


def track_progress[Item](
    items: Iterable[Item], description: str, total: int | None = None
) -> Iterator[Item]:
    """Yield the items of a loop behind a bar.

    Parameters
    ----------
    description : str
        A verb and its object, as in "tracking trials".
    total : int, optional
        Number of items, where ``items`` has no length of its own.

    Examples
    --------
    >>> list(track_progress([3, 4], "counting"))
    [3, 4]
    """
    if total is None and isinstance(items, Sized):
        total = len(items)
    with _open_bar() as bar:
        yield from bar.track(items, total=total, description=description)


@contextmanager
def follow_progress(description: str, total: int) -> Iterator[Callable[[int], None]]:
    """A progress bar's function of steps, thread-safe."""
    with _open_bar() as bar:
        task = bar.add_task(description, total=total)
        yield lambda done: bar.update(task, completed=done)


def _open_bar() -> Progress:
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    silent = QUIET in os.environ or not console.is_terminal
    return Progress(*columns, console=console, transient=True, disable=silent)
