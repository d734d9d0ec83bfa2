"""One trial: rest, then segment after segment of the load, with the frames on the way."""

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.forward.acting import (
    ACTING,
    D_SLOPE,
    D_VALUE,
    SLOPE,
    VALUE,
    advance_acting,
    fill_load,
    limit_load,
    limit_node,
)
from softfinger.mechanics.forward.advance import (
    commit_step,
    emit_frame,
    measure_error,
    set_straight_drives,
)
from softfinger.mechanics.forward.phi import NODES as _SHARES
from softfinger.mechanics.forward.rest import fill_rest
from softfinger.mechanics.forward.slots import CHAIN_SLOTS
from softfinger.mechanics.forward.slow import slow_log
from softfinger.mechanics.forward.step import has_feedback, open_step, solve_step
from softfinger.mechanics.forward.torque import turn_direction
from softfinger.mechanics.forward.work import (
    HAS_FLOW,
    HAS_FRICTION,
    HAS_INERTIA,
    HAS_LAG,
    HAS_LIMIT,
    HAS_SLOWNESS,
    HAS_SPRING,
    START,
    Model,
    Work,
)

_DELAY, _LAG = CHAIN_SLOTS.index("delay"), CHAIN_SLOTS.index("lag")
_WIDTH, _DRIVER = CHAIN_SLOTS.index("friction_width"), CHAIN_SLOTS.index("friction_driver")
_SLOWNESS = CHAIN_SLOTS.index("load_slowness")
_INERTIA = CHAIN_SLOTS.index("inertia_scale")
_MAX_STEPS = 20_000
_INSTANT = 1e-12  # [s] knots that rounding alone keeps apart are a jump


@compiled
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
    """Write the joint angles (joint, n) and their tangents (joint, n, column) of one trial.

    False where the model could not be integrated.
    """
    delay, frames, frame = model.chain[_DELAY], _count_frames(time), np.int64(0)
    load, d_acting = np.zeros(6), np.zeros((2, model.d_chain.shape[0]))
    load_time, load_torque, d_load = slow_log(load_time, load_torque, model.chain[_SLOWNESS])
    now, last = load_time[0], load_time.size - 1
    if frames > 0:
        now = min(now, time[0] - delay)
    fill_rest(model, work, now)
    for knot in range(-1, last + 1):
        end = load_time[knot + 1] if knot < last else time[max(frames - 1, 0)] - delay
        if knot >= 0:
            before, after = limit_load(model, load[VALUE]), limit_load(model, load_torque[knot])
            jump = after[0] - before[0]
            load[VALUE], load[SLOPE] = load_torque[knot], 0.0
            load[D_VALUE], load[D_SLOPE] = d_load[knot], 0.0
            if knot < last and end - now > _INSTANT:
                load[SLOPE] = (load_torque[knot + 1] - load_torque[knot]) / (end - now)
                load[D_SLOPE] = (d_load[knot + 1] - d_load[knot]) / (end - now)
            _jump(model, work, load, jump)
        if frame >= frames:
            break
        if end - now > _INSTANT:
            frame = _run_segment(
                model, work, time[:frames], frame, now, end, load, d_acting,
                tolerance, longest, angle, gradient,
            )  # fmt: skip
            if frame < 0:
                return False
            now = end
    for left in range(frame, frames):
        emit_frame(model, work, 0.0, 0.0, left, angle, gradient)
    return True


@compiled
def _count_frames(time: NDArray) -> int:
    """The frames before the padding."""
    frames = time.size
    while frames > 0 and np.isnan(time[frames - 1]):
        frames -= 1
    return frames


@compiled
def _jump(model: Model, work: Work, load: NDArray, jump: float) -> None:
    """Take the wire's friction, or the first effect of a lag, across a jump of the log."""
    state = work.state
    if model.chain[_LAG] > 0.0:
        return  # the load that acts does not jump
    load[ACTING] = load[VALUE]
    slowed = model.groups[HAS_SLOWNESS] and model.chain[_SLOWNESS] == 0.0
    if model.groups[HAS_LAG] or slowed:  # a lag of nothing delays the jump by d(lag): a kick
        for j in range(state.offset.size):
            for mode in range(state.mode.shape[1]):
                for c in model.columns[j]:
                    late = model.d_chain[c, _LAG]
                    if slowed:
                        late += 0.5 * abs(jump) * model.d_chain[c, _SLOWNESS]
                    state.d_mode[j, mode, c] -= work.linear.gain[j, mode] * jump * late
    if model.groups[HAS_FRICTION] and not model.chain[_DRIVER] > 0.5:
        state.direction[0], by_way, _, by_width = turn_direction(
            state.direction[0], jump, model.chain[_WIDTH]
        )
        for c in range(model.d_chain.shape[0]):
            state.d_direction[0, c] *= by_way
            state.d_direction[0, c] += by_width * model.d_chain[c, _WIDTH]


@compiled
def _run_segment(
    model: Model,
    work: Work,
    time: NDArray,
    frame: int,
    now: float,
    end: float,
    load: NDArray,
    d_acting: NDArray,
    tolerance: float,
    longest: float,
    angle: NDArray,
    gradient: NDArray,
) -> int:
    """Go from one knot to the next; the next frame, or −1 where that failed."""
    delay, tangents = model.chain[_DELAY], model.d_chain.shape[0] > 0
    straight, start, steps, opened = not _is_curved(model), now, 0, False
    work.curved[0] = not straight
    step = end - now if straight else min(longest, _first_step(model, work, tolerance))
    while now < end:
        steps += 1
        if steps > _MAX_STEPS or not step > _INSTANT:
            return -1
        final = now + step * 1.001 >= end
        length = end - now if final else step
        if straight:
            set_straight_drives(work, load[VALUE], load[SLOPE] * length)
        else:
            for i in range(4):
                if i != START or not opened:
                    share = _SHARES[i] if i != START else 0.0
                    since = now - start + share * length
                    work.nodes.time[i] = start + since
                    fill_load(model, work, i, load, d_acting, since)
                    if model.groups[HAS_LIMIT]:
                        limit_node(model, work, i)
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
        while frame < time.size and time[frame] - delay <= ahead:
            span = max(time[frame] - delay - now, 0.0)
            emit_frame(model, work, span, span / length, frame, angle, gradient)
            frame += 1
        commit_step(model, work, length)
        now, opened = ahead, False
    if model.chain[_LAG] > 0.0:
        advance_acting(model, work, load, d_acting, end - start)
    load[VALUE] += load[SLOPE] * (end - start)
    return frame


@compiled
def _is_curved(model: Model) -> bool:
    """Whether any drive may bend between the knots of the load."""
    groups = model.groups
    return (
        has_feedback(model)
        or groups[HAS_SPRING]
        or groups[HAS_FLOW]
        or groups[HAS_LAG]
        or groups[HAS_LIMIT]
        or groups[HAS_SLOWNESS]
    )


@compiled
def _first_step(model: Model, work: Work, tolerance: float) -> float:
    """A step to begin a segment with: short beside what is fastest."""
    if tolerance == np.inf:
        return np.inf
    if model.groups[HAS_INERTIA] and model.chain[_INERTIA] != 0.0:
        return 1e-6
    step = 0.05 / work.linear.rate[:, 0].max()
    if model.chain[_LAG] > 0.0:
        step = min(step, 0.2 * model.chain[_LAG])
    return step
