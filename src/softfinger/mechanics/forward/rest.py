"""The finger before the load comes: at rest, in balance with its own weight."""

import math

from softfinger.compiled import compiled
from softfinger.mechanics.forward.modes import LOG_K_V, Q_INI, VOIGT, fill_mode_tangents, fill_modes
from softfinger.mechanics.forward.slots import JOINT_SLOTS
from softfinger.mechanics.forward.spring import solve_rest, spring_tangent
from softfinger.mechanics.forward.torque import fill_balance
from softfinger.mechanics.forward.work import START, Model, Work

_INITIAL = JOINT_SLOTS.index("initial_angle")
_HELD = JOINT_SLOTS.index("initial_torque")


@compiled
def fill_rest(model: Model, work: Work, now: float) -> None:
    """Write the modes and their state at the start of a trial.

    q = q_ini there, plus what an `initial_torque` has left. The elastic elements balance what acts
    without load (weight, stop) at q_ini, plus this and an `initial_angle` that have not relaxed;
    the dashpot has not flowed.
    """
    state, linear, nodes = work.state, work.linear, work.nodes
    tangents = model.d_chain.shape[0] > 0
    nodes.time[:] = now
    nodes.load[:] = 0.0
    nodes.d_load[:] = 0.0
    nodes.direction[:] = 0.0
    state.direction[:] = 0.0
    state.d_direction[:] = 0.0
    state.velocity[:] = 0.0
    state.d_velocity[:] = 0.0
    state.mode[:] = 0.0
    nodes.velocity[:] = 0.0
    nodes.acceleration[:] = 0.0
    state.d_mode[:] = 0.0
    work.largest[:] = 0.0
    for j in range(state.offset.size):
        nodes.angle[START, j] = model.joint[j, Q_INI]
        fill_modes(model.joint[j], model.law[j], linear.rate[j], linear.gain[j])
        for c in model.columns[j]:
            fill_mode_tangents(
                model.joint[j], model.d_joint[c, j], model.law[j], model.d_law[c, j],
                linear.rate[j], linear.gain[j],
                linear.d_rate[j, :, c], linear.d_gain[j, :, c],
            )  # fmt: skip
    fill_balance(model, nodes, work.balance, START, tangents)
    for j in range(state.offset.size):
        _fill_joint_rest(model, work, j)


@compiled
def _fill_joint_rest(model: Model, work: Work, j: int) -> None:
    state, linear, balance = work.state, work.linear, work.balance
    value, torque, angle = model.joint[j], balance.torque[START, j], model.joint[j, Q_INI]
    law, time = model.law[j], work.nodes.time[START]
    elastic, by_torque, by_angle = solve_rest(value, law, time, torque, angle)
    state.offset[j], state.torque[j] = angle - elastic - value[_INITIAL], torque
    compliance = math.exp(-value[LOG_K_V])
    state.mode[j, VOIGT] = elastic + value[_INITIAL] + value[_HELD] * compliance
    for mode in range(VOIGT + 1, linear.rate.shape[1]):
        if linear.rate[j, mode] > 0.0:
            state.mode[j, mode] = linear.gain[j, mode] / linear.rate[j, mode] * torque
            state.offset[j] -= state.mode[j, mode]
    for c in model.columns[j]:
        change = model.d_joint[c, j]
        d_torque = balance.tangent[START, j, c]
        for k in range(state.offset.size):
            d_torque += balance.by_angle[START, j, k] * model.d_joint[c, k, Q_INI]
        softer = spring_tangent(value, change, law, model.d_law[c, j], time, elastic, angle)
        d_elastic = by_torque * (d_torque - softer) + by_angle * change[Q_INI]
        d_held = (change[_HELD] - value[_HELD] * change[LOG_K_V]) * compliance
        state.d_mode[j, VOIGT, c] = d_elastic + change[_INITIAL] + d_held
        state.d_torque[j, c] = d_torque
        state.d_offset[j, c] = change[Q_INI] - d_elastic - change[_INITIAL]
        for mode in range(VOIGT + 1, linear.rate.shape[1]):
            rate = linear.rate[j, mode]
            if rate > 0.0:
                gain = linear.gain[j, mode]
                slower = linear.d_gain[j, mode, c] - gain / rate * linear.d_rate[j, mode, c]
                change_of_mode = (slower * torque + gain * d_torque) / rate
                state.d_mode[j, mode, c] = change_of_mode
                state.d_offset[j, c] -= change_of_mode
