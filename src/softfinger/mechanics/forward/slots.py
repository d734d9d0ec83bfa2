"""The slots of the forward model: every physics that may be left out, as numbers with a null value.

With every slot at its null the model is the paper's joint under a constant moment arm. Slots are
plain data: any two, or all, combine without compiling anything anew. A `joint` slot has one value
for each trial and joint, a `chain` slot one for each trial, a `coupling` slot one for each trial,
joint and other joint. A `law` slot is a whole curve for each trial and joint, by the `KNOTS`
coefficients of a cubic B-spline (`forward.curve`). Slots marked constant choose a form and have no
derivative.

effect id → slots
    second_retardation   second_compliance or second_share, second_time; spectrum
    fractional_creep     springpot_compliance or _elastic_share or _flow_share, springpot_exponent;
                         flow_share 0: instead of the dashpot, 1: beside it
    strain_stiffening    stiffening_square, stiffening_linear, stiffening_exponential or spring_law
    wire_friction        friction_bend, friction_constant, friction_force or friction_law;
                         friction_width
    moment_arm           arm_scale (1 = the paper's wires), arm_law
    actuator_lag         lag, lag_second_share
    fatigue_softening    log_k_v, log_c_v, log_c_p (offsets, different for each trial)
    temperature          log_k_v, log_c_v, log_c_p
    preload_memory       initial_angle (q_ini is the angle at the start), initial_torque (on q_ini)
    contact_stop         stop_angle, stop_stiffness, stop_width, stop_law
    yield_threshold      yield_torque, yield_width
    stress_nonlinear_flow  flow_sinh, flow_power or flow_law
    joint_coupling       coupling_stiffness or coupling_share, coupling_saturation;
                         membrane_stiffness or membrane_share; coupling_kinematic
    gravity              tilt_along, tilt_across; moment_share
    inertia              inertia_scale
    camera_delay         delay
    lens_distortion      lens_radial about lens_along, lens_across; lens_aspect, lens_skew,
                         angle_scale or angle_cubic
    session_jump         log_k_v, log_c_v, log_c_p, q_ini
    load_limit           load_saturation, load_slowness or load_law
    load_gain            log_k_v, log_c_v, log_c_p
    joint_play           play, play_width
    thinning_damper      damper_power or damper_law
    softening_within_trial  softening_elastic or softening_flow, softening_time
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softfinger.faults import Fault
from softfinger.mechanics.checks import require_nonnegative, require_positive
from softfinger.mechanics.forward.curve import KNOTS


@dataclass(frozen=True)
class Slot:
    """One number of the forward model: its place, unit, null value and meaning."""

    kind: Literal["joint", "chain", "coupling", "law"]
    unit: str
    null: float
    meaning: str
    constant: bool = False


SLOTS: dict[str, Slot] = {
    "log_k_v": Slot("joint", "1", 0.0, "added to the trial's log k_v"),
    "log_c_v": Slot("joint", "1", 0.0, "added to the trial's log c_v"),
    "log_c_p": Slot("joint", "1", 0.0, "added to the trial's log c_p"),
    "q_ini": Slot("joint", "rad", 0.0, "added to the trial's q_ini"),
    "second_compliance": Slot("joint", "rad/(N m)", 0.0, "compliance of a second Voigt element"),
    "second_share": Slot("joint", "1", 0.0, "the same, as a share of 1/k_v"),
    "second_time": Slot("joint", "s", 1.0, "its retardation time"),
    "springpot_compliance": Slot(
        "joint", "rad/(N m s^a)", 0.0, "springpot in series: creep · t^a / Γ(1 + a)"
    ),
    "springpot_elastic_share": Slot("joint", "s^-a", 0.0, "the same, as a share of 1/k_v"),
    "springpot_flow_share": Slot("joint", "s^(1-a)", 0.0, "the same, as a share of 1/c_p"),
    "springpot_exponent": Slot("joint", "1", 0.5, "its exponent a, 0 = spring, 1 = dashpot"),
    "flow_share": Slot("joint", "1", 1.0, "factor on the dashpot's flow; 0 takes it away"),
    "stiffening_square": Slot("joint", "rad^-2", 0.0, "k_v (1 + b y²)"),
    "stiffening_linear": Slot("joint", "rad^-1", 0.0, "k_v (1 + b |y|)"),
    "stiffening_exponential": Slot("joint", "rad^-1", 0.0, "k_v exp(b |y|)"),
    "stiffening_measure": Slot(
        "joint", "1", 0.0, "y = elastic angle q_v at 0, joint angle q at 1", constant=True
    ),
    "spring_law": Slot("law", "1", 0.0, "k_v (1 + law), a law of |y|"),
    "spring_reach": Slot("joint", "rad", 1.0, "|y| at which that law ends", constant=True),
    "play": Slot("joint", "rad", 0.0, "elastic angle, either way, that asks for no torque"),
    "play_width": Slot("joint", "rad", 1e-3, "angle over which the torque sets in", constant=True),
    "softening_elastic": Slot("joint", "1", 0.0, "k_v (1 - s (1 - exp(-t/T))), t in the trial"),
    "softening_flow": Slot("joint", "1", 0.0, "c_p (1 - s (1 - exp(-t/T)))"),
    "softening_time": Slot("joint", "s", 1.0, "their time T"),
    "damper_power": Slot("joint", "1", 0.0, "Voigt damper: rate ∝ F (1 + (F/reference)²)^(b/2)"),
    "damper_law": Slot("law", "1", 0.0, "Voigt damper: rate ∝ F exp(law), a law of its torque |F|"),
    "damper_reference": Slot(
        "joint", "N m", 1.0, "reference torque of the power; where the law ends", constant=True
    ),
    "stop_angle": Slot("joint", "rad", 1.0, "joint angle at which a stop is met"),
    "stop_stiffness": Slot("joint", "N m/rad", 0.0, "stiffness of the stop"),
    "stop_width": Slot("joint", "rad", 1e-3, "angle over which the contact sets in", constant=True),
    "stop_law": Slot("law", "1", 0.0, "stiffness of the stop (1 + law), a law of the depth"),
    "stop_reach": Slot("joint", "rad", 1.0, "depth at which that law ends", constant=True),
    "flow_sinh": Slot("joint", "1/(N m)", 0.0, "flow ∝ sinh(b τ)/b; b = 1/scale torque"),
    "flow_power": Slot("joint", "1", 0.0, "flow ∝ τ |τ/reference|^b"),
    "flow_reference": Slot("joint", "N m", 1.0, "reference torque of the power", constant=True),
    "flow_law": Slot("law", "1", 0.0, "flow ∝ τ exp(law), a law of |τ|"),
    "flow_reach": Slot("joint", "N m", 1.0, "|τ| at which that law ends", constant=True),
    "yield_torque": Slot("joint", "N m", 0.0, "no flow below this torque, the excess above it"),
    "yield_width": Slot("joint", "N m", 1e-3, "torque over which the yield sets in"),
    "yield_jump": Slot(
        "joint", "1", 0.0, "1: above the threshold the whole torque flows", constant=True
    ),
    "initial_angle": Slot(
        "joint", "rad", 0.0, "elastic angle that has not yet relaxed at the start"
    ),
    "initial_torque": Slot(
        "joint", "N m", 0.0, "torque whose elastic angle is still there at the start, on q_ini"
    ),
    "arm_scale": Slot(
        "joint", "1", 0.0, "change of the moment arm with the angle; 1 = the paper's"
    ),
    "arm_law": Slot("law", "1", 0.0, "added to the factor on the moment arm, a law of q"),
    "arm_reach": Slot("joint", "rad", 1.0, "joint angle at which that law ends", constant=True),
    "spectrum": Slot(
        "law", "1", 0.0, "compliance for each e-fold of retardation time, as a share of 1/k_v"
    ),
    "spectrum_shortest": Slot("joint", "s", 0.1, "time at which that law begins", constant=True),
    "spectrum_longest": Slot("joint", "s", 10.0, "time at which that law ends", constant=True),
    "moment_share": Slot("joint", "1", 0.0, "first moment of a link and what it carries: (1 + b)"),
    "angle_scale": Slot("joint", "1", 0.0, "measured angle q (1 + b)"),
    "angle_cubic": Slot("joint", "rad^-2", 0.0, "measured angle q + b q³"),
    "delay": Slot("chain", "s", 0.0, "the recording shows the angle of this much earlier"),
    "lag": Slot("chain", "s", 0.0, "mean time by which the acting load follows the log"),
    "lag_second_share": Slot("chain", "1", 0.0, "part of it in a second stage after the first"),
    "load_saturation": Slot(
        "chain", "1", 0.0, "acting load u (1 + b (|u|/reference)^8)^(-1/8); limit b^(-1/8)"
    ),
    "load_law": Slot("law", "1", 0.0, "acting load u (1 + law), a law of |u|: that of joint 1"),
    "load_reference": Slot(
        "chain", "N m", 1.0, "reference of the saturation; where the law ends", constant=True
    ),
    "load_slowness": Slot("chain", "s/(N m)", 0.0, "1 / the largest rate of the acting load"),
    "friction_bend": Slot("chain", "1/rad", 0.0, "capstan exponent for each radian of bend"),
    "friction_constant": Slot("chain", "1", 0.0, "capstan exponent for each joint passed"),
    "friction_force": Slot("chain", "N m", 0.0, "Coulomb loss for each joint passed"),
    "friction_law": Slot(
        "law", "1", 0.0, "added to the capstan exponent, a law of the bend passed"
    ),
    "friction_reach": Slot("chain", "rad", 1.0, "bend at which that law ends", constant=True),
    "friction_width": Slot(
        "chain", "rad or N m", 0.05, "motion (driver 1) or load (driver 0) that turns the friction"
    ),
    "friction_driver": Slot(
        "chain",
        "1",
        1.0,
        "friction turns with the wire's motion (1) or the load (0)",
        constant=True,
    ),
    "friction_own": Slot(
        "chain", "1", 0.5, "share of a joint's own bend that its own torque suffers", constant=True
    ),
    "tilt_along": Slot("chain", "rad", 0.0, "tilt of the plane: gravity towards the tip"),
    "tilt_across": Slot("chain", "rad", 0.0, "tilt of the plane: gravity counter-clockwise"),
    "inertia_scale": Slot("chain", "1", 0.0, "inertia of the links; 1 = the declared masses"),
    "lens_radial": Slot("chain", "m^-2", 0.0, "first radial distortion about the optical centre"),
    "lens_aspect": Slot("chain", "1", 0.0, "measured direction θ + b sin 2θ"),
    "lens_skew": Slot("chain", "1", 0.0, "measured direction θ + b cos 2θ"),
    "lens_along": Slot("chain", "m", 0.0, "optical centre beyond where it is thought, along"),
    "lens_across": Slot("chain", "m", 0.0, "optical centre beyond where it is thought, across"),
    "coupling_stiffness": Slot("coupling", "N m/rad", 0.0, "torque from the other joint's motion"),
    "coupling_share": Slot("coupling", "1", 0.0, "the same, as a share of the joint's k_v"),
    "coupling_saturation": Slot("coupling", "1/rad", 0.0, "1 / the motion that halves that torque"),
    "membrane_stiffness": Slot(
        "coupling", "N m/rad", 0.0, "torque K (x_k - x_j), both ways where both are given"
    ),
    "membrane_share": Slot("coupling", "1", 0.0, "the same, as a share of sqrt(k_v,j k_v,k)"),
    "coupling_kinematic": Slot("coupling", "1", 0.0, "angle from the other joint's motion"),
}
"""Every slot by name."""


def _names(kind: str) -> tuple[str, ...]:
    return tuple(name for name, slot in SLOTS.items() if slot.kind == kind)


JOINT_SLOTS, CHAIN_SLOTS, COUPLING_SLOTS = _names("joint"), _names("chain"), _names("coupling")
LAWS = _names("law")
_NULLS = tuple(
    np.array([SLOTS[name].null for name in names])
    for names in (JOINT_SLOTS, CHAIN_SLOTS, COUPLING_SLOTS, LAWS)
)


class SlotArrays(NamedTuple):
    """Values (or tangents) of all slots: the kernel's plain data."""

    joint: NDArray[np.float64]
    """(…, trial, joint, joint slot)"""
    chain: NDArray[np.float64]
    """(…, trial, chain slot)"""
    coupling: NDArray[np.float64]
    """(…, trial, coupling slot, joint, other joint)"""
    law: NDArray[np.float64]
    """(…, trial, joint, law, knot)"""


def build_slots(trials: int, joints: int, values: Mapping[str, ArrayLike]) -> SlotArrays:
    """Fill the slots: the given values, the null value elsewhere.

    Parameters
    ----------
    values
        Slot name → value: (trial, joint), (trial,), (trial, joint, other_joint) or (trial, joint,
        knot) for a joint, chain, coupling or law slot, or anything that broadcasts against it.

    Raises
    ------
    Fault
        An unknown slot, or a value that is not finite or has the wrong shape.

    Examples
    --------
    >>> build_slots(2, 3, {"arm_scale": 1.0}).joint[..., JOINT_SLOTS.index("arm_scale")]
    array([[1., 1., 1.],
           [1., 1., 1.]])
    """
    return _fill(trials, joints, values, _NULLS)


def build_tangent(trials: int, joints: int, values: Mapping[str, ArrayLike]) -> SlotArrays:
    """Fill a direction of differentiation: d(slot)/d(parameter) where given, 0 elsewhere.

    Raises
    ------
    Fault
        As `build_slots`, and for a slot without a derivative (`Slot.constant`).
    """
    for name in values:
        if name in SLOTS and SLOTS[name].constant:
            raise Fault(f"slot {name!r} chooses a form: it has no derivative")
    return _fill(trials, joints, values, tuple(0.0 * null for null in _NULLS))


def _fill(
    trials: int, joints: int, values: Mapping[str, ArrayLike], nulls: tuple[NDArray, ...]
) -> SlotArrays:
    joint = np.tile(nulls[0], (trials, joints, 1))
    chain = np.tile(nulls[1], (trials, 1))
    coupling = np.tile(nulls[2][:, None, None], (trials, 1, joints, joints))
    law = np.zeros((trials, joints, len(LAWS), KNOTS))
    for name, value in values.items():
        if name not in SLOTS:
            raise Fault(f"unknown slot {name!r}: it must be one of {', '.join(SLOTS)}")
        kind = SLOTS[name].kind
        if kind == "joint":
            target = joint[..., JOINT_SLOTS.index(name)]
        elif kind == "chain":
            target = chain[..., CHAIN_SLOTS.index(name)]
        elif kind == "law":
            target = law[..., LAWS.index(name), :]
        else:
            target = coupling[:, COUPLING_SLOTS.index(name)]
        array = np.asarray(value, float)
        if not np.isfinite(array).all():
            raise Fault(f"slot {name!r} has a value that is not finite [{SLOTS[name].unit}]")
        try:
            target[...] = array
        except ValueError:
            raise Fault(
                f"slot {name!r} has shape {array.shape}: it must broadcast to {target.shape}"
            ) from None
    return SlotArrays(joint, chain, coupling, law)


_BELONGS = {
    "second": ("second_compliance", "second_share", "second_time"),
    "springpot": (
        *("springpot_compliance", "springpot_elastic_share", "springpot_flow_share", "spectrum"),
    ),
    "spring": (
        *("stiffening_square", "stiffening_linear", "stiffening_exponential", "spring_law"),
        *("play", "softening_elastic", "damper_power", "damper_law"),
    ),
    "stop": ("stop_stiffness",),
    "flow": ("flow_sinh", "flow_power", "yield_torque", "flow_law", "softening_flow"),
    "friction": ("friction_bend", "friction_constant", "friction_force", "friction_law"),
    "arm": ("arm_scale",),
    "arm_law": ("arm_law",),
    "gravity": ("tilt_along", "tilt_across"),
    "coupling": (
        *("coupling_stiffness", "coupling_share", "membrane_stiffness", "membrane_share"),
    ),
    "inertia": ("inertia_scale",),
    "lag": ("lag",),
    "delay": ("delay",),
    "limit": ("load_saturation", "load_law"),
    "slowness": ("load_slowness",),
    "observation": (
        *("angle_scale", "angle_cubic", "coupling_kinematic"),
        *("lens_radial", "lens_aspect", "lens_skew", "lens_along", "lens_across"),
    ),
    "lens": ("lens_radial", "lens_along", "lens_across"),
    "law": LAWS,
}


def find_groups(
    groups: Sequence[str], slots: SlotArrays, tangents: Sequence[SlotArrays]
) -> NDArray[np.bool_]:
    """Tell which physics is on: a slot that is not null, or a direction that moves one."""
    moved = find_moved_slots(slots, tangents)
    return np.array([not moved.isdisjoint(_BELONGS[group]) for group in groups])


def find_moved_slots(slots: SlotArrays, tangents: Sequence[SlotArrays]) -> set[str]:
    """Names of the slots that are not null, or that a direction moves."""
    on = _find_moved(slots, _NULLS)
    for tangent in tangents:
        on |= _find_moved(tangent, tuple(0.0 * null for null in _NULLS))
    names = (*JOINT_SLOTS, *CHAIN_SLOTS, *COUPLING_SLOTS, *LAWS)
    return {name for name, is_on in zip(names, on, strict=True) if is_on}


def _find_moved(slots: SlotArrays, nulls: tuple[NDArray, ...]) -> NDArray[np.bool_]:
    """Which slots, joint ones first, differ from their nulls in any trial."""
    joint, chain, coupling, law = slots
    moved = (
        joint != nulls[0],
        chain != nulls[1],
        np.moveaxis(coupling != nulls[2][:, None, None], -3, -1),
        (law != nulls[3][:, None]).any(axis=-1),
    )
    return np.concatenate([m.reshape(-1, m.shape[-1]).any(axis=0) for m in moved])


def _select(slots: SlotArrays, name: str) -> NDArray:
    kind = SLOTS[name].kind
    if kind == "joint":
        return slots.joint[..., JOINT_SLOTS.index(name)]
    if kind == "chain":
        return slots.chain[..., CHAIN_SLOTS.index(name)]
    return slots.coupling[..., COUPLING_SLOTS.index(name), :, :]


def check_slots(slots: SlotArrays) -> None:
    """Raise `Fault` where a slot has a value that no finger has."""
    for name in (
        *("second_time", "stop_width", "flow_reference", "yield_width", "friction_width"),
        *("spring_reach", "stop_reach", "flow_reach", "arm_reach", "friction_reach"),
        *("play_width", "softening_time", "damper_reference", "load_reference"),
        *("spectrum_shortest", "spectrum_longest"),
    ):
        require_positive(f"slot {name}", _select(slots, name), SLOTS[name].unit)
    for name in (
        *("lag", "yield_torque", "stop_stiffness", "flow_power", "coupling_saturation"),
        *("play", "damper_power", "load_saturation", "load_slowness"),
    ):
        require_nonnegative(f"slot {name}", _select(slots, name), SLOTS[name].unit)
    for name in ("softening_elastic", "softening_flow"):
        require_positive(f"1 - slot {name}", 1.0 - _select(slots, name), "1")
    share = _select(slots, "lag_second_share")
    require_nonnegative("slot lag_second_share", share, "1")
    require_positive("1/2 - slot lag_second_share", 0.5 - share, "1")
    exponent = _select(slots, "springpot_exponent")
    require_nonnegative("slot springpot_exponent", exponent, "1")
    require_nonnegative("1 - slot springpot_exponent", 1.0 - exponent, "1")
