"""What a rig allows: load, angle, rate, time."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.mismatch.experiment.protocols import PlannedProtocol


class RigLimits(NamedTuple):
    """Limits of the next recordings.

    Attributes
    ----------
    load
        Largest [N m].
    angle
        Largest of any joint [rad], either way.
    rate
        Fastest change of the load [N m/s]; infinite where it may jump.
    minutes
        For all trials, rests included.
    trials
        How many.
    rest
        Between trials [s].
    interval
        Of the camera's frames [s].
    knots
        Most in a load history.
    recalled
        Whether the angle is the largest that was recorded, and none that the rig must keep. Trials
        drawn anew may then exceed it.
    """

    load: float
    angle: float
    rate: float
    minutes: float
    trials: int
    rest: float
    interval: float
    knots: int
    recalled: bool = False

    @property
    def duration(self) -> float:
        """Longest trial [s]."""
        return 60.0 * self.minutes / self.trials - self.rest


def check_limits(limits: RigLimits, at_rest: float, least_frames: int) -> None:
    """Refuse limits that allow nothing.

    Parameters
    ----------
    at_rest
        Largest angle of the finger without load [rad].
    least_frames
        Of a trial that can be used.

    Raises
    ------
    Fault
        No load, no time, or an angle that is reached without load.
    """
    if limits.trials < 1:
        raise Fault(f"--trials {limits.trials}: nothing can be recorded; ask for 1 or more")
    for name, value in (("load", limits.load), ("rate", limits.rate), ("angle", limits.angle)):
        if not value > 0.0:
            raise Fault(f"--max-{name}: it is {value:g}, which allows nothing; give a larger one")
    needed = least_frames * limits.interval
    if limits.duration < needed:
        least = limits.trials * (needed + limits.rest) / 60.0
        raise Fault(
            f"--minutes {limits.minutes:g}: {limits.trials} trials with {limits.rest:g} s of rest "
            f"leave {limits.duration:.3g} s for each; give {least:.3g} minutes or more, or fewer "
            "trials"
        )
    if at_rest >= limits.angle:
        raise Fault(
            f"--max-angle {limits.angle:g}: the joints reach {at_rest:.3g} rad without load; "
            "give a larger angle"
        )


def limit_rate(
    time: NDArray[np.float64], load: NDArray[np.float64], rate: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Slow down a history (knot,) whose load moves too fast.

    Each level is reached as soon as the rate allows; before the first knot the load is 0.

    >>> limit_rate(np.array([0.0, 4.0, 4.0, 8.0]), np.array([2.0, 2.0, 0.0, 0.0]), 1.0)
    (array([0., 2., 4., 6., 8.]), array([0., 2., 2., 0., 0.]))
    """
    if not np.isfinite(rate):
        return time, load
    now, value = 0.0, 0.0
    times, loads = [0.0], [0.0]
    for moment, wanted in zip(time, load, strict=True):
        now, value = max(moment, now + abs(wanted - value) / rate), wanted
        if now > times[-1] or wanted != loads[-1]:
            times.append(float(now))
            loads.append(float(wanted))
    return np.array(times), np.array(loads)


def hold_limits(
    histories: list[tuple[NDArray[np.float64], NDArray[np.float64]]], limits: RigLimits
) -> PlannedProtocol:
    """Histories as a protocol within load, rate and time.

    What comes after the longest trial is cut.
    """
    slowed = [limit_rate(t, np.clip(u, 0.0, limits.load), limits.rate) for t, u in histories]
    end = limits.duration
    cut = [_cut(time, load, end) for time, load in slowed]
    longest = max(len(time) for time, _ in cut)
    stacked = [
        np.stack([np.pad(pair[k], (0, longest - len(pair[k])), mode="edge") for pair in cut])
        for k in (0, 1)
    ]
    return PlannedProtocol(*stacked)


def _cut(
    time: NDArray[np.float64], load: NDArray[np.float64], end: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    kept = time < end
    last = float(np.interp(end, time, load)) if kept.any() else 0.0
    return np.append(time[kept], end), np.append(load[kept], last)


def scale_load(protocol: PlannedProtocol, share: float) -> PlannedProtocol:
    """The same protocol with a share of its load."""
    return protocol._replace(load_torque=share * protocol.load_torque)
