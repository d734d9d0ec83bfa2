"""The finger before the load, balancing its weight."""

import numpy as np

from softfinger.compiled import compiled
from softfinger.mechanics.forward.balance import fill_balance
from softfinger.mechanics.forward.hooks import REST, call_rest
from softfinger.mechanics.forward.modes import VOIGT, fill_modes
from softfinger.mechanics.forward.slot import Q_INI
from softfinger.mechanics.forward.spring import solve_rest, spring_tangent, spring_torque
from softfinger.mechanics.forward.work import START, YES, Model, Work


@compiled
def fill_rest(model: Model, work: Work, now: float) -> None:
    """Write the modes and their first state.

    q = q_ini there. The elastic elements balance what acts without load (weight, stop); the dashpot
    has not flowed. Hooks change what else there was.
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
    linear.drive[:], linear.d_drive[:] = 0.0, 0.0  # a trial before may have none that is finite
    nodes.velocity[:] = 0.0
    nodes.acceleration[:] = 0.0
    state.d_mode[:] = 0.0
    work.largest[:] = 0.0
    work.load.log[:], work.load.d_log[:] = 0.0, 0.0
    work.load.acting[:], work.load.d_acting[:], work.load.pace[:] = 0.0, 0.0, np.inf
    work.load.stride[:] = 0.0
    for j in range(state.offset.size):
        nodes.angle[START, j] = model.joint[j, Q_INI]
        fill_modes(model, linear, j)
    fill_balance(model, nodes, work.balance, START, tangents)
    for j in range(state.offset.size):
        _fill_joint_rest(model, work, j)
        for k in range(model.count[REST]):
            call_rest(model.hook[REST, k], model, work, j)


@compiled
def _fill_joint_rest(model: Model, work: Work, j: int) -> None:
    state, linear, balance = work.state, work.linear, work.balance
    torque, angle, time = balance.torque[START, j], model.joint[j, Q_INI], work.nodes.time[START]
    elastic, by_torque, by_angle = solve_rest(model, work, j, time, torque, angle)
    state.offset[j], state.torque[j] = angle - elastic, torque
    state.mode[j, VOIGT] = elastic
    for mode in range(VOIGT + 1, linear.rate.shape[1]):
        if linear.rate[j, mode] > 0.0:
            state.mode[j, mode] = linear.gain[j, mode] / linear.rate[j, mode] * torque
            state.offset[j] -= state.mode[j, mode]
    spring_torque(model, work, j, time, elastic, angle, YES)
    for c in model.columns[j]:
        d_torque = balance.tangent[START, j, c]
        for k in range(state.offset.size):
            d_torque += balance.by_angle[START, j, k] * model.d_joint[c, k, Q_INI]
        softer, d_angle = spring_tangent(model, work, j, c), model.d_joint[c, j, Q_INI]
        d_elastic = by_torque * (d_torque - softer) + by_angle * d_angle
        state.d_mode[j, VOIGT, c] = d_elastic
        state.d_torque[j, c] = d_torque
        state.d_offset[j, c] = d_angle - d_elastic
        for mode in range(VOIGT + 1, linear.rate.shape[1]):
            rate = linear.rate[j, mode]
            if rate > 0.0:
                gain = linear.gain[j, mode]
                slower = linear.d_gain[j, mode, c] - gain / rate * linear.d_rate[j, mode, c]
                change_of_mode = (slower * torque + gain * d_torque) / rate
                state.d_mode[j, mode, c] = change_of_mode
                state.d_offset[j, c] -= change_of_mode
