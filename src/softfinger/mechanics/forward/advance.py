"""A solved step's frames, its end, its error."""

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.forward.drives import TORQUE, drive_of
from softfinger.mechanics.forward.hooks import GIVE, LOG, TURN, call_give
from softfinger.mechanics.forward.phi import mode_response
from softfinger.mechanics.forward.spring import SLOPE, VALUE
from softfinger.mechanics.forward.tangents import (
    add_drives,
    add_responses,
    add_scaled,
    drive_modes,
    follow_slides,
    move_modes,
)
from softfinger.mechanics.forward.work import START, Model, Work

_TANGENT_TOLERANCE = 3e-3  # of the largest tangent so far: more digits change no fit
_SHORT = 1e-4  # [s] steps that need not be shorter for a tangent's sake: early ones are rounding
_BEND = 0.1  # how far the worst quadratic inside a step moves a mode, of a constant drive


@compiled
def set_straight_drives(model: Model, work: Work, step: float) -> None:
    """Let drives be the load, a straight line."""
    log, d_log, linear = work.load.log, work.load.d_log, work.linear
    linear.drive[:, :, 0] = log[0]
    linear.drive[:, :, 1] = log[1] * step
    linear.drive[:, :, 2] = 0.0
    if model.count[LOG] > 0:
        for j in range(linear.rate.shape[0]):
            for drive in range(3):
                linear.d_drive[j, drive, 0] = d_log[0]
                linear.d_drive[j, drive, 1] = 0.0
                add_scaled(step, d_log[1], linear.d_drive[j, drive, 1])
                linear.d_drive[j, drive, 2] = 0.0


@compiled
def drives_change(model: Model) -> bool:
    """Whether the drives depend on the parameters."""
    return model.curved or model.count[LOG] > 0


@compiled
def emit_frame(
    model: Model,
    work: Work,
    span: float,
    share: float,
    frame: int,
    late: NDArray,
    angle: NDArray,
    gradient: NDArray,
) -> None:
    """Write the joint angles and their tangents.

    They are `span` seconds into the step.

    `late` (column,) is how the frame's moment changes; empty where it does not.
    """
    state, linear, weight, response = work.state, work.linear, work.weight, work.response
    moving = late.size > 0 and span > 0.0
    for j in range(state.offset.size):
        total, velocity = state.offset[j], 0.0
        row = gradient[j, frame]
        row[:] = state.d_offset[j]
        weight[:] = 0.0
        for mode in range(linear.rate.shape[1]):
            rate, gain, drive = linear.rate[j, mode], linear.gain[j, mode], drive_of(mode)
            d0, d1, d2 = (
                linear.drive[j, drive, 0],
                linear.drive[j, drive, 1],
                linear.drive[j, drive, 2],
            )
            x, response[mode, 0], response[mode, 1], response[mode, 2], w0, w1, w2 = mode_response(
                rate, span, share, state.mode[j, mode], gain, d0, d1, d2
            )
            total += x
            velocity += gain * (d0 + share * (d1 + share * d2)) - rate * x
            weight[drive, 0] += gain * w0
            weight[drive, 1] += gain * w1
            weight[drive, 2] += gain * w2
        if model.count[GIVE] > 0:
            given, faster = _give_way(model, work, j, span, share, row)
            total += given
            velocity += faster
        angle[j, frame] = total
        if row.size == 0:
            continue
        add_responses(response, state.d_mode[j], linear.d_rate[j], linear.d_gain[j], row)
        if drives_change(model):
            add_drives(weight, linear.d_drive[j], row)
        if moving:
            for c in range(row.size):
                row[c] += velocity * late[c]


@compiled
def _give_way(
    model: Model, work: Work, j: int, span: float, share: float, row: NDArray
) -> tuple[float, float]:
    """What a link turns at once, and how fast.

    Adds its changes to the row.
    """
    drive, given = work.linear.drive[j, TORQUE], work.pair
    given[VALUE], given[SLOPE] = 0.0, 0.0
    torque = drive[0] + share * (drive[1] + share * drive[2])
    for k in range(model.count[GIVE]):
        call_give(model.hook[GIVE, k], model, j, torque, given, row)
    if row.size > 0 and drives_change(model):
        for power in range(3):
            add_scaled(given[SLOPE] * share**power, work.linear.d_drive[j, TORQUE, power], row)
    rise = (drive[1] + 2.0 * share * drive[2]) * share / span if span > 0.0 else 0.0
    return given[VALUE], given[SLOPE] * rise


@compiled
def commit_step(model: Model, work: Work, step: float) -> None:
    """Move the state to the end of the step."""
    state, linear, nodes, response = work.state, work.linear, work.nodes, work.response
    for j in range(state.offset.size):
        for mode in range(linear.rate.shape[1]):
            rate, gain, drive = linear.rate[j, mode], linear.gain[j, mode], drive_of(mode)
            d0, d1, d2 = (
                linear.drive[j, drive, 0],
                linear.drive[j, drive, 1],
                linear.drive[j, drive, 2],
            )
            x, response[mode, 0], response[mode, 1], response[mode, 2], w0, w1, w2 = mode_response(
                rate, step, 1.0, state.mode[j, mode], gain, d0, d1, d2
            )
            state.mode[j, mode] = x
            work.drive[mode], response[mode, 3] = drive, gain * w0
            response[mode, 4], response[mode, 5] = gain * w1, gain * w2
        if state.d_offset.shape[1] == 0:
            continue
        move_modes(response, state.d_mode[j], linear.d_rate[j], linear.d_gain[j])
        if drives_change(model):
            drive_modes(response, work.drive, linear.d_drive[j], state.d_mode[j])
    if model.curved:
        end = nodes.torque.shape[0] - 2
        state.torque[:] = nodes.torque[end]
        state.d_torque[:] = nodes.d_torque[end]
        state.velocity[:] = nodes.velocity[end]
        state.d_velocity[:] = nodes.d_velocity[end]
        if model.count[TURN] > 0:
            state.direction[:] = nodes.direction[end]
            follow_slides(nodes, end, state.d_direction)


@compiled
def measure_error(model: Model, work: Work, step: float, tolerance: float) -> float:
    """The error inside the step over the tolerance.

    It is of angles and of their tangents.

    The quadratics leave the drives by what they miss at the start of the step, times a cubic that
    vanishes at the nodes.
    """
    if tolerance == np.inf:
        return 0.0
    nodes, linear, largest = work.nodes, work.linear, work.largest
    worst = 0.0
    for j in range(linear.rate.shape[0]):
        torque, missed = nodes.torque[START, j], work.missed
        missed[0] = linear.drive[j, 0, 0] - (torque - nodes.spring[START, j])
        missed[1] = linear.drive[j, 1, 0] - nodes.flow[START, j]
        missed[2] = linear.drive[j, 2, 0] - torque
        if not np.isfinite(missed).all():  # `max` would forget a NaN
            return np.inf
        for c in model.columns[j]:
            largest[c] = max(largest[c], abs(nodes.d_angle[1, j, c]), abs(nodes.d_angle[2, j, c]))
        for drive in range(3):
            reach = _BEND * linear.weight[drive, j, 1].sum()
            worst = max(worst, reach * abs(missed[drive]) / tolerance)
            if not (step > _SHORT and reach > 0.0):
                continue
            for c in model.columns[j]:
                start = nodes.d_torque[START, j, c]
                if drive == 0:
                    start -= nodes.d_spring[START, j, c]
                elif drive == 1:
                    start = nodes.d_flow[START, j, c]
                gap = abs(linear.d_drive[j, drive, 0, c] - start)
                if gap > 0.0:
                    worst = max(worst, reach * gap / (_TANGENT_TOLERANCE * largest[c]))
    return worst


@compiled
def delay_jump(work: Work, jump: float, late: NDArray) -> None:
    """Kick the tangents as a late jump does.

    By nothing, but for the change `late` (column,) [s].
    """
    state, gain = work.state, work.linear.gain
    for j in range(state.offset.size):
        for mode in range(state.mode.shape[1]):
            for c in range(late.size):
                state.d_mode[j, mode, c] -= gain[j, mode] * jump * late[c]
