"""Progress bars: seen on a terminal, silent elsewhere."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sized

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

_quiet = False


def silence_progress() -> None:
    """Show no bar any more in this process."""
    global _quiet
    _quiet = True


def track_progress[Item](
    items: Iterable[Item], description: str, total: int | None = None
) -> Iterator[Item]:
    """Yield the items of a long loop while a bar on standard error shows how far it has come.

    Parameters
    ----------
    items : Iterable
        What the loop goes through.
    description : str
        A verb and its object, as in "tracking trials".
    total : int, optional
        Number of items, where ``items`` has no length of its own.

    Examples
    --------
    >>> list(track_progress([3, 4], "counting"))
    [3, 4]
    """
    console = Console(stderr=True)
    if total is None and isinstance(items, Sized):
        total = len(items)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(
        *columns, console=console, transient=True, disable=_quiet or not console.is_terminal
    ) as bar:
        yield from bar.track(items, total=total, description=description)
