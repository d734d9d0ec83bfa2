"""The slots of the forward model, as arrays.

They are physics that may be left out, as numbers.

An effect declares its slots in its own file (`slot.declare`); those of the base joint come first.
"""

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softfinger.faults import Fault
from softfinger.mechanics.checks import require_nonnegative, require_positive
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.forward.curve import KNOTS
from softfinger.mechanics.forward.slot import SLOTS, Slot, list_slots


class SlotArrays(NamedTuple):
    """Values (or tangents) of all slots, as arrays."""

    joint: NDArray[np.float64]
    """(…, trial, joint, joint slot)"""
    chain: NDArray[np.float64]
    """(…, trial, chain slot)"""
    coupling: NDArray[np.float64]
    """(…, trial, coupling slot, joint, other joint)"""
    law: NDArray[np.float64]
    """(…, trial, joint, law, knot)"""

    def pick(self, slot: Slot) -> NDArray[np.float64]:
        """Part of one slot, which can be written to."""
        if slot.kind == "coupling":
            return self.coupling[..., slot.place, :, :]
        if slot.kind == "law":
            return self.law[..., slot.place, :]
        return getattr(self, slot.kind)[..., slot.place]


def build_slots(trials: int, joints: int, values: Mapping[str, ArrayLike]) -> SlotArrays:
    """Fill the slots from the given values.

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
    >>> build_slots(2, 3, {"arm_scale": 1.0}).pick(SLOTS["arm_scale"])
    array([[1., 1., 1.],
           [1., 1., 1.]])
    """
    return _fill(trials, joints, values, _gather_nulls())


def build_tangent(trials: int, joints: int, values: Mapping[str, ArrayLike]) -> SlotArrays:
    """Fill a direction of differentiation.

    d(slot)/d(parameter) where given, 0 elsewhere.

    Raises
    ------
    Fault
        As `build_slots`, and for a slot without a derivative (`Slot.constant`).
    """
    for name in values:
        if name in SLOTS and SLOTS[name].constant:
            raise Fault(f"slot {name!r} chooses a form: it has no derivative")
    return _fill(trials, joints, values, [0.0 * null for null in _gather_nulls()])


def _gather_nulls() -> list[NDArray[np.float64]]:
    """Null values (slot,) of each kind, plug-ins' included."""
    list_effects()
    return _gather_nulls_of(tuple(SLOTS))


@cache
def _gather_nulls_of(names: tuple[str, ...]) -> list[NDArray[np.float64]]:
    slots = [SLOTS[name] for name in names]
    return [
        np.array([slot.null for slot in slots if slot.kind == kind]) for kind in SlotArrays._fields
    ]


def stack_tangents(slots: SlotArrays, tangents: Sequence[SlotArrays]) -> SlotArrays:
    """Stack tangents (direction, …), which may be none."""
    if not tangents:
        return SlotArrays(*(np.zeros((0, *part.shape)) for part in slots))
    return SlotArrays(*(np.stack(parts) for parts in zip(*tangents, strict=True)))


def _fill(
    trials: int, joints: int, values: Mapping[str, ArrayLike], nulls: Sequence[NDArray[np.float64]]
) -> SlotArrays:
    joint, chain, coupling, law = nulls
    slots = SlotArrays(
        np.empty((trials, joints, joint.size)),
        np.empty((trials, chain.size)),
        np.empty((trials, coupling.size, joints, joints)),
        np.empty((trials, joints, law.size, KNOTS)),
    )
    slots.joint[...], slots.chain[...] = joint, chain
    slots.coupling[...], slots.law[...] = coupling[:, None, None], law[:, None]
    for name, value in values.items():
        if name not in SLOTS:
            raise Fault(f"unknown slot {name!r}: it must be one of {', '.join(SLOTS)}")
        target, array = slots.pick(SLOTS[name]), np.asarray(value, float)
        if not np.isfinite(array).all():
            raise Fault(f"slot {name!r} has a value that is not finite [{SLOTS[name].unit}]")
        try:
            target[...] = array
        except ValueError:
            raise Fault(
                f"slot {name!r} has shape {array.shape}: it must broadcast to {target.shape}"
            ) from None
    return slots


def find_moved_slots(slots: SlotArrays, tangents: SlotArrays) -> set[str]:
    """Names of slots not null, or moved along a direction of `stack_tangents`."""
    nulls = _gather_nulls()
    on = _find_moved(slots, nulls) | _find_moved(tangents, [0.0 * null for null in nulls])
    names = [name for kind in SlotArrays._fields for name in list_slots(kind)]
    return {name for name, is_on in zip(names, on, strict=True) if is_on}


def _find_moved(slots: SlotArrays, nulls: Sequence[NDArray[np.float64]]) -> NDArray[np.bool_]:
    """Which slots differ from nulls, by kind."""
    moved = (
        slots.joint != nulls[0],
        slots.chain != nulls[1],
        np.moveaxis(slots.coupling != nulls[2][:, None, None], -3, -1),
        (slots.law != nulls[3][:, None]).any(axis=-1),
    )
    return np.concatenate([m.reshape(-1, m.shape[-1]).any(axis=0) for m in moved])


def check_slots(slots: SlotArrays, names: Iterable[str]) -> None:
    """Refuse, by `Fault`, slots that no finger has; those of these names."""
    for name in names:
        slot = SLOTS[name]
        value = slots.pick(slot)
        if slot.sign == "positive":
            require_positive(f"slot {name}", value, slot.unit)
        elif slot.sign == "nonnegative":
            require_nonnegative(f"slot {name}", value, slot.unit)
        if slot.below is not None:
            require_positive(f"{slot.below:g} - slot {name}", slot.below - value, slot.unit)
        if slot.at_most is not None:
            require_nonnegative(f"{slot.at_most:g} - slot {name}", slot.at_most - value, slot.unit)
