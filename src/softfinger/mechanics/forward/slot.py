"""What a slot is.

It is one number of the forward model that an effect declares, or the base joint.

With every slot at its null the model is the paper's joint under a constant moment arm. Slots are
plain data: any two, or all, combine without compiling anything anew.
"""

from dataclasses import dataclass, replace
from typing import Literal

from softfinger.faults import Fault

Kind = Literal["joint", "chain", "coupling", "law"]


@dataclass(frozen=True)
class Slot:
    """One number of the forward model.

    Attributes
    ----------
    kind
        A `joint` slot has one value for each trial and joint, a `chain` slot one for each trial, a
        `coupling` slot one for each trial, joint and other joint. A `law` slot is a whole curve for
        each trial and joint, by the coefficients of a cubic B-spline (`forward.curve`).
    unit, null, meaning
        The null is its value where the effect is absent; that of a law is 0.
    sign
        What its values must be.
    below, at_most
        Bounds, where it has one.
    constant
        It chooses a form and has no derivative.
    needs
        Fields of the finger that must be known where it is not null.
    place
        Among the slots of its kind; `declare` counts.
    """

    kind: Kind
    unit: str
    null: float
    meaning: str
    sign: Literal["any", "positive", "nonnegative"] = "any"
    below: float | None = None
    at_most: float | None = None
    constant: bool = False
    needs: tuple[str, ...] = ()
    place: int = -1


SLOTS: dict[str, Slot] = {}
"""Every slot by name, as they were declared."""


def declare(**slots: Slot) -> tuple[int, ...]:
    """Add slots to the forward model.

    The function returns their places, each among its kind.

    Raises
    ------
    Fault
        A name is taken.
    """
    for name, slot in slots.items():
        kin = [other for other in SLOTS.values() if other.kind == slot.kind]
        mine = SLOTS.setdefault(name, replace(slot, place=len(kin)))
        if mine != replace(slot, place=mine.place):
            raise Fault(f"the slot {name!r} is declared twice: choose another name")
    return tuple(SLOTS[name].place for name in slots)


def list_slots(kind: Kind) -> list[str]:
    """Names of the slots of a kind, in order."""
    return [name for name, slot in SLOTS.items() if slot.kind == kind]


LOG_K_V, LOG_C_V, LOG_C_P, Q_INI = declare(
    log_k_v=Slot("joint", "1", 0.0, "added to the trial's log k_v"),
    log_c_v=Slot("joint", "1", 0.0, "added to the trial's log c_v"),
    log_c_p=Slot("joint", "1", 0.0, "added to the trial's log c_p"),
    q_ini=Slot("joint", "rad", 0.0, "added to the trial's q_ini"),
)
