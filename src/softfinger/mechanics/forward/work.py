"""The arrays that the kernel works in.

They are allocated once, and filled anew for each trial and step.

They are numba's `structref`s, passed by reference: as tuples of arrays they took three times as
long to compile. The kernel and its hooks borrow them (`compiled.borrowed`). Their types are
written out, so that a hook can be compiled before the kernel.
"""

import numpy as np
from numba import types
from numba.experimental import structref
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.compiled.borrowed import Borrowed

Row, Table, Block, Stack = (types.Array(types.float64, n, "C") for n in range(1, 5))
Count = types.Array(types.int64, 1, "C")
Codes = types.Array(types.int64, 2, "C")
# Python's own int and bool would make numba compile twice
START = np.int64(3)
"""Row of the start of a step."""
NO, YES = np.bool_(False), np.bool_(True)


class Model(structref.StructRefProxy):
    """One trial's slots, tangents (column first), finger."""

    joint: Table  # (joint, slot)
    chain: Row  # (slot,)
    coupling: Block  # (slot, joint, other)
    law: Block  # (joint, law, knot)
    d_joint: Block  # (column, joint, slot)
    d_chain: Table  # (column, slot)
    d_coupling: Stack  # (column, slot, joint, other)
    d_law: Stack  # (column, joint, law, knot)
    columns: Codes  # (joint, …): the columns that can move this joint
    hook: Codes  # (kind, …) addresses of what effects add, by kind
    count: Count  # (kind,) how many
    feedback: types.boolean  # whether the joints' torques depend on their angles,
    curved: types.boolean  # whether drives may bend between the knots of the load,
    inertial: types.boolean  # whether torques depend on velocities and accelerations
    arm_ratio: types.float64  # l_joint / (2 d)
    moment: Row  # (joint,) [kg m]
    inertia: Table  # (joint, joint) [kg m²]
    link_length: Row  # (joint,) [m]
    middle: Row  # (1 + joint,) [m] of the markers along base and links
    centre: Row  # (2,) [m] optical centre from the first joint, along and across the base


class State(structref.StructRefProxy):
    """A step's start, and tangents (column last)."""

    mode: Table  # (joint, mode) [rad]
    d_mode: Block
    offset: Row  # (joint,) [rad]: q − Σ modes
    d_offset: Table
    direction: Row  # (joint,) state of the wire friction where it passes, −1 … 1
    d_direction: Table
    velocity: Row  # (joint,) [rad/s]
    d_velocity: Table
    torque: Row  # (joint,) [N m] at the end of the step before
    d_torque: Table


class Load(structref.StructRefProxy):
    """The log's line on a segment, what acts."""

    log: Row  # (2,) its value at the start and its slope
    d_log: Table  # (2, column)
    acting: Row  # (2,) what acts at the start; the second for what a hook must remember besides
    d_acting: Table  # (2, column)
    pace: Row  # (1,) [s] in which what acts follows: it does not jump, and a first step is short
    stride: Row  # (1,) [s] of the next step where a segment begins without a jump, 0 after one


class Linear(structref.StructRefProxy):
    """The modes, and what drives do in this step."""

    rate: Table  # (joint, mode) [1/s]
    gain: Table
    d_rate: Block  # (joint, mode, column)
    d_gain: Block
    base: Block  # (3, joint, node): q_v, q and q̇ without any drive
    weight: Stack  # (3 drives, joint, node, node): what drives at nodes add to q
    rate_weight: Stack  # the same for q̇
    drive: Block  # (joint, 3 drives, power)
    d_drive: Stack  # (joint, 3 drives, power, column)


class Nodes(structref.StructRefProxy):
    """Everything at a step's three nodes and start."""

    time: Row  # (4,) [s]
    load: Row  # [N m]
    d_load: Table  # (4, column)
    torque: Table  # (4, joint): the unknown
    spring: Table  # what the Voigt element takes from a linear one's drive
    spring_slope: Block  # (3, 4, joint) by q_v, q and torque
    flow: Table  # the dashpot's drive
    flow_slope: Table
    elastic: Table  # q_v
    angle: Table  # q
    velocity: Table
    acceleration: Table
    direction: Table  # (4, joint), of the wire where it passes that joint
    by_motion: Block  # (3, 4, joint): of the direction, by the slide there at nodes and start
    d_direction: Block  # (4, joint, column), at fixed angles
    d_torque: Block  # (4, joint, column)
    d_spring: Block
    d_flow: Block
    d_elastic: Block
    d_angle: Block
    d_velocity: Block


class Balance(structref.StructRefProxy):
    """Torque that statics asks, and its derivatives."""

    torque: Table  # (4, joint)
    by_angle: Block  # (4, joint, other)
    by_velocity: Block
    by_acceleration: Block
    by_direction: Block  # (4, joint, joint that the wire passes)
    by_load: Table  # (4, joint)
    tangent: Block  # (4, joint, column), at fixed angles, load and direction
    inertia: Block  # (4, joint, joint): scratch of what the links' masses take, as is
    taken: Row  # (joint,)


class Newton(structref.StructRefProxy):
    """The linear systems of a step."""

    spring_by_torque: Block  # (joint, node, node)
    angle_by_torque: Block
    velocity_by_torque: Block
    local: Table  # (3, 3), a joint's own system, and
    column: Row  # (3,) its right side
    matrix: Table  # (3 joint, 3 joint)
    pivot: Count
    right: Row
    rights: Table  # (3 joint, column): a right side for each column
    way: Table  # (joint, column): scratch of these


class Work(structref.StructRefProxy):
    """All of it."""

    state: State
    linear: Linear
    nodes: Nodes
    balance: Balance
    newton: Newton
    load: Load
    weight: Table  # (drive, power): scratch of an evaluation inside the step, as are
    response: Table  # (mode, 6): decay, slower, unit of `mode_response`; weights of its drive
    motion: Table  # (mode, 3): rate, drive, place
    drive: Count  # (mode,) which drive it follows
    pair: Row  # (2,): a value that hooks change in turn, and its slope
    none: Row  # (0,): in place of a row of changes where none are wanted
    spring: Row  # (6,): the spring as hooks change it (`spring.py`)
    d_spring: Table  # (2, column)
    largest: Row  # (column,): the largest tangent so far
    missed: Row  # (drive,): what the quadratics miss at the start of the step


_FACES = (Model, State, Load, Linear, Nodes, Balance, Newton, Work)
_TYPES = {
    face: structref.register(
        type(f"{face.__name__}Type", (types.StructRef,), {"__module__": __name__})
    )
    for face in _FACES
}
# the cache of machine code looks for them here
ModelType, StateType, LoadType, LinearType, NodesType, BalanceType, NewtonType, WorkType = (
    _TYPES.values()
)
_FILLED: dict[type, types.StructRef] = {}
for _face, _type in _TYPES.items():
    _fields = _face.__annotations__
    structref.define_proxy(_face, _type, list(_fields))
    _FILLED[_face] = _type([(name, _FILLED.get(kind, kind)) for name, kind in _fields.items()])
(
    MODEL_TYPE, STATE_TYPE, LOAD_TYPE, LINEAR_TYPE, NODES_TYPE, BALANCE_TYPE, NEWTON_TYPE, WORK_TYPE
) = map(Borrowed, _FILLED.values())  # fmt: skip


@compiled
def allocate_model(
    joint: NDArray,
    chain: NDArray,
    coupling: NDArray,
    law: NDArray,
    by_own: bool,
    columns: int,
    mixed: bool,
    rest: tuple,
) -> Model:
    """Make room for a trial's slots.

    Parameters
    ----------
    by_own
        With unit tangents for each joint's own four.
    mixed
        Whether a column may move other joints than its own.
    rest
        The fields of the model from `hook` on.
    """
    _, joints, slots = joint.shape
    d_joint = np.zeros((columns, joints, slots))
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
        np.zeros(joint.shape[1:]),
        np.zeros(chain.shape[1:]),
        np.zeros(coupling.shape[1:]),
        np.zeros(law.shape[1:]),
        d_joint,
        np.zeros((columns, *chain.shape[1:])),
        np.zeros((columns, *coupling.shape[1:])),
        np.zeros((columns, *law.shape[1:])),
        reach,
        *rest,
    )


@compiled
def allocate_work(n: int, modes: int, columns: int) -> Work:
    """Allocate `n` joints, `modes` modes, `columns` tangents."""
    state = State(
        np.zeros((n, modes)), np.zeros((n, modes, columns)), np.zeros(n), np.zeros((n, columns)),
        np.zeros(n), np.zeros((n, columns)), np.zeros(n), np.zeros((n, columns)),
        np.zeros(n), np.zeros((n, columns)),
    )  # fmt: skip
    load = Load(
        np.zeros(2), np.zeros((2, columns)), np.zeros(2), np.zeros((2, columns)), np.zeros(1),
        np.zeros(1),
    )  # fmt: skip
    linear = Linear(
        np.zeros((n, modes)), np.zeros((n, modes)),
        np.zeros((n, modes, columns)), np.zeros((n, modes, columns)),
        np.zeros((3, n, 3)), np.zeros((3, n, 3, 3)), np.zeros((3, n, 3, 3)),
        np.zeros((n, 3, 3)), np.zeros((n, 3, 3, columns)),
    )  # fmt: skip
    nodes = Nodes(
        np.zeros(4), np.zeros(4), np.zeros((4, columns)), np.zeros((4, n)), np.zeros((4, n)),
        np.zeros((3, 4, n)), np.zeros((4, n)), np.ones((4, n)),
        np.zeros((4, n)), np.zeros((4, n)), np.zeros((4, n)), np.zeros((4, n)),
        np.zeros((4, n)), np.zeros((3, 4, n)), np.zeros((4, n, columns)), np.zeros((4, n, columns)),
        np.zeros((4, n, columns)), np.zeros((4, n, columns)), np.zeros((4, n, columns)),
        np.zeros((4, n, columns)), np.zeros((4, n, columns)),
    )  # fmt: skip
    balance = Balance(
        np.zeros((4, n)), np.zeros((4, n, n)), np.zeros((4, n, n)), np.zeros((4, n, n)),
        np.zeros((4, n, n)), np.zeros((4, n)), np.zeros((4, n, columns)),
        np.zeros((4, n, n)), np.zeros(n),
    )  # fmt: skip
    newton = Newton(
        np.zeros((n, 3, 3)), np.zeros((n, 3, 3)), np.zeros((n, 3, 3)),
        np.zeros((3, 3)), np.zeros(3),
        np.zeros((3 * n, 3 * n)), np.zeros(3 * n, np.int64), np.zeros(3 * n),
        np.zeros((3 * n, columns)), np.zeros((n, columns)),
    )  # fmt: skip
    return Work(
        state, linear, nodes, balance, newton, load, np.zeros((3, 3)), np.zeros((modes, 6)),
        np.zeros((modes, 3)), np.zeros(modes, np.int64), np.zeros(2), np.zeros(0),
        np.zeros(6), np.zeros((2, columns)), np.zeros(columns),
        np.zeros(3),
    )  # fmt: skip
