"""From torques to angles at nodes, by joint."""

from softfinger.compiled import compiled
from softfinger.mechanics.forward.hooks import FLOW as FLOWS
from softfinger.mechanics.forward.modes import FLOW, VOIGT
from softfinger.mechanics.forward.phi import NODES as _SHARES
from softfinger.mechanics.forward.phi import TO_MONOMIAL, mode_response, phi_functions
from softfinger.mechanics.forward.spring import (
    fill_voigt_tangents,
    flow_drive,
    has_curved_voigt,
    voigt_torque,
)
from softfinger.mechanics.forward.tangents import (
    add_rates,
    add_responses,
    add_scaled,
    combine_nodes,
    sum_modes,
)
from softfinger.mechanics.forward.work import START, Model, Work
from softfinger.mechanics.linear import factorise, solve_factorised

TORQUE = 2
"""Of the drives: 0 is of the Voigt element, 1 of the dashpot, 2 the torque itself."""


@compiled
def drive_of(mode: int) -> int:
    """Which drive a mode follows."""
    return mode if mode <= FLOW else TORQUE


@compiled
def fill_weights(model: Model, work: Work, step: float) -> None:
    """Write the modes at nodes, and unit drives' part."""
    linear, inertial = work.linear, model.inertial
    linear.base[:] = 0.0
    linear.weight[:] = 0.0
    if inertial:
        linear.rate_weight[:] = 0.0
    joints, modes = linear.rate.shape
    for j in range(joints):
        for i in range(3):
            linear.base[1, j, i] = work.state.offset[j]
        for mode in range(modes):
            rate, gain = linear.rate[j, mode], linear.gain[j, mode]
            start, drive = work.state.mode[j, mode], drive_of(mode)
            for i in range(3):
                share = _SHARES[i]
                span = step * share
                decay, p1, p2, p3, _ = phi_functions(rate * span)
                w0, w1, w2 = span * p1, span * share * p2, 2.0 * span * share * share * p3
                linear.base[1, j, i] += decay * start
                linear.base[2, j, i] -= rate * decay * start
                if mode == VOIGT:
                    linear.base[0, j, i] = decay * start
                for m in range(3):
                    unit = w0 * TO_MONOMIAL[0, m] + w1 * TO_MONOMIAL[1, m] + w2 * TO_MONOMIAL[2, m]
                    linear.weight[drive, j, i, m] += gain * unit
                    if inertial:
                        linear.rate_weight[drive, j, i, m] -= rate * gain * unit
                if inertial:
                    linear.rate_weight[drive, j, i, i] += gain


@compiled
def fill_angles(model: Model, work: Work, j: int) -> None:
    """Write joint j's nodes from its torque."""
    nodes, linear = work.nodes, work.linear
    for i in range(3):
        nodes.flow[i, j], nodes.flow_slope[i, j] = flow_drive(
            model, work, j, nodes.time[i], nodes.torque[i, j], work.none
        )
    bent = has_curved_voigt(model)
    for _ in range(30 if bent else 1):
        for i in range(3):
            elastic, angle = linear.base[0, j, i], linear.base[1, j, i]
            for m in range(3):
                own = linear.weight[0, j, i, m] * (nodes.torque[m, j] - nodes.spring[m, j])
                elastic += own
                angle += own + linear.weight[1, j, i, m] * nodes.flow[m, j]
                angle += linear.weight[TORQUE, j, i, m] * nodes.torque[m, j]
            nodes.elastic[i, j], nodes.angle[i, j] = elastic, angle
        if not bent or _correct_spring(model, work, j):
            break
    if model.inertial:
        for i in range(3):
            velocity = linear.base[2, j, i]
            for m in range(3):
                own = nodes.torque[m, j] - nodes.spring[m, j]
                velocity += linear.rate_weight[0, j, i, m] * own
                velocity += linear.rate_weight[1, j, i, m] * nodes.flow[m, j]
                velocity += linear.rate_weight[TORQUE, j, i, m] * nodes.torque[m, j]
            nodes.velocity[i, j] = velocity


@compiled
def _correct_spring(model: Model, work: Work, j: int) -> bool:
    """One Newton step for spring torque; True: at rest."""
    nodes, local, slope = work.nodes, work.newton.local, work.nodes.spring_slope
    missing = work.newton.column
    worst, scale = 0.0, 0.0
    for i in range(3):
        torque, slope[2, i, j], slope[0, i, j], slope[1, i, j] = voigt_torque(
            model, work, j, nodes.time[i], nodes.torque[i, j], nodes.elastic[i, j],
            nodes.angle[i, j],
        )  # fmt: skip
        missing[i] = torque - nodes.spring[i, j]
        worst, scale = (
            max(worst, abs(missing[i])),
            max(scale, abs(nodes.torque[i, j]) + abs(torque)),
        )
    if not worst > 1e-13 * scale:
        return True
    fill_local(work, j)
    factorise(local)
    solve_factorised(local, missing)
    for i in range(3):
        nodes.spring[i, j] += missing[i]
    return False


@compiled
def fill_local(work: Work, j: int) -> None:
    """Write the system of the spring's torque.

    It is I + (∂n/∂q_v + ∂n/∂q) W, at the nodes.
    """
    local, slope = work.newton.local, work.nodes.spring_slope
    for i in range(3):
        steep = slope[0, i, j] + slope[1, i, j]
        for m in range(3):
            local[i, m] = steep * work.linear.weight[0, j, i, m] + (1.0 if i == m else 0.0)


@compiled
def fill_slopes_by_torque(model: Model, work: Work, j: int) -> None:
    """Write how joint j's nodes follow its torque."""
    nodes, linear, newton = work.nodes, work.linear, work.newton
    weight, rate_weight = linear.weight[:, j], linear.rate_weight[:, j]
    by_spring, by_angle = newton.spring_by_torque[j], newton.angle_by_torque[j]
    for i in range(3):
        for m in range(3):
            whole = weight[0, i, m] + weight[TORQUE, i, m]
            by_angle[i, m] = whole + weight[1, i, m] * nodes.flow_slope[m, j]
            by_spring[i, m] = nodes.spring_slope[0, i, j] * weight[0, i, m]
            by_spring[i, m] += nodes.spring_slope[1, i, j] * by_angle[i, m]
        by_spring[i, i] += nodes.spring_slope[2, i, j]
    if has_curved_voigt(model):
        fill_local(work, j)
        factorise(newton.local)
        for m in range(3):
            column = newton.column
            column[:] = by_spring[:, m]
            solve_factorised(newton.local, column)
            by_spring[:, m] = column
        for i in range(3):
            for m in range(3):
                for k in range(3):
                    by_angle[i, m] -= weight[0, i, k] * by_spring[k, m]
    if model.inertial:
        by_velocity = newton.velocity_by_torque[j]
        for i in range(3):
            for m in range(3):
                by_velocity[i, m] = rate_weight[0, i, m] + rate_weight[TORQUE, i, m]
                by_velocity[i, m] += rate_weight[1, i, m] * nodes.flow_slope[m, j]
                for k in range(3):
                    by_velocity[i, m] -= rate_weight[0, i, k] * by_spring[k, m]


@compiled
def fill_tangents_at_fixed_torque(model: Model, work: Work, step: float, j: int) -> None:
    """Write joint j's columns at fixed torque."""
    nodes, linear, state = work.nodes, work.linear, work.state
    response, motion = work.response, work.motion
    d_mode, d_rate, d_gain = state.d_mode[j], linear.d_rate[j], linear.d_gain[j]
    inertial = model.inertial
    for i in range(3):
        nodes.d_angle[i, j] = state.d_offset[j]
        nodes.d_velocity[i, j] = 0.0
        nodes.d_spring[i, j] = 0.0
        nodes.d_flow[i, j] = 0.0
        if model.count[FLOWS] > 0:
            flow_drive(model, work, j, nodes.time[i], nodes.torque[i, j], nodes.d_flow[i, j])
        for mode in range(linear.rate.shape[1]):
            rate, gain, drive = linear.rate[j, mode], linear.gain[j, mode], drive_of(mode)
            d0, d1, d2 = linear.drive[j, drive]
            x, response[mode, 0], response[mode, 1], response[mode, 2], _, _, _ = mode_response(
                rate, step * _SHARES[i], _SHARES[i], state.mode[j, mode], gain, d0, d1, d2
            )
            motion[mode, 0], motion[mode, 2] = rate, x
            motion[mode, 1] = d0 + _SHARES[i] * (d1 + _SHARES[i] * d2)
        nodes.d_elastic[i, j] = 0.0
        voigt = slice(VOIGT, VOIGT + 1)
        add_responses(
            response[voigt], d_mode[voigt], d_rate[voigt], d_gain[voigt], nodes.d_elastic[i, j]
        )
        add_responses(response, d_mode, d_rate, d_gain, nodes.d_angle[i, j])
        if inertial:
            add_rates(response, motion, d_mode, d_rate, d_gain, nodes.d_velocity[i, j])
    combine_nodes(linear.weight[1, j], nodes.d_flow, nodes.d_angle, j)
    if inertial:
        combine_nodes(linear.rate_weight[1, j], nodes.d_flow, nodes.d_velocity, j)
    if has_curved_voigt(model):
        _add_spring_tangents(model, work, j)


@compiled
def _add_spring_tangents(model: Model, work: Work, j: int) -> None:
    nodes, linear, local = work.nodes, work.linear, work.newton.local
    column = work.newton.column
    for i in range(3):
        fill_voigt_tangents(
            model, work, j, nodes.time[i], nodes.torque[i, j], nodes.elastic[i, j],
            nodes.angle[i, j], nodes.d_spring[i, j],
        )  # fmt: skip
        add_scaled(nodes.spring_slope[0, i, j], nodes.d_elastic[i, j], nodes.d_spring[i, j])
        add_scaled(nodes.spring_slope[1, i, j], nodes.d_angle[i, j], nodes.d_spring[i, j])
    fill_local(work, j)
    factorise(local)
    for c in model.columns[j]:
        for i in range(3):
            column[i] = nodes.d_spring[i, j, c]
        solve_factorised(local, column)
        for i in range(3):
            nodes.d_spring[i, j, c] = column[i]
    for i in range(3):
        for m in range(3):
            own = linear.weight[0, j, i, m]
            add_scaled(-own, nodes.d_spring[m, j], nodes.d_elastic[i, j])
            add_scaled(-own, nodes.d_spring[m, j], nodes.d_angle[i, j])
            rate = linear.rate_weight[0, j, i, m]
            add_scaled(-rate, nodes.d_spring[m, j], nodes.d_velocity[i, j])


@compiled
def fill_drives(model: Model, work: Work, tangents: bool) -> None:
    """Write the modes' drives as quadratics, from nodes."""
    nodes, linear = work.nodes, work.linear
    for j in range(linear.rate.shape[0]):
        for power in range(3):
            linear.drive[j, :, power] = 0.0
            for m in range(3):
                weight, torque = TO_MONOMIAL[power, m], nodes.torque[m, j]
                linear.drive[j, 0, power] += weight * (torque - nodes.spring[m, j])
                linear.drive[j, 1, power] += weight * nodes.flow[m, j]
                linear.drive[j, 2, power] += weight * torque
            if tangents:
                own, flow, whole = linear.d_drive[j, 0], linear.d_drive[j, 1], linear.d_drive[j, 2]
                flow[power], whole[power] = 0.0, 0.0
                for m in range(3):
                    weight = TO_MONOMIAL[power, m]
                    add_scaled(weight, nodes.d_flow[m, j], flow[power])
                    add_scaled(weight, nodes.d_torque[m, j], whole[power])
                own[power] = whole[power]
                for m in range(3):
                    add_scaled(-TO_MONOMIAL[power, m], nodes.d_spring[m, j], own[power])


@compiled
def fill_start(model: Model, work: Work, tangents: bool) -> None:
    """Write a step's first angles, from the state."""
    nodes, state = work.nodes, work.state
    for j in range(state.offset.size):
        nodes.elastic[START, j] = state.mode[j, VOIGT]
        nodes.angle[START, j] = state.offset[j] + state.mode[j].sum()
        if tangents:
            nodes.d_elastic[START, j] = state.d_mode[j, VOIGT]
            nodes.d_angle[START, j] = state.d_offset[j]
            sum_modes(state.d_mode[j], nodes.d_angle[START, j])
