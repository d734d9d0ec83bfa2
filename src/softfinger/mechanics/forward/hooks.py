"""The hooks of the kernel.

They are where an effect adds its physics, and what is called there.

Hooks of one kind are called in the order of the catalogue. Each changes what is there and, where it
has columns, how that moves along them: the changes of the slots are `model.d_joint[c]` and so on,
and `model.columns[j]` are the columns that can move joint j. In what follows a row (column,) of
changes is empty where no tangents are wanted.

clock    (model, time (frame,), late (column,))
         the moments of the frames [s], and their change, the same for all
log      (model, time (knot,), load (knot,)) → time, load, d_load (knot, column)
         the load log as straight lines between knots, before the trial; one effect alone
follow   (model, load, nodes, i, since, end)
         the load that acts at row i of the nodes, `since` seconds into a segment of the log;
         with `end` the segment ends there, and what acts is to be remembered
limit    (model, load (1,), row)
         the load that acts, without memory
jump     (model, work, jump)
         a jump of the load that acts, between two segments; not called where it has a pace
rest     (model, work, j)
         the state of joint j at the start of a trial
modes    (model, linear, j)
         rates and gains of the linear modes of joint j (`modes`)
spring   (model, j, time, elastic, angle, spring (6,), d_spring (2, column), tangents)
         the spring of joint j (`spring`)
damper   (model, j, time, force, thin (2,), row)
         what the Voigt damper's torque is multiplied by, and its slope
flow     (model, j, time, torque, drive (2,), row)
         the torque that the dashpot feels, and its slope by the joint's torque
turn     (model, nodes)
         the state of the wire's friction at the nodes, each from the one before
pull     (model, nodes, balance, i, tangents)
         what the wire's pull becomes on its way: multiplies row i of the balance
balance  (model, nodes, balance, i, tangents)
         a torque, added to row i of the balance
give     (model, j, torque, given (2,), row)
         what joint j's link turns at once under its torque, and its slope; the camera sees it
observe  (model, angle (joint, n), by (joint, n, column), seen, gradient)
         what the camera makes of the angles, added to what it sees
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from typing import Literal, NamedTuple

import numpy as np
from numba import types
from numpy.typing import NDArray

from softfinger.compiled.hook import build_call, find_address
from softfinger.faults import Fault
from softfinger.mechanics.forward.slot import SLOTS
from softfinger.mechanics.forward.work import (
    BALANCE_TYPE,
    LINEAR_TYPE,
    LOAD_TYPE,
    MODEL_TYPE,
    NODES_TYPE,
    WORK_TYPE,
    Block,
    Row,
    Table,
)

_REAL, _WHOLE, _TRUTH = types.float64, types.int64, types.boolean
_ROW_OF_BALANCE = types.void(MODEL_TYPE, NODES_TYPE, BALANCE_TYPE, _WHOLE, _TRUTH)
SIGNATURES = {
    "clock": types.void(MODEL_TYPE, Row, Row),
    "log": types.Tuple([Row, Row, Table])(MODEL_TYPE, Row, Row),
    "follow": types.void(MODEL_TYPE, LOAD_TYPE, NODES_TYPE, _WHOLE, _REAL, _TRUTH),
    "limit": types.void(MODEL_TYPE, Row, Row),
    "jump": types.void(MODEL_TYPE, WORK_TYPE, _REAL),
    "rest": types.void(MODEL_TYPE, WORK_TYPE, _WHOLE),
    "modes": types.void(MODEL_TYPE, LINEAR_TYPE, _WHOLE),
    "spring": types.void(MODEL_TYPE, _WHOLE, _REAL, _REAL, _REAL, Row, Table, _TRUTH),
    "damper": types.void(MODEL_TYPE, _WHOLE, _REAL, _REAL, Row, Row),
    "flow": types.void(MODEL_TYPE, _WHOLE, _REAL, _REAL, Row, Row),
    "turn": types.void(MODEL_TYPE, NODES_TYPE),
    "pull": _ROW_OF_BALANCE,
    "balance": _ROW_OF_BALANCE,
    "give": types.void(MODEL_TYPE, _WHOLE, _REAL, Row, Row),
    "observe": types.void(MODEL_TYPE, Table, Block, Table, Block),
}
KINDS = tuple(SIGNATURES)
(
    CLOCK, LOG, FOLLOW, LIMIT, JUMP, REST, MODES, SPRING, DAMPER, FLOW, TURN, PULL, BALANCE, GIVE,
    OBSERVE
) = (np.int64(kind) for kind in range(len(KINDS)))  # fmt: skip
(
    call_clock, call_log, call_follow, call_limit, call_jump, call_rest, call_modes, call_spring,
    call_damper, call_flow, call_turn, call_pull, call_balance, call_give, call_observe
) = map(build_call, SIGNATURES.values())  # fmt: skip
_FEEDBACK = {"pull", "balance"}
_CURVED = _FEEDBACK | {"follow", "limit", "spring", "damper", "flow"}


@dataclass(frozen=True)
class Hook:
    """A compiled function that the kernel calls.

    Attributes
    ----------
    kind
        One of `KINDS`.
    function
        Of `compiled`, with the arguments of its kind.
    slots
        It is called where one of these is not null, or moved by a direction.
    mixes
        Through it a joint's torque depends on other joints, or one parameter moves several.
    inertial
        It depends on velocities and accelerations.
    modes
        How many modes a joint must have for it.
    """

    kind: Literal[*KINDS]
    function: Callable
    slots: tuple[str, ...]
    mixes: bool = False
    inertial: bool = False
    modes: int = 2

    def __post_init__(self) -> None:
        """Refuse what the kernel would never call."""
        if self.kind not in KINDS:
            kinds = ", ".join(KINDS)
            raise Fault(f"{self.kind!r} is not a kind of hook: it must be one of {kinds}")
        for slot in self.slots:
            if slot not in SLOTS:
                raise Fault(f"a hook is switched by {slot!r}, which is not a slot: declare it")


class Hooks(NamedTuple):
    """Hooks of a run, for the kernel."""

    address: NDArray[np.int64]
    """(kind, …), 0 beyond the last"""
    count: NDArray[np.int64]
    """(kind,)"""
    feedback: bool
    curved: bool
    inertial: bool


def find_hooks(hooks: Iterable[Hook], moved: set[str]) -> tuple[Hook, ...]:
    """Find the hooks that a moved slot switches on, once each though effects may share one."""
    return tuple(dict.fromkeys(hook for hook in hooks if not moved.isdisjoint(hook.slots)))


@cache
def compile_hooks(on: tuple[Hook, ...]) -> Hooks:
    """Compile the hooks of a run, by kind."""
    kinds = {hook.kind for hook in on}
    rows: list[list[int]] = [[] for _ in KINDS]
    for hook in on:
        rows[KINDS.index(hook.kind)].append(find_address(hook.function, SIGNATURES[hook.kind]))
    if len(rows[LOG]) > 1:
        raise Fault("two effects change the load log: take one of them out")
    address = np.zeros((len(KINDS), max(map(len, rows), default=0)), np.int64)
    for row, found in zip(address, rows, strict=True):
        row[: len(found)] = found
    return Hooks(
        address,
        np.array([len(row) for row in rows]),
        bool(kinds & _FEEDBACK),
        bool(kinds & _CURVED),
        any(hook.inertial for hook in on),
    )
