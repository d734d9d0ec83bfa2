"""Two clocks, one time: camera's and controller's.

The camera stamps its frames; the controller counts microseconds.

Nothing is assumed of how late a frame is stamped: a light that the controller switches is seen in
the frames, so the offset is between what a frame shows and what it is stamped with.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.faults import Fault

LEAST_CONTRAST_GREY = 25.0
LARGEST_RATE_ERROR = 0.01  # the campaign format's
FLASHES = 4
_SETTLED_FRAMES = 3  # a flash and a pause last so many frames and a bit


class ClockOffset(NamedTuple):
    """Camera time minus controller time [s], with its uncertainty."""

    offset: float
    uncertainty: float


class FrameClock(NamedTuple):
    """A camera's regular beat without the stamps' jitter.

    Frame ``slot[i]`` of the beat is the one with stamp i; it was taken at start + slot / rate.
    """

    start: float
    rate: float
    slot: NDArray[np.int_]
    jitter: float


def compute_flash_duration(fps: float) -> float:
    """Duration of each flash and each pause [s].

    Three frames and 1/8: the eight edges of four flashes then fall on eight evenly spread places
    within the frame interval, which pins the offset to ± 1/16 of it.

    >>> round(compute_flash_duration(25.0) * 25.0, 9)
    3.125
    """
    return (_SETTLED_FRAMES + 1 / (2 * FLASHES)) / fps


def find_light_changes(brightness: NDArray[np.float64]) -> NDArray[np.int_]:
    """Frames at which the light changes visibly.

    Without contrast there are none.

    >>> find_light_changes(np.array([9, 8, 99, 98, 9]))
    array([2, 4])
    """
    if brightness.size == 0 or np.ptp(brightness) < LEAST_CONTRAST_GREY:
        return np.zeros(0, int)
    lit = brightness > (brightness.min() + brightness.max()) / 2
    return np.flatnonzero(np.diff(lit.astype(int))) + 1


def estimate_clock_offset(
    stamp: NDArray[np.float64], brightness: NDArray[np.float64], edges: Sequence[float]
) -> ClockOffset:
    """Estimate camera minus controller time from a flashing light.

    An edge at controller time t is seen between two frames: stamp[k − 1] < t + offset ≤ stamp[k].
    The offset lies where all these intervals overlap, in whose middle it is put. Where jitter of
    the stamps leaves no overlap, half the gap is the uncertainty.

    Parameters
    ----------
    stamp : (frame,) [s]
        Camera time of each frame.
    brightness : (frame,) [grey]
        Mean over the light's place in the picture.
    edges : (edge,) [s]
        Controller times, on and off in turn, starting with on.

    Raises
    ------
    Fault
        The light is not seen, or not as often as it was switched.

    Examples
    --------
    On at 0.04 s and off at 0.12 s, frames every 0.05 s:

    >>> seen = np.array([9, 99, 99, 9, 9, 9])
    >>> offset = estimate_clock_offset(np.arange(10.0, 10.3, 0.05), seen, [0.04, 0.12])
    >>> [round(float(value), 6) for value in offset]
    [9.995, 0.015]
    """
    seen = find_light_changes(brightness)
    if seen.size == 0:
        darkest, brightest = (brightness.min(), brightness.max()) if brightness.size else (0.0, 0.0)
        raise Fault(
            f"the sync light is not seen: its place in the picture stays between {darkest:.0f} and "
            f"{brightest:.0f} grey over {brightness.size} frames; aim the camera at the light or "
            "correct recording.sync_light_px"
        )
    if brightness[seen[0]] < brightness[seen[0] - 1] or len(seen) != len(edges):
        raise Fault(
            f"the sync light was switched {len(edges)} times but seen to change {len(seen)} times; "
            "keep other light off recording.sync_light_px, and check whether the camera drops "
            "frames"
        )
    latest = (stamp[seen] - edges).min()
    earliest = (stamp[seen - 1] - edges).max()
    return ClockOffset(float(earliest + latest) / 2, float(abs(latest - earliest)) / 2)


def fit_frame_clock(stamp: NDArray[np.float64], fps: float) -> FrameClock:
    """Fit a regular beat to the stamps of frames.

    Gaps are counted in whole frames of the declared rate; then stamp = start + slot / rate by least
    squares.

    Parameters
    ----------
    stamp : (frame,) [s]
        Increasing.
    fps
        The declared rate [1/s].

    Raises
    ------
    Fault
        Fewer than two frames, or a rate more than 1 % off the declared one.

    Examples
    --------
    The third of five frames was dropped:

    >>> clock = fit_frame_clock(np.array([7.0, 7.1, 7.3, 7.4]), 10.0)
    >>> clock.slot, round(clock.start, 9), round(clock.rate, 9)
    (array([0, 1, 3, 4]), 7.0, 10.0)
    """
    if stamp.size < 2:
        raise Fault(f"the camera took {stamp.size} frames of this trial; expected at least two")
    gap = np.maximum(1, np.round(np.diff(stamp) * fps)).astype(int)
    slot = np.concatenate([[0], np.cumsum(gap)])
    interval, start = np.polyfit(slot, stamp - stamp[0], 1)
    rate = 1 / interval
    if not abs(rate / fps - 1) <= LARGEST_RATE_ERROR:
        raise Fault(
            f"the camera takes {rate:.4g} frames/s, but the plan declares campaign.camera.fps "
            f"{fps:g}; they may differ by at most {100 * LARGEST_RATE_ERROR:g} %: set the camera "
            "or the plan right"
        )
    jitter = float(np.sqrt(np.mean((stamp - stamp[0] - start - slot * interval) ** 2)))
    return FrameClock(float(start + stamp[0]), float(rate), slot, jitter)
