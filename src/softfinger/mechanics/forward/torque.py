"""The torque that statics asks of each joint: pulled wire, gravity, coupling, stop, inertia.

Each term adds its value to `Balance`, its derivatives by joint angle, velocity, acceleration, wire
direction and load, and, where tangents are wanted, its change along each column at fixed angles.
"""

import math

import numpy as np

from softfinger.compiled import compiled
from softfinger.mechanics.chain import fill_inertia_and_nonlinear_term, fill_slopes
from softfinger.mechanics.forward.curve import combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.laws import softplus
from softfinger.mechanics.forward.modes import LOG_K_V, Q_INI
from softfinger.mechanics.forward.slots import CHAIN_SLOTS, COUPLING_SLOTS, JOINT_SLOTS, LAWS
from softfinger.mechanics.forward.work import (
    HAS_ARM,
    HAS_ARM_LAW,
    HAS_COUPLING,
    HAS_GRAVITY,
    HAS_INERTIA,
    HAS_LAW,
    HAS_STOP,
    Balance,
    Model,
    Nodes,
)

GRAVITY = 9.80665  # [m/s²]
_ARM = JOINT_SLOTS.index("arm_scale")
_ARM_REACH = JOINT_SLOTS.index("arm_reach")
_MOMENT = JOINT_SLOTS.index("moment_share")
_STOP_REACH = JOINT_SLOTS.index("stop_reach")
_STOP_ANGLE = JOINT_SLOTS.index("stop_angle")
_STOP_STIFFNESS = JOINT_SLOTS.index("stop_stiffness")
_STOP_WIDTH = JOINT_SLOTS.index("stop_width")
_BEND = CHAIN_SLOTS.index("friction_bend")
_CONSTANT = CHAIN_SLOTS.index("friction_constant")
_FORCE = CHAIN_SLOTS.index("friction_force")
_REACH = CHAIN_SLOTS.index("friction_reach")
_OWN = CHAIN_SLOTS.index("friction_own")
_ALONG = CHAIN_SLOTS.index("tilt_along")
_ACROSS = CHAIN_SLOTS.index("tilt_across")
_INERTIA = CHAIN_SLOTS.index("inertia_scale")
_STIFFNESS = COUPLING_SLOTS.index("coupling_stiffness")
_SHARE = COUPLING_SLOTS.index("coupling_share")
_SATURATION = COUPLING_SLOTS.index("coupling_saturation")
_MEMBRANE = COUPLING_SLOTS.index("membrane_stiffness")
_MEMBRANE_SHARE = COUPLING_SLOTS.index("membrane_share")
_ARM_LAW, _STOP_LAW = LAWS.index("arm_law"), LAWS.index("stop_law")
_FRICTION_LAW = LAWS.index("friction_law")


@compiled
def fill_balance(model: Model, nodes: Nodes, balance: Balance, i: int, tangents: bool) -> None:
    """Write row i of the balance from row i of the nodes."""
    balance.torque[i] = 0.0
    balance.by_angle[i] = 0.0
    balance.by_direction[i] = 0.0
    balance.tangent[i] = 0.0
    _add_pull(model, nodes, balance, i, tangents)
    if model.groups[HAS_STOP]:
        _add_stop(model, nodes, balance, i, tangents)
    if model.groups[HAS_GRAVITY]:
        _add_gravity(model, nodes, balance, i, tangents)
    if model.groups[HAS_COUPLING]:
        _add_coupling(model, nodes, balance, i, tangents)
    if model.groups[HAS_INERTIA]:
        _add_inertia(model, nodes, balance, i, tangents)


@compiled
def _add_pull(model: Model, nodes: Nodes, balance: Balance, i: int, tangents: bool) -> None:
    """The wire: u e^{−s B} less the Coulomb loss, times the growth of the moment arm.

    B depends on the bends that the wire has passed; s is the direction of its motion (1 = pulled).
    The arm grows as 1 + arm_scale (cos(q/2) + l/(2d) sin(q/2) − 1) + law of q.
    """
    load, way = nodes.load[i], nodes.direction[i]
    size, sign = abs(load), math.copysign(1.0, load)
    bend, constant = model.chain[_BEND], model.chain[_CONSTANT]
    force, own = model.chain[_FORCE], model.chain[_OWN]
    passed = 0.0  # Σ |q| of the joints before
    for j in range(model.joint.shape[0]):
        angle = nodes.angle[i, j]
        count, turned = j + own, passed + own * abs(angle)
        passed += abs(angle)
        x = turned / model.chain[_REACH]
        law = model.law[j, _FRICTION_LAW]
        exponent = bend * turned + constant * count + combine(law, weigh_value(x))
        steeper = bend + combine(law, weigh_slope(x)) / model.chain[_REACH]
        kept = math.exp(-way * sign * exponent)
        drag = force * count
        held = size / (size + drag) if drag > 0.0 else 1.0
        pull = load * kept - way * drag * held
        growth, steep = 0.0, 0.0
        if model.groups[HAS_ARM]:
            growth = math.cos(angle / 2) + model.arm_ratio * math.sin(angle / 2) - 1.0
            steep = (model.arm_ratio * math.cos(angle / 2) - math.sin(angle / 2)) / 2
        arm, arm_slope = 1.0 + model.joint[j, _ARM] * growth, model.joint[j, _ARM] * steep
        at = angle / model.joint[j, _ARM_REACH]
        if model.groups[HAS_ARM_LAW]:
            arm += combine(model.law[j, _ARM_LAW], weigh_value(at))
            climb = combine(model.law[j, _ARM_LAW], weigh_slope(at))
            arm_slope += climb / model.joint[j, _ARM_REACH]
        lost = arm * size * kept  # −d(pull)/d(s B)
        balance.torque[i, j] = pull * arm
        held_slope = (1.0 - held) ** 2 * sign
        balance.by_load[i, j] = arm * (kept - way * held_slope)
        balance.by_direction[i, j] = -lost * exponent - arm * drag * held
        for k in range(j + 1):
            part = own if k == j else 1.0
            lean = math.copysign(part, nodes.angle[i, k])
            balance.by_angle[i, j, k] -= lost * way * steeper * lean
        balance.by_angle[i, j, j] += pull * arm_slope
        if tangents:
            d_bend, d_constant = -lost * way * turned, -lost * way * count
            d_force = -arm * way * count * held * held
            for c in model.columns[j]:
                change = pull * growth * model.d_joint[c, j, _ARM]
                change += d_bend * model.d_chain[c, _BEND]
                change += d_constant * model.d_chain[c, _CONSTANT]
                if model.groups[HAS_LAW]:
                    d_law = model.d_law[c, j]
                    change += pull * combine(d_law[_ARM_LAW], weigh_value(at))
                    change -= lost * way * combine(d_law[_FRICTION_LAW], weigh_value(x))
                balance.tangent[i, j, c] = change + d_force * model.d_chain[c, _FORCE]


@compiled
def _add_stop(model: Model, nodes: Nodes, balance: Balance, i: int, tangents: bool) -> None:
    """A stop that takes K (1 + law of the depth) times the (softly rectified) angle beyond it."""
    for j in range(model.joint.shape[0]):
        stiffness = model.joint[j, _STOP_STIFFNESS]
        beyond = nodes.angle[i, j] - model.joint[j, _STOP_ANGLE]
        depth, touch = softplus(beyond, model.joint[j, _STOP_WIDTH])
        reach, law = model.joint[j, _STOP_REACH], model.law[j, _STOP_LAW]
        harder = 1.0 + combine(law, weigh_value(depth / reach))
        steep = harder + depth * combine(law, weigh_slope(depth / reach)) / reach
        balance.torque[i, j] -= stiffness * depth * harder
        balance.by_angle[i, j, j] -= stiffness * touch * steep
        if tangents:
            for c in model.columns[j]:
                by_law = combine(model.d_law[c, j, _STOP_LAW], weigh_value(depth / reach))
                balance.tangent[i, j, c] += (
                    stiffness * touch * steep * model.d_joint[c, j, _STOP_ANGLE]
                    - depth * harder * model.d_joint[c, j, _STOP_STIFFNESS]
                    - stiffness * depth * by_law
                )


@compiled
def _add_gravity(model: Model, nodes: Nodes, balance: Balance, i: int, tangents: bool) -> None:
    """Weight of a tilted plane: Σ over links beyond of g μ_k (−sin α sin θ_k + sin β cos θ_k).

    μ_k are the first moments of the declared masses, times 1 + moment_share.
    """
    joints = model.joint.shape[0]
    along, across = math.sin(model.chain[_ALONG]), math.sin(model.chain[_ACROSS])
    turn_along, turn_across = math.cos(model.chain[_ALONG]), math.cos(model.chain[_ACROSS])
    direction = 0.0
    for k in range(joints):
        direction += nodes.angle[i, k]
        unit = GRAVITY * model.moment[k]
        weight = unit * (1.0 + model.joint[k, _MOMENT])
        push = unit * (across * math.cos(direction) - along * math.sin(direction))
        sine, cosine = weight * math.sin(direction), weight * math.cos(direction)
        for j in range(k + 1):
            balance.torque[i, j] += across * cosine - along * sine
            for other in range(k + 1):
                balance.by_angle[i, j, other] -= across * sine + along * cosine
            if tangents:
                for c in model.columns[j]:
                    balance.tangent[i, j, c] += (
                        push * model.d_joint[c, k, _MOMENT]
                        + turn_across * cosine * model.d_chain[c, _ACROSS]
                        - turn_along * sine * model.d_chain[c, _ALONG]
                    )


@compiled
def _add_coupling(model: Model, nodes: Nodes, balance: Balance, i: int, tangents: bool) -> None:
    """Torque from the other joints' motion x = q − q_ini: Σ (K + c k_v) x / (1 + b |x|).

    A membrane adds Σ (M + m √(k_v k_v,k)) (x_k − x).
    """
    joints = model.joint.shape[0]
    for j in range(joints):
        own = math.exp(model.joint[j, LOG_K_V])
        for k in range(joints):
            share = model.coupling[_SHARE, j, k]
            stiffness = model.coupling[_STIFFNESS, j, k] + share * own
            moved = nodes.angle[i, k] - model.joint[k, Q_INI]
            ease = 1.0 / (1.0 + model.coupling[_SATURATION, j, k] * abs(moved))
            slope = stiffness * ease**2
            balance.torque[i, j] += stiffness * moved * ease
            balance.by_angle[i, j, k] += slope
            if tangents:
                for c in model.columns[j]:
                    change = model.d_coupling[c, _STIFFNESS, j, k]
                    change += own * model.d_coupling[c, _SHARE, j, k]
                    change += share * own * model.d_joint[c, j, LOG_K_V]
                    change *= moved * ease
                    bent = abs(moved) * moved * model.d_coupling[c, _SATURATION, j, k]
                    change -= slope * (bent + model.d_joint[c, k, Q_INI])
                    balance.tangent[i, j, c] += change
            if k != j:
                _add_membrane(model, nodes, balance, i, j, k, tangents)


@compiled
def _add_membrane(
    model: Model, nodes: Nodes, balance: Balance, i: int, j: int, k: int, tangents: bool
) -> None:
    """What joint k's motion, less its own, adds to the torque of joint j."""
    mean = math.exp(0.5 * (model.joint[j, LOG_K_V] + model.joint[k, LOG_K_V]))
    share = model.coupling[_MEMBRANE_SHARE, j, k]
    stiffness = model.coupling[_MEMBRANE, j, k] + share * mean
    apart = nodes.angle[i, k] - model.joint[k, Q_INI] - nodes.angle[i, j] + model.joint[j, Q_INI]
    balance.torque[i, j] += stiffness * apart
    balance.by_angle[i, j, k] += stiffness
    balance.by_angle[i, j, j] -= stiffness
    if tangents:
        for c in model.columns[j]:
            change = model.d_coupling[c, _MEMBRANE, j, k]
            change += mean * model.d_coupling[c, _MEMBRANE_SHARE, j, k]
            stiffer = model.d_joint[c, j, LOG_K_V] + model.d_joint[c, k, LOG_K_V]
            change = (change + 0.5 * share * mean * stiffer) * apart
            change += stiffness * (model.d_joint[c, j, Q_INI] - model.d_joint[c, k, Q_INI])
            balance.tangent[i, j, c] += change


@compiled
def _add_inertia(model: Model, nodes: Nodes, balance: Balance, i: int, tangents: bool) -> None:
    """What the links' acceleration takes: −scale (M(q) q̈ + h(q, q̇))."""
    joints = model.joint.shape[0]
    scale = model.chain[_INERTIA]
    matrix, term = np.empty((joints, joints)), np.empty(joints)
    by_angle, by_velocity = np.empty((joints, joints)), np.empty((joints, joints))
    angle, velocity, acceleration = nodes.angle[i], nodes.velocity[i], nodes.acceleration[i]
    fill_inertia_and_nonlinear_term(angle, velocity, model.inertia, matrix, term)
    fill_slopes(angle, velocity, acceleration, model.inertia, by_angle, by_velocity)
    for j in range(joints):
        taken = term[j]
        for k in range(joints):
            taken += matrix[j, k] * acceleration[k]
            balance.by_angle[i, j, k] -= scale * by_angle[j, k]
            balance.by_velocity[i, j, k] = -scale * by_velocity[j, k]
            balance.by_acceleration[i, j, k] = -scale * matrix[j, k]
        balance.torque[i, j] -= scale * taken
        if tangents:
            for c in model.columns[j]:
                balance.tangent[i, j, c] -= taken * model.d_chain[c, _INERTIA]


@compiled
def turn_direction(way: float, motion: float, width: float) -> tuple[float, float, float, float]:
    """Dahl's friction state after a motion: it nears the motion's sign as 1 − (1 − s) e^{−|x|/w}.

    Returns the state and its derivatives by the state before, the motion and the width.
    """
    sign = math.copysign(1.0, motion)
    decay = math.exp(-abs(motion) / width)
    by_motion = (1.0 - sign * way) * decay / width
    after = sign + (way - sign) * decay
    return after, decay, by_motion, -by_motion * motion / width
