"""One trial: rest, the load's segments, frames."""

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.forward.advance import (
    commit_step,
    emit_frame,
    measure_error,
    set_straight_drives,
)
from softfinger.mechanics.forward.hooks import (
    CLOCK,
    FOLLOW,
    JUMP,
    LIMIT,
    LOG,
    call_clock,
    call_follow,
    call_jump,
    call_limit,
    call_log,
)
from softfinger.mechanics.forward.phi import NODES as _SHARES
from softfinger.mechanics.forward.rest import fill_rest
from softfinger.mechanics.forward.step import open_step, solve_step
from softfinger.mechanics.forward.tangents import add_scaled
from softfinger.mechanics.forward.work import NO, START, YES, Model, Work

VALUE, SLOPE = range(2)
"""Of the log on a segment: its value at the start, and its slope."""
_MAX_STEPS = 20_000
_INSTANT = 1e-12  # [s] knots that rounding alone keeps apart are a jump
_ROUNDING = 1e-9  # of a load that does not jump, relative


@compiled(inline="always")
def run_trial(
    model: Model,
    work: Work,
    time: NDArray,
    load_time: NDArray,
    load_torque: NDArray,
    tolerance: float,
    longest: float,
    angle: NDArray,
    gradient: NDArray,
) -> bool:
    """Write one trial's angles and tangents.

    Joint angles (joint, n), tangents (joint, n, column).

    False where the model could not be integrated.
    """
    time, late = _shift_frames(model, work, time)
    frames, frame, log = time.size, np.int64(0), work.load.log
    load_time, load_torque, d_load = _read_log(model, load_time, load_torque)
    now, last = load_time[0], load_time.size - 1
    if frames > 0:
        now = min(now, time[0])
    fill_rest(model, work, now)
    while frame < frames and time[frame] <= now:  # a load that comes later moves none of these
        emit_frame(model, work, 0.0, 0.0, frame, late, angle, gradient)
        frame += 1
    for knot in range(-1, last + 1):
        end = load_time[knot + 1] if knot < last else time[max(frames - 1, 0)]
        if knot >= 0:
            jump = _limit(model, work, load_torque[knot]) - _limit(model, work, log[VALUE])
            if abs(load_torque[knot] - log[VALUE]) > _ROUNDING * abs(load_torque[knot]):
                work.load.stride[0] = 0.0
            _set_segment(work, load_time, load_torque, d_load, knot, end - now)
            for k in range(model.count[JUMP] if work.load.pace[0] == np.inf else 0):
                call_jump(model.hook[JUMP, k], model, work, jump)
        if frame >= frames:
            break
        if end - now > _INSTANT:
            frame = _run_segment(
                model, work, time, late, frame, now, end, tolerance, longest, angle, gradient
            )
            if frame < 0:
                return False
            now = end
    for left in range(frame, frames):
        emit_frame(model, work, 0.0, 0.0, left, late, angle, gradient)
    return True


@compiled
def _shift_frames(model: Model, work: Work, time: NDArray) -> tuple[NDArray, NDArray]:
    """Moments of the frames, and their change.

    Those before the padding; the change (column,) is empty where there is none.
    """
    moment = time[: _count_frames(time)].copy()
    if model.count[CLOCK] == 0:
        return moment, work.none
    late = np.zeros(model.d_chain.shape[0])
    for k in range(model.count[CLOCK]):
        call_clock(model.hook[CLOCK, k], model, moment, late)
    return moment, late


@compiled
def _read_log(model: Model, time: NDArray, load: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """The log's knots (knot,), changes (knot, column)."""
    if model.count[LOG] > 0:
        return call_log(model.hook[LOG, 0], model, time, load)
    return time, load, np.zeros((time.size, model.d_chain.shape[0]))


@compiled
def _set_segment(
    work: Work, time: NDArray, load: NDArray, d_load: NDArray, knot: int, span: float
) -> None:
    """Write the log's line from a knot on."""
    log, d_log = work.load.log, work.load.d_log
    log[VALUE], log[SLOPE] = load[knot], 0.0
    d_log[VALUE], d_log[SLOPE] = d_load[knot], 0.0
    if knot < time.size - 1 and span > _INSTANT:
        log[SLOPE] = (load[knot + 1] - load[knot]) / span
        d_log[SLOPE] = (d_load[knot + 1] - d_load[knot]) / span


@compiled
def _limit(model: Model, work: Work, load: float) -> float:
    """What acts under a load, without memory."""
    pair = work.pair
    pair[VALUE] = load
    for k in range(model.count[LIMIT]):
        call_limit(model.hook[LIMIT, k], model, pair, work.none)
    return pair[VALUE]


@compiled
def _fill_load(model: Model, work: Work, i: int, since: float) -> None:
    """Write the load at row i, and changes."""
    nodes, load = work.nodes, work.load
    nodes.load[i] = load.log[VALUE] + load.log[SLOPE] * since
    nodes.d_load[i] = load.d_log[VALUE]
    add_scaled(since, load.d_log[SLOPE], nodes.d_load[i])
    for k in range(model.count[FOLLOW]):
        call_follow(model.hook[FOLLOW, k], model, load, nodes, i, since, NO)
    for k in range(model.count[LIMIT]):
        call_limit(model.hook[LIMIT, k], model, nodes.load[i : i + 1], nodes.d_load[i])


@compiled
def _count_frames(time: NDArray) -> int:
    """The frames before the padding."""
    frames = time.size
    while frames > 0 and np.isnan(time[frames - 1]):
        frames -= 1
    return frames


@compiled(inline="always")
def _run_segment(
    model: Model,
    work: Work,
    time: NDArray,
    late: NDArray,
    frame: int,
    now: float,
    end: float,
    tolerance: float,
    longest: float,
    angle: NDArray,
    gradient: NDArray,
) -> int:
    """Go to the next knot; next frame, or −1."""
    tangents, log = model.d_chain.shape[0] > 0, work.load.log
    straight, start, steps, opened = not model.curved, now, 0, False
    stride = work.load.stride[0]
    step = end - now if straight else min(longest, max(stride, _first_step(model, work, tolerance)))
    while now < end:
        steps += 1
        if steps > _MAX_STEPS or not step > _INSTANT:
            return -1
        final = now + step * 1.001 >= end
        length = end - now if final else step
        if straight:
            set_straight_drives(model, work, length)
        else:
            for i in range(4):
                if i != START or not opened:
                    share = _SHARES[i] if i != START else 0.0
                    since = now - start + share * length
                    work.nodes.time[i] = start + since
                    _fill_load(model, work, i, since)
            if not opened:
                open_step(model, work, tangents)
                opened = True
            solved = solve_step(model, work, length, tangents)
            error = measure_error(model, work, length, tolerance) if solved else np.inf
            if not error <= 1.0:
                step = length * (max(0.1, 0.8 * error**-0.25) if error < 1e30 else 0.1)
                continue
            step = min(longest, length * min(5.0, 0.8 * max(error, 1e-10) ** -0.25))
        ahead = end if final else now + length
        while frame < time.size and time[frame] <= ahead:
            span = max(time[frame] - now, 0.0)
            emit_frame(model, work, span, span / length, frame, late, angle, gradient)
            frame += 1
        commit_step(model, work, length)
        now, opened = ahead, False
    for k in range(model.count[FOLLOW]):
        call_follow(model.hook[FOLLOW, k], model, work.load, work.nodes, START, end - start, YES)
    log[VALUE] += log[SLOPE] * (end - start)
    work.load.stride[0] = step
    return frame


@compiled
def _first_step(model: Model, work: Work, tolerance: float) -> float:
    """A segment's first step, short beside fast modes."""
    if tolerance == np.inf:
        return np.inf
    return min(0.05 / work.linear.rate[:, 0].max(), 0.2 * work.load.pace[0])
