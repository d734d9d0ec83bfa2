"""One step of the kernel.

It is exponential collocation at the Radau IIA nodes, by Newton, with exact tangents.

The modes of the joints are advanced exactly for drives that are quadratics over the step, so the
only unknowns are the joints' torques at three nodes, which must be those that statics asks for at
the angles they lead to. Linear models under straight lines of load are met without error at any
step; the rest converges with order 5 at the ends of steps and 4 within. The tangents are those of
the discrete solution, by the same factors.
"""

import numpy as np

from softfinger.compiled import compiled
from softfinger.mechanics.forward.balance import fill_balance
from softfinger.mechanics.forward.drives import (
    fill_angles,
    fill_drives,
    fill_slopes_by_torque,
    fill_start,
    fill_tangents_at_fixed_torque,
    fill_weights,
)
from softfinger.mechanics.forward.hooks import FLOW, TURN, call_turn
from softfinger.mechanics.forward.phi import DIFFERENTIATE
from softfinger.mechanics.forward.spring import (
    fill_voigt_tangents,
    flow_drive,
    has_curved_voigt,
    voigt_torque,
)
from softfinger.mechanics.forward.tangents import add_scaled, follow_slides, follow_torque
from softfinger.mechanics.forward.work import NO, START, YES, Model, Work
from softfinger.mechanics.linear import factorise_pivoted, solve_columns, solve_pivoted

_ITERATIONS = 12


@compiled
def open_step(model: Model, work: Work, tangents: bool) -> None:
    """Write a step's start, given `nodes.load[START]`."""
    nodes, balance, state = work.nodes, work.balance, work.state
    fill_start(model, work, tangents)
    nodes.direction[START] = state.direction
    fill_balance(model, nodes, balance, START, tangents)
    for j in range(state.offset.size):
        nodes.torque[START, j] = balance.torque[START, j]
        if model.inertial:
            nodes.torque[START, j] = state.torque[j]
        nodes.flow[START, j], nodes.flow_slope[START, j] = flow_drive(
            model, work, j, nodes.time[START], nodes.torque[START, j], work.none
        )
        nodes.spring[START, j] = 0.0
        if has_curved_voigt(model):
            slope = nodes.spring_slope[:, START, j]
            nodes.spring[START, j], slope[2], slope[0], slope[1] = voigt_torque(
                model, work, j, nodes.time[START], nodes.torque[START, j],
                nodes.elastic[START, j], nodes.angle[START, j],
            )  # fmt: skip
    if tangents:
        nodes.d_direction[START] = state.d_direction
        _open_tangents(model, work)


@compiled
def _open_tangents(model: Model, work: Work) -> None:
    nodes, balance, state = work.nodes, work.balance, work.state
    for j in range(state.offset.size):
        for c in model.columns[j]:
            change = balance.tangent[START, j, c]
            change += balance.by_load[START, j] * nodes.d_load[START, c]
            for k in range(state.offset.size):
                change += balance.by_direction[START, j, k] * state.d_direction[k, c]
                change += balance.by_angle[START, j, k] * nodes.d_angle[START, k, c]
            if model.inertial:
                change = state.d_torque[j, c]
            nodes.d_torque[START, j, c] = change
        flow, spring, d_torque = nodes.d_flow[START, j], nodes.d_spring[START, j], nodes.d_torque
        flow[:] = 0.0
        if model.count[FLOW] > 0:
            flow_drive(model, work, j, nodes.time[START], nodes.torque[START, j], flow)
        add_scaled(nodes.flow_slope[START, j], d_torque[START, j], flow)
        if has_curved_voigt(model):
            fill_voigt_tangents(
                model, work, j, nodes.time[START], nodes.torque[START, j],
                nodes.elastic[START, j], nodes.angle[START, j], spring,
            )  # fmt: skip
            slope = nodes.spring_slope[:, START, j]
            add_scaled(slope[0], nodes.d_elastic[START, j], spring)
            add_scaled(slope[1], nodes.d_angle[START, j], spring)
            add_scaled(slope[2], d_torque[START, j], spring)


@compiled
def solve_step(model: Model, work: Work, step: float, tangents: bool) -> bool:
    """Find torques at nodes, by Newton; False: none."""
    nodes, balance, newton = work.nodes, work.balance, work.newton
    joints = work.state.offset.size
    fill_weights(model, work, step)
    for i in range(3):
        for j in range(joints):
            nodes.torque[i, j] = nodes.torque[START, j]
            nodes.spring[i, j] = nodes.spring[START, j]
            if not model.inertial:
                rise = nodes.load[i] - nodes.load[START]
                nodes.torque[i, j] += balance.by_load[START, j] * rise
    for j in range(joints):
        fill_angles(model, work, j)
    change, scale = np.inf, 1.0 if model.feedback else np.inf
    for _ in range(_ITERATIONS):
        if change <= 1e-10 * scale:
            break
        scale = _fill_residual(model, work, step)
        for j in range(joints):
            fill_slopes_by_torque(model, work, j)
        _fill_matrix(model, work, step)
        if model.count[TURN] > 0:
            _turn_wire(work)
        if not factorise_pivoted(newton.matrix, newton.pivot):
            return False
        solve_pivoted(newton.matrix, newton.pivot, newton.right)
        change = np.abs(newton.right).max()
        for j in range(joints):
            for i in range(3):
                nodes.torque[i, j] += newton.right[i * joints + j]
            fill_angles(model, work, j)
    if not change <= 1e-10 * scale:
        return False
    fill_drives(model, work, NO)
    if tangents:
        _fill_tangents(model, work, step)
        fill_drives(model, work, YES)
    return True


@compiled
def _fill_residual(model: Model, work: Work, step: float) -> float:
    """Write what torques miss; return their size."""
    nodes, balance, newton = work.nodes, work.balance, work.newton
    joints = work.state.offset.size
    for k in range(model.count[TURN]):
        call_turn(model.hook[TURN, k], model, nodes)
    if model.inertial:
        for i in range(3):
            for j in range(joints):
                total = 0.0
                for k in range(3):
                    gained = nodes.velocity[k, j] - work.state.velocity[j]
                    total += DIFFERENTIATE[i, k] * gained
                nodes.acceleration[i, j] = total / step
    scale = 1e-300
    for i in range(3):
        fill_balance(model, nodes, balance, i, NO)
        for j in range(joints):
            newton.right[i * joints + j] = balance.torque[i, j] - nodes.torque[i, j]
            scale = max(scale, abs(nodes.torque[i, j]), abs(nodes.load[i]))
    return scale


@compiled
def _fill_matrix(model: Model, work: Work, step: float) -> None:
    """Write the slopes of torque − balance by torques."""
    balance, newton = work.balance, work.newton
    joints = work.state.offset.size
    matrix, by_angle = newton.matrix, newton.angle_by_torque
    for i in range(3):
        for j in range(joints):
            row = i * joints + j
            for m in range(3):
                for k in range(joints):
                    value = balance.by_angle[i, j, k] * by_angle[k, i, m]
                    if model.inertial:
                        by_velocity = newton.velocity_by_torque[k]
                        value += balance.by_velocity[i, j, k] * by_velocity[i, m]
                        for n in range(3):
                            speed_up = DIFFERENTIATE[i, n] / step * by_velocity[n, m]
                            value += balance.by_acceleration[i, j, k] * speed_up
                    matrix[row, m * joints + k] = -value
            matrix[row, row] += 1.0


@compiled
def _turn_wire(work: Work) -> None:
    """Add to the matrix what turns of the wire do."""
    nodes, balance, newton = work.nodes, work.balance, work.newton
    joints = work.state.offset.size
    for i in range(3):
        for n in range(i + 1):
            for j in range(joints):
                turn = 0.0
                for k in range(joints):  # its motion slides the wire past itself and those before
                    turn += balance.by_direction[i, j, k] * nodes.by_motion[i, n, k]
                    for m in range(3):
                        followed = turn * newton.angle_by_torque[k, n, m]
                        newton.matrix[i * joints + j, m * joints + k] -= followed


@compiled
def _fill_tangents(model: Model, work: Work, step: float) -> None:
    """Write how nodes move along each column."""
    nodes, newton = work.nodes, work.newton
    joints = work.state.offset.size
    for j in range(joints):
        fill_tangents_at_fixed_torque(model, work, step, j)
        if not model.feedback:
            fill_slopes_by_torque(model, work, j)
    if model.feedback:
        for i in range(3):
            fill_balance(model, nodes, work.balance, i, YES)
    rights = newton.rights
    if model.feedback:
        _fill_right_sides(model, work, step)
        solve_columns(newton.matrix, newton.pivot, rights)
    else:  # the torque is the load
        for i in range(3):
            rights[i * joints : (i + 1) * joints] = nodes.d_load[i]
    for j in range(joints):
        for i in range(3):
            nodes.d_torque[i, j] = rights[i * joints + j]
            add_scaled(nodes.flow_slope[i, j], rights[i * joints + j], nodes.d_flow[i, j])
        follow_torque(newton.spring_by_torque[j], rights, nodes.d_spring, j)
        follow_torque(newton.angle_by_torque[j], rights, nodes.d_angle, j)
        follow_torque(newton.velocity_by_torque[j], rights, nodes.d_velocity, j)


@compiled
def _fill_right_sides(model: Model, work: Work, step: float) -> None:
    """Write the balance's columns at fixed torques."""
    nodes, balance, newton, state = work.nodes, work.balance, work.newton, work.state
    joints = state.offset.size
    for i in range(3):
        if model.count[TURN] > 0:
            follow_slides(nodes, i, newton.way)
        for j in range(joints):
            change = newton.rights[i * joints + j]
            change[:] = balance.tangent[i, j]
            add_scaled(balance.by_load[i, j], nodes.d_load[i], change)
            for k in range(joints):
                add_scaled(balance.by_angle[i, j, k], nodes.d_angle[i, k], change)
                if model.count[TURN] > 0 and balance.by_direction[i, j, k] != 0.0:
                    add_scaled(balance.by_direction[i, j, k], newton.way[k], change)
                if model.inertial:
                    add_scaled(balance.by_velocity[i, j, k], nodes.d_velocity[i, k], change)
                    for n in range(3):
                        faster = balance.by_acceleration[i, j, k] * DIFFERENTIATE[i, n] / step
                        add_scaled(faster, nodes.d_velocity[n, k], change)
                        add_scaled(-faster, state.d_velocity[k], change)
