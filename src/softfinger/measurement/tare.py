"""A load log from which its zero is taken off.

A trial starts at rest. A small load that its log reads there is the zero of the load cell, or a
tension under which the finger is at rest already; as a load that begins with the log it would move
the finger.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.measurement.decisions import DECISIONS
from softfinger.measurement.steady import steady_load_array

Array = NDArray[np.float64]


def tare_log(angles: xr.Dataset) -> tuple[xr.Dataset, float]:
    """Take the first reading off each trial's log.

    Returns
    -------
    angles, zero
        With a `load_torque` of 0 until the load first changes, but for a first reading that is a
        change of load itself; rms of what was taken off, over the trial's largest load.
    """
    dims = ("trial", "knot")
    time, torque = (angles[name].transpose(*dims).values for name in ("load_time", "load_torque"))
    zero = np.array([find_zero(*log) for log in zip(time, torque, strict=True)])
    tared = np.where(_before_the_log(time), torque, torque - zero[:, None])
    share = zero / np.maximum(np.abs(torque).max(axis=1), np.finfo(float).tiny)
    return angles.assign(load_torque=(dims, tared)), float(np.sqrt(np.mean(share**2)))


def find_zero(time: Array, torque: Array) -> float:
    """Mean reading (knot,) of the plateau that a log begins with.

    0 where it begins with a load.

    >>> find_zero(np.array([0.0, 0.0, 1.0, 1.0, 2.0]), np.array([0.0, 0.01, 0.01, 2.0, 2.0]))
    0.01
    """
    first = int(np.argmax(np.diff(time, append=np.inf) > 0.0))  # of two knots the later one
    zero = float(steady_load_array(time, torque)[first])
    largest = max(float(np.ptp(torque)), float(np.abs(torque).max()))
    return zero if abs(zero) <= DECISIONS.load_change * largest else 0.0


def _before_the_log(time: Array) -> NDArray[np.bool_]:
    """The knot of no load that comes before a first reading."""
    before = np.zeros(time.shape, bool)
    before[:, 0] = time[:, 0] == time[:, 1]
    return before
