"""The arrays that the kernel works in: allocated once, filled anew for each trial and step.

They are numba's `structref`s, passed by reference: as tuples of arrays they took three times as
long to compile.
"""

import numpy as np
from numba import types
from numba.experimental import structref
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.forward.curve import KNOTS
from softfinger.mechanics.forward.slots import CHAIN_SLOTS, COUPLING_SLOTS, JOINT_SLOTS, LAWS

GROUPS = (
    "second",
    "springpot",
    "spring",
    "stop",
    "flow",
    "friction",
    "arm",
    "arm_law",
    "gravity",
    "coupling",
    "inertia",
    "lag",
    "delay",
    "limit",
    "slowness",
    "observation",
    "lens",
    "law",
)
"""The physics that a run needs to look at; the others cost nothing."""
(
    HAS_SECOND,
    HAS_SPRINGPOT,
    HAS_SPRING,
    HAS_STOP,
    HAS_FLOW,
    HAS_FRICTION,
    HAS_ARM,
    HAS_ARM_LAW,
    HAS_GRAVITY,
    HAS_COUPLING,
    HAS_INERTIA,
    HAS_LAG,
    HAS_DELAY,
    HAS_LIMIT,
    HAS_SLOWNESS,
    HAS_OBSERVATION,
    HAS_LENS,
    HAS_LAW,
) = range(len(GROUPS))

_JOINT, _CHAIN, _COUPLING = len(JOINT_SLOTS), len(CHAIN_SLOTS), len(COUPLING_SLOTS)
_LAW = len(LAWS)
START = np.int64(3)  # row of the start of a step (a plain int would make numba compile twice)


class Model(structref.StructRefProxy):
    """One trial's slots and their tangents (column first), and what is fixed for the finger."""

    joint: NDArray  # (joint, slot)
    chain: NDArray  # (slot,)
    coupling: NDArray  # (slot, joint, other)
    law: NDArray  # (joint, law, knot)
    d_joint: NDArray  # (column, joint, slot)
    d_chain: NDArray  # (column, slot)
    d_coupling: NDArray  # (column, slot, joint, other)
    d_law: NDArray  # (column, joint, law, knot)
    columns: NDArray  # (joint, …): the columns that can move this joint
    groups: NDArray  # (group,) bool
    arm_ratio: float  # l_joint / (2 d)
    moment: NDArray  # (joint,) [kg m]
    inertia: NDArray  # (joint, joint) [kg m²]


class State(structref.StructRefProxy):
    """What the start of a step remembers, and its tangents (column last)."""

    mode: NDArray  # (joint, mode) [rad]
    d_mode: NDArray
    offset: NDArray  # (joint,) [rad]: q − Σ modes
    d_offset: NDArray
    direction: NDArray  # (1,) state of the wire friction, −1 … 1
    d_direction: NDArray
    velocity: NDArray  # (joint,) [rad/s]
    d_velocity: NDArray
    torque: NDArray  # (joint,) [N m] at the end of the step before
    d_torque: NDArray


class Linear(structref.StructRefProxy):
    """The modes, and what they make of drives during the present step."""

    rate: NDArray  # (joint, mode) [1/s]
    gain: NDArray
    d_rate: NDArray  # (joint, mode, column)
    d_gain: NDArray
    base: NDArray  # (3, joint, node): q_v, q and q̇ without any drive
    weight: NDArray  # (3 drives, joint, node, node): what drives at nodes add to q
    rate_weight: NDArray  # the same for q̇
    drive: NDArray  # (joint, 3 drives, power)
    d_drive: NDArray  # (joint, 3 drives, power, column)


class Nodes(structref.StructRefProxy):
    """Everything at the three nodes of a step, and at its start."""

    time: NDArray  # (4,) [s]
    load: NDArray  # [N m]
    d_load: NDArray  # (4, column)
    torque: NDArray  # (4, joint): the unknown
    spring: NDArray  # what the Voigt element takes from a linear one's drive
    spring_slope: NDArray  # (3, 4, joint) by q_v, q and torque
    flow: NDArray  # the dashpot's drive
    flow_slope: NDArray
    flow_partial: NDArray  # (4, joint, 7)
    elastic: NDArray  # q_v
    angle: NDArray  # q
    velocity: NDArray
    acceleration: NDArray
    direction: NDArray  # (4,)
    by_motion: NDArray  # (3, 4): of the direction, by x at nodes and start
    d_direction: NDArray  # (4, column), at fixed angles
    d_torque: NDArray  # (4, joint, column)
    d_spring: NDArray
    d_flow: NDArray
    d_elastic: NDArray
    d_angle: NDArray
    d_velocity: NDArray


class Balance(structref.StructRefProxy):
    """The torque that the finger's statics ask of each joint, and its derivatives."""

    torque: NDArray  # (4, joint)
    by_angle: NDArray  # (4, joint, other)
    by_velocity: NDArray
    by_acceleration: NDArray
    by_direction: NDArray  # (4, joint)
    by_load: NDArray
    tangent: NDArray  # (4, joint, column), at fixed angles, load and direction


class Newton(structref.StructRefProxy):
    """The linear systems of a step."""

    spring_by_torque: NDArray  # (joint, node, node)
    angle_by_torque: NDArray
    velocity_by_torque: NDArray
    local: NDArray  # (3, 3), a joint's own system, and
    column: NDArray  # (3,) its right side
    matrix: NDArray  # (3 joint, 3 joint)
    pivot: NDArray
    right: NDArray
    rights: NDArray  # (3 joint, column): a right side for each column
    way: NDArray  # (column,): scratch of these


class Work(structref.StructRefProxy):
    """All of it."""

    state: State
    linear: Linear
    nodes: Nodes
    balance: Balance
    newton: Newton
    weight: NDArray  # (drive, power): scratch of an evaluation inside the step, as are
    response: NDArray  # (mode, 6): decay, slower, unit of `mode_response`; weights of its drive
    motion: NDArray  # (mode, 3): rate, drive, place
    drive: NDArray  # (mode,) which drive it follows
    largest: NDArray  # (column,): the largest tangent so far
    curved: NDArray  # (1,) bool: whether drives bend between the knots of the load


@structref.register
class ModelType(types.StructRef):
    """Numba's type of `Model`."""


@structref.register
class StateType(types.StructRef):
    """Numba's type of `State`."""


@structref.register
class LinearType(types.StructRef):
    """Numba's type of `Linear`."""


@structref.register
class NodesType(types.StructRef):
    """Numba's type of `Nodes`."""


@structref.register
class BalanceType(types.StructRef):
    """Numba's type of `Balance`."""


@structref.register
class NewtonType(types.StructRef):
    """Numba's type of `Newton`."""


@structref.register
class WorkType(types.StructRef):
    """Numba's type of `Work`."""


for _face, _type in (
    (Model, ModelType),
    (State, StateType),
    (Linear, LinearType),
    (Nodes, NodesType),
    (Balance, BalanceType),
    (Newton, NewtonType),
    (Work, WorkType),
):
    structref.define_proxy(_face, _type, list(_face.__annotations__))


@compiled
def allocate_model(
    joints: int,
    by_own: bool,
    columns: int,
    groups: NDArray,
    arm_ratio: float,
    moment: NDArray,
    inertia: NDArray,
) -> Model:
    """Make room for a trial's slots; `by_own`: with unit tangents for each joint's own four."""
    d_joint = np.zeros((columns, joints, _JOINT))
    mixed = groups[HAS_FRICTION] or groups[HAS_GRAVITY] or groups[HAS_COUPLING]
    mixed = mixed or groups[HAS_INERTIA]
    own = 4 if by_own else 0
    extra = columns - own * joints
    count = columns if mixed else own + extra
    reach = np.zeros((joints, count), np.int64)
    for j in range(joints):
        for k in range(own):
            d_joint[own * j + k, j, k] = 1.0
        for k in range(count):
            first = k if mixed or k >= own else own * j + k
            reach[j, k] = first if mixed or k < own else own * joints + k - own
    return Model(
        np.zeros((joints, _JOINT)),
        np.zeros(_CHAIN),
        np.zeros((_COUPLING, joints, joints)),
        np.zeros((joints, _LAW, KNOTS)),
        d_joint,
        np.zeros((columns, _CHAIN)),
        np.zeros((columns, _COUPLING, joints, joints)),
        np.zeros((columns, joints, _LAW, KNOTS)),
        reach,
        groups,
        arm_ratio,
        moment,
        inertia,
    )


@compiled
def allocate_work(n: int, modes: int, columns: int) -> Work:
    """Make room for `n` joints of `modes` modes, with `columns` tangents."""
    state = State(
        np.zeros((n, modes)), np.zeros((n, modes, columns)), np.zeros(n), np.zeros((n, columns)),
        np.zeros(1), np.zeros((1, columns)), np.zeros(n), np.zeros((n, columns)),
        np.zeros(n), np.zeros((n, columns)),
    )  # fmt: skip
    linear = Linear(
        np.zeros((n, modes)), np.zeros((n, modes)),
        np.zeros((n, modes, columns)), np.zeros((n, modes, columns)),
        np.zeros((3, n, 3)), np.zeros((3, n, 3, 3)), np.zeros((3, n, 3, 3)),
        np.zeros((n, 3, 3)), np.zeros((n, 3, 3, columns)),
    )  # fmt: skip
    nodes = Nodes(
        np.zeros(4), np.zeros(4), np.zeros((4, columns)), np.zeros((4, n)), np.zeros((4, n)),
        np.zeros((3, 4, n)), np.zeros((4, n)), np.ones((4, n)), np.zeros((4, n, 7)),
        np.zeros((4, n)), np.zeros((4, n)), np.zeros((4, n)), np.zeros((4, n)),
        np.zeros(4), np.zeros((3, 4)), np.zeros((4, columns)), np.zeros((4, n, columns)),
        np.zeros((4, n, columns)), np.zeros((4, n, columns)), np.zeros((4, n, columns)),
        np.zeros((4, n, columns)), np.zeros((4, n, columns)),
    )  # fmt: skip
    balance = Balance(
        np.zeros((4, n)), np.zeros((4, n, n)), np.zeros((4, n, n)), np.zeros((4, n, n)),
        np.zeros((4, n)), np.zeros((4, n)), np.zeros((4, n, columns)),
    )  # fmt: skip
    newton = Newton(
        np.zeros((n, 3, 3)), np.zeros((n, 3, 3)), np.zeros((n, 3, 3)),
        np.zeros((3, 3)), np.zeros(3),
        np.zeros((3 * n, 3 * n)), np.zeros(3 * n, np.int64), np.zeros(3 * n),
        np.zeros((3 * n, columns)), np.zeros(columns),
    )  # fmt: skip
    return Work(
        state, linear, nodes, balance, newton, np.zeros((3, 3)), np.zeros((modes, 6)),
        np.zeros((modes, 3)), np.zeros(modes, np.int64), np.zeros(columns), np.zeros(1, np.bool_),
    )  # fmt: skip
