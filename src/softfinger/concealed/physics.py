"""What moves one trial of a concealed campaign; a law is off where its amount is zero."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Physics(NamedTuple):
    """Parameters of the proof's own equations of motion.

    Arrays run over joints unless said otherwise; SI units and radians; angles counter-clockwise.
    """

    k_v: Array
    c_v: Array
    c_p: Array
    q_ini: Array
    load_time: Array  # (knot,)
    load_tension: Array  # (knot,)
    link_length: Array
    link_mass: Array
    wire_offset: float
    joint_length: float
    arm_scale: float  # 0: the moment arm is the wire offset; 1: the wire runs along the chord
    lag: float  # [s] between the logged and the acting tension
    residual: Array  # [rad] strain of the Voigt elements when the trial starts
    compliance: Array  # (element, joint) [rad/(N m)] of further Voigt elements
    retardation_time: Array  # (element,)
    stiffening: Array  # [1/rad²]
    mullins: Array  # share of the stiffness that is lost where the joint was strained before
    thinning: Array  # [s/rad] of the Voigt damper
    yield_torque: Array
    flow_scale: Array  # [1/(N m)]
    friction: Array  # coefficient where the wire passes a joint, at `kernel.FRICTION_TENSION_N`
    friction_power: float  # of the pressure, to which friction grows; 1: Coulomb's
    friction_width: float  # [rad] of motion that turns the friction round
    stop_stiffness: Array  # [N m/rad^1.5]
    stop_angle: Array
    coupling: Array  # (joint, joint) [N m/rad]
    gravity_x: float  # [m/s²] in the picture's plane, along the base
    gravity_y: float  # across it
    inertia_scale: float  # 0: massless
    ripple: float  # share of the tension
    ripple_rate: float  # [rad/s]
    ripple_phase: float


def build_plain_physics(
    parameters: Array,
    load_time: Array,
    load_tension: Array,
    link_length: Array,
    link_mass: Array,
    wire_offset: float,
    joint_length: float,
) -> Physics:
    """Physics of the paper's step solution: no law beyond the three elements is switched on.

    Parameters
    ----------
    parameters : array (4, joint)
        k_v [N m/rad], c_v, c_p [N m s/rad], q_ini [rad].
    load_time, load_tension : array (knot,)
        Straight lines between knots; a jump is a repeated time [s], [N].
    link_length, link_mass : array (joint,)
        [m], [kg].
    wire_offset, joint_length : float
        [m].
    """
    joints = parameters.shape[1]
    none = np.zeros(joints)
    k_v, c_v, c_p, q_ini = (np.ascontiguousarray(row, dtype=float) for row in parameters)
    return Physics(
        k_v=k_v,
        c_v=c_v,
        c_p=c_p,
        q_ini=q_ini,
        load_time=np.asarray(load_time, dtype=float),
        load_tension=np.asarray(load_tension, dtype=float),
        link_length=np.asarray(link_length, dtype=float),
        link_mass=np.asarray(link_mass, dtype=float),
        wire_offset=float(wire_offset),
        joint_length=float(joint_length),
        arm_scale=0.0,
        lag=0.0,
        residual=none,
        compliance=np.zeros((0, joints)),
        retardation_time=np.zeros(0),
        stiffening=none,
        mullins=none,
        thinning=none,
        yield_torque=none,
        flow_scale=none,
        friction=none,
        friction_power=1.0,
        friction_width=0.02,
        stop_stiffness=none,
        stop_angle=none,
        coupling=np.zeros((joints, joints)),
        gravity_x=0.0,
        gravity_y=0.0,
        inertia_scale=0.0,
        ripple=0.0,
        ripple_rate=0.0,
        ripple_phase=0.0,
    )
