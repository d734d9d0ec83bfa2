"""The load history: straight lines between knots.

Before the first knot the load is 0 and the finger at rest, so a first knot with load is a step at
its time; after the last knot the last value stays. Arrays of several trials are padded by repeating
the last knot.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softfinger.compiled import compiled
from softfinger.faults import Fault
from softfinger.mechanics.checks import require_finite, require_forward_in_time

ROUNDING = 1e-12  # how far three points on a line seem to be from it, relative


def check_load(load_time: ArrayLike, load_torque: ArrayLike) -> None:
    """Refuse knots that are no load history.

    `Fault` unless they (…, knot) are finite, equally many and never run backwards.

    Parameters
    ----------
    load_time
        (…, knot) [s], nondecreasing.
    load_torque
        (…, knot) [N m], or the unit of the command.
    """
    load_time, load_torque = np.asarray(load_time, float), np.asarray(load_torque, float)
    if load_time.ndim == 0 or load_time.shape[-1:] != load_torque.shape[-1:]:
        raise Fault(
            f"load_time has shape {load_time.shape} and load_torque {load_torque.shape}: "
            "they must have the same number of knots"
        )
    if load_time.shape[-1] == 0:
        raise Fault("the load has no knot: it must have at least one")
    require_forward_in_time("load_time", load_time)
    require_finite("load_torque", load_torque, "N m")


def drop_idle_knots(
    load_time: NDArray[np.float64], load_torque: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Leave out knots at which the load does not turn.

    They lie on the line between their neighbours, as most rows of a dense log of a command do. The
    load is the same function of time, and an integrator may step across a plateau.

    Parameters
    ----------
    load_time, load_torque
        (trial, knot) [s], [N m]; padded by repeating the last knot, and so is what is returned.

    Returns
    -------
    load_time, load_torque
        (trial, fewer knots).

    Examples
    --------
    >>> drop_idle_knots(np.array([[0.0, 1.0, 2.0, 3.0]]), np.array([[0.0, 5.0, 5.0, 5.0]]))
    (array([[0., 1., 3.]]), array([[0., 5., 5.]]))
    """
    log = load_time, load_torque
    told_once = np.ones(load_torque.shape, bool)
    told_once[:, :-1] = np.logical_or(*(np.diff(rows) != 0.0 for rows in log))
    time, torque = log = _keep_knots(log, told_once)
    span, rise = np.diff(time), np.diff(torque)
    turn = np.abs(rise[:, :-1] * span[:, 1:] - rise[:, 1:] * span[:, :-1])
    size = np.abs(torque).max(axis=1, keepdims=True) * (span[:, :-1] + span[:, 1:])
    turns = np.ones(torque.shape, bool)
    turns[:, 1:-1] = turn > ROUNDING * size
    return _keep_knots(log, turns)


def _keep_knots(
    log: tuple[NDArray[np.float64], ...], kept: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], ...]:
    """Keep chosen knots (trial, knot), padded by the last one."""
    count = kept.sum(axis=1)
    if count.min() == kept.shape[1]:
        return log
    order = np.argsort(~kept, axis=1, kind="stable")[:, : count.max()]
    last = np.minimum(np.arange(order.shape[1]), count[:, None] - 1)
    order = np.take_along_axis(order, last, axis=1)
    return tuple(np.take_along_axis(rows, order, axis=1) for rows in log)


def integrate_load_array(
    time: ArrayLike, load_time: ArrayLike, load_torque: ArrayLike
) -> NDArray[np.float64]:
    """Integrate the load from rest.

    It is up to each time, exact for a piecewise-linear load.

    Parameters
    ----------
    time
        (n,) [s], nondecreasing; NaN gives NaN.
    load_time, load_torque
        (knot,) [s], [N m].

    Returns
    -------
    (n,) [N m s].

    Examples
    --------
    A ramp from 0 to 2 within 4 s, then held:

    >>> integrate_load_array([2.0, 4.0, 5.0], [0.0, 4.0], [0.0, 2.0])
    array([1., 4., 6.])
    """
    time = np.asarray(time, float)
    load_time, load_torque = np.asarray(load_time, float), np.asarray(load_torque, float)
    check_load(load_time, load_torque)
    require_forward_in_time("time", time, padded=True)
    integral = np.empty(time.size)
    fill_load_integral(time, load_time, load_torque, integral)
    return integral


def evaluate_load_array(
    time: ArrayLike, load_time: ArrayLike, load_torque: ArrayLike
) -> NDArray[np.float64]:
    """Evaluate the load u(t) [N m].

    Times are (n,) [s]; at a step it is the value after it.

    >>> evaluate_load_array([-1.0, 0.0, 1.0, 9.0], [0.0, 2.0], [1.0, 3.0])
    array([0., 1., 2., 3.])
    """
    time = np.asarray(time, float)
    load_time, load_torque = np.asarray(load_time, float), np.asarray(load_torque, float)
    check_load(load_time, load_torque)
    return _evaluate(time, load_time, load_torque)


@compiled
def _evaluate(time: NDArray, load_time: NDArray, load_torque: NDArray) -> NDArray:
    value = np.zeros(time.size)
    last = load_time.size - 1
    for i in range(time.size):
        if np.isnan(time[i]):
            value[i] = np.nan
            continue
        k = np.searchsorted(load_time, time[i], side="right") - 1
        if k == last:
            value[i] = load_torque[last]
        elif k >= 0:
            share = (time[i] - load_time[k]) / (load_time[k + 1] - load_time[k])
            value[i] = load_torque[k] + share * (load_torque[k + 1] - load_torque[k])
    return value


@compiled
def fill_load_integral(
    time: NDArray, load_time: NDArray, load_torque: NDArray, integral: NDArray
) -> None:
    """Write ∫ u dt [N m s].

    It goes into `integral` (n,) at nondecreasing times (n,), without checks.
    """
    last = load_time.size - 1
    knot = 0  # the first knot that lies after the present
    total = 0.0  # ∫ u up to knot − 1
    for i in range(time.size):
        if np.isnan(time[i]):
            integral[i] = np.nan
            continue
        while knot <= last and load_time[knot] <= time[i]:
            if knot > 0:
                step = load_time[knot] - load_time[knot - 1]
                total += 0.5 * step * (load_torque[knot - 1] + load_torque[knot])
            knot += 1
        if knot == 0:
            integral[i] = 0.0
            continue
        since = time[i] - load_time[knot - 1]
        slope = 0.0
        if knot <= last:
            rise = load_torque[knot] - load_torque[knot - 1]
            slope = rise / (load_time[knot] - load_time[knot - 1])
        integral[i] = total + since * (load_torque[knot - 1] + 0.5 * slope * since)
