"""What the person at the rig sees."""

import contextlib
import time
from collections import deque
from collections.abc import Iterable
from pathlib import Path
from typing import Self

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from softfinger.rig.camera import StampedPicture

PREVIEW_EVERY_S = 1.0
_RATE_OVER_FRAMES = 30


class Display:
    """A line on standard error, and a preview picture.

    Off a terminal only finished trials are reported.
    """

    def __init__(self, n_trials: int, n_finished: int, fps: float, preview: Path) -> None:
        self._console = Console(stderr=True)
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[tension]:6.2f} N  {task.fields[rate]:5.1f} frames/s"),
            TextColumn("{task.fields[lost]} frames lost"),
            console=self._console,
            transient=True,
            disable=not self._console.is_terminal,
        )
        self._n_trials, self._n_finished = n_trials, n_finished
        self._task = self._bar.add_task(
            "", total=n_trials, completed=n_finished, tension=0.0, rate=0.0, lost=0
        )
        self._fps = fps
        self._preview, self._preview_due = preview, 0.0
        self._stamps: deque[float] = deque(maxlen=_RATE_OVER_FRAMES)
        self._lost = 0

    def __enter__(self) -> Self:
        """Appear."""
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Vanish."""
        self._bar.stop()

    def begin_trial(self, name: str, profile: str) -> None:
        """Say which trial is recorded."""
        number = self._n_finished + 1
        self._lost = 0
        self._bar.update(
            self._task, description=f"{name} ({number} of {self._n_trials}, {profile})"
        )

    def end_trial(self, sentence: str) -> None:
        """Say what came of it."""
        self._n_finished += 1
        self._bar.update(self._task, completed=self._n_finished)
        self._console.print(sentence, highlight=False, soft_wrap=True)

    def show_tension(self, tension: float) -> None:
        """Show the wire's tension [N]."""
        self._bar.update(self._task, tension=tension)

    def show_frames(self, frames: Iterable[StampedPicture]) -> None:
        """Show frame rate and lost frames; refresh the preview."""
        frame = None
        for frame in frames:
            if self._stamps:
                self._lost += max(0, round((frame.stamp - self._stamps[-1]) * self._fps) - 1)
            self._stamps.append(frame.stamp)
        if frame is None:
            return
        span = self._stamps[-1] - self._stamps[0]
        rate = (len(self._stamps) - 1) / span if span > 0 else 0.0
        self._bar.update(self._task, rate=rate, lost=self._lost)
        if time.monotonic() >= self._preview_due:
            self._preview_due = time.monotonic() + PREVIEW_EVERY_S
            unfinished = self._preview.with_name(f".unfinished-{self._preview.name}")
            with contextlib.suppress(OSError):  # a preview is not worth a trial
                unfinished.write_bytes(frame.jpeg)
                unfinished.replace(self._preview)
