"""What moves one trial; zero switches it off."""

from typing import Any, NamedTuple

import numpy as np

from softfinger.concealed.arrays import Array


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
    lag_times: Array  # (stage,) [s] of first-order lags in a row, between logged and acting tension
    lag_mix: Array  # (stage,) shares of the acting tension
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
    # Laws as tables, uniform in their argument as `kernel` scales it; of no rows: absent.
    arm_law: Array  # (joint, point) share of the offset that the moment arm gains, of the angle
    spring_law: Array  # (joint, point) share of its torque that a spring gains, of the strain
    damper_law: Array  # (joint, point) share of its rate that a Voigt element gains, of the rate
    flow_law: Array  # (joint, point) share of its rate that a dashpot gains, of the torque
    stop_law: Array  # (joint, point) [N m] against the bend, of the angle
    drag_law: Array  # (1, point) [rad] of bend that friction counts, of the angle
    membrane_law: Array  # (1, point) [rad] that a membrane strains, of the neighbours' difference
    membrane: Array  # (joint, joint) [N m/rad]
    friction_back: float  # friction of a wire that is let go, over that of one that is pulled
    plastic: Array  # share of the strain beyond a threshold that stays
    plastic_from: float  # [rad] that threshold
    dry: Array  # [N m] friction of a joint on its support
    thixotropy: Array  # share of its rate that a dashpot gains as its structure breaks
    breaking: float  # [1/rad] of flow, that breaks the structure
    healing: float  # [1/s]
    softening: Array  # share of the stiffness that is lost while a trial runs
    thinning_out: Array  # share of the viscosities
    warming: tuple[float, float, float, float]  # rate [1/s], its power, heat [1/rad], cooling [1/s]
    tendon: float  # [N m/rad] of a second wire, taut beyond a bend
    tendon_slack: float  # [rad] of all joints together
    one_way: Array  # share by which a Voigt element bends faster than it returns
    payload: float  # [kg] at the tip
    rod_centre: Array  # place of each link's centre of mass, over half of its length
    rotor: Array  # [kg m²] that turns with a joint alone


def build_plain_physics(
    parameters: Array,
    load_time: Array,
    load_tension: Array,
    link_length: Array,
    link_mass: Array,
    wire_offset: float,
    joint_length: float,
) -> Physics:
    """Physics of the paper's step solution.

    No law beyond the three elements is switched on.

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
    k_v, c_v, c_p, q_ini = (np.ascontiguousarray(row, dtype=float) for row in parameters)
    return Physics(
        k_v=k_v,
        c_v=c_v,
        c_p=c_p,
        q_ini=q_ini,
        load_time=np.ascontiguousarray(load_time, dtype=float),
        load_tension=np.ascontiguousarray(load_tension, dtype=float),
        link_length=np.ascontiguousarray(link_length, dtype=float),
        link_mass=np.ascontiguousarray(link_mass, dtype=float),
        wire_offset=float(wire_offset),
        joint_length=float(joint_length),
        **_switch_off(parameters.shape[1]),
    )


PER_JOINT = (
    *("residual", "stiffening", "mullins", "thinning", "yield_torque", "flow_scale", "friction"),
    *("stop_stiffness", "stop_angle", "plastic", "dry", "thixotropy", "softening"),
    *("thinning_out", "one_way", "rotor"),
)
TABLES = (
    *("arm_law", "spring_law", "damper_law", "flow_law", "stop_law", "drag_law", "membrane_law"),
)
ZERO = (
    *("arm_scale", "gravity_x", "gravity_y", "inertia_scale", "ripple", "ripple_rate"),
    *("ripple_phase", "plastic_from", "breaking", "healing", "tendon", "tendon_slack", "payload"),
)


def _switch_off(joints: int) -> dict[str, Any]:
    """Every law's parameters at which it is not there."""
    none, no_law = np.zeros(joints), np.zeros((0, 0))
    return {
        **dict.fromkeys(PER_JOINT, none),
        **dict.fromkeys(TABLES, no_law),
        **dict.fromkeys(ZERO, 0.0),
        "lag_times": np.zeros(0),
        "lag_mix": np.zeros(0),
        "compliance": np.zeros((0, joints)),
        "retardation_time": np.zeros(0),
        "friction_power": 1.0,
        "friction_width": 0.02,
        "coupling": np.zeros((joints, joints)),
        "membrane": np.zeros((joints, joints)),
        "friction_back": 1.0,
        "warming": (0.0, 1.0, 0.0, 0.0),
        "rod_centre": np.ones(joints),
    }
