"""Frames of a video, one at a time."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from softfinger.faults import Fault, TrialFault
from softfinger.gate.child import read_in_child
from softfinger.gate.pictures import decode_video

LARGEST_RATE_ERROR = 0.01
_PLAUSIBLE_COUNT = 10_000_000


@dataclass(frozen=True)
class Frame:
    """A picture (row, column, channel) and its time [s]."""

    index: int
    time: float
    picture: np.ndarray


def read_frames(path: Path, fps: float) -> Iterator[Frame]:
    """Read a video frame by frame.

    Memory does not grow with the video's length.

    Times are the container's own time stamps where it has them, else index / rate.

    Parameters
    ----------
    path : Path
        The video.
    fps : float [1/s]
        The declared frame rate.

    Raises
    ------
    TrialFault
        The file is missing, empty, in a format that cannot be decoded, at a frame rate more than
        1 % off the declared one, or cut off; its pictures differ in size, its clock goes back, or
        its decoder exceeds :class:`softfinger.gate.child.Limits`.
    """
    messages = _decode(path)
    try:
        claims, _ = next(messages)
        _check_rate(path, claims["rate"], fps)
        index, last = 0, -np.inf
        for described, content in messages:
            stamp = described["stamp"]
            time = stamp if stamp > last else index / claims["rate"]
            if time <= last:
                raise TrialFault(
                    f"{path.name}: its clock goes back from {last:.3f} s to {stamp:.3f} s at frame "
                    f"{index}; record it again"
                )
            last = time
            yield Frame(index, last, content.reshape(described["shape"]))
            index += 1
    finally:
        messages.close()
    _check_count(path, index, claims["frames"], claims["rate"])


def peek_pictures(path: Path, shares: Sequence[float]) -> list[np.ndarray]:
    """Reachable pictures at shares of a video."""
    messages = _decode(path, shares)
    claims, _ = next(messages)
    if not 0 < claims["frames"] < _PLAUSIBLE_COUNT:
        messages.close()
    return [content.reshape(described["shape"]) for described, content in messages]


def _decode(path: Path, shares: Sequence[float] | None = None) -> Iterator[tuple[dict, np.ndarray]]:
    """What a child decodes of a video."""
    if not path.is_file():
        raise TrialFault(f"{path.name}: the file {path} does not exist")
    if path.stat().st_size == 0:
        raise TrialFault(f"{path.name}: the file is empty (0 bytes); copy or record it again")
    try:
        yield from read_in_child(decode_video, str(path), shares)
    except Fault as fault:
        raise TrialFault(f"{path.name}: {fault}") from None


def _check_rate(path: Path, rate: float, fps: float) -> None:
    if not np.isfinite(rate) or abs(rate / fps - 1.0) > LARGEST_RATE_ERROR:
        raise TrialFault(
            f"{path.name}: its frame rate is {rate:g} /s, but campaign.yaml declares camera.fps "
            f"{fps:g}; they may differ by at most {100 * LARGEST_RATE_ERROR:g} %"
        )


def _check_count(path: Path, count: int, claimed: float, rate: float) -> None:
    if count == 0:
        raise TrialFault(f"{path.name}: not one frame can be decoded; record it again")
    # Containers without an index (a recorder that was killed) claim nonsense; those that count by
    # duration may be off by one. AVI counts, and a frame that it lost moves all later ones.
    slack = 0 if path.suffix.lower() == ".avi" else 1
    if 0 < claimed < _PLAUSIBLE_COUNT and count < claimed - slack:
        raise TrialFault(
            f"{path.name}: is cut off: {count} frames ({count / rate:.2f} s) of the {claimed:.0f} "
            "that it should have can be decoded; copy or record it again"
        )
