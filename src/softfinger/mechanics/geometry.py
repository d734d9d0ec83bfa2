"""What the finger is made of: lengths, masses, wires."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softfinger.faults import Fault
from softfinger.mechanics.checks import require_nonnegative, require_positive


@dataclass(frozen=True, eq=False)
class FingerGeometry:
    """A planar finger of N links, base to tip.

    Attributes
    ----------
    link_length, link_mass
        (joint,) [m], from joint centre to joint centre; [kg].
    link_centre, link_inertia
        (joint,) [m], centre of mass from the link's proximal joint; [kg m²], about that centre.
    joint_length, wire_offset
        [m], the paper's l_joint and d.
    """

    link_length: NDArray[np.float64]
    link_mass: NDArray[np.float64]
    link_centre: NDArray[np.float64]
    link_inertia: NDArray[np.float64]
    joint_length: float
    wire_offset: float

    def __post_init__(self) -> None:
        """Refuse lengths and masses that no finger has."""
        for name in ("link_length", "link_mass", "link_centre", "link_inertia"):
            value = np.atleast_1d(np.asarray(getattr(self, name), float))
            object.__setattr__(self, name, value)
            _require_one_each(name, value, self.link_length.size)
        require_positive("link_length", self.link_length, "m")
        require_positive("link_mass", self.link_mass, "kg")
        require_nonnegative("link_centre", self.link_centre, "m")
        require_nonnegative("link_inertia", self.link_inertia, "kg m2")
        require_positive("joint_length", self.joint_length, "m")
        require_positive("wire_offset", self.wire_offset, "m")

    @property
    def joints(self) -> int:
        """The number of joints (and links)."""
        return self.link_length.size

    @classmethod
    def uniform(
        cls, link_length: ArrayLike, link_mass: ArrayLike, joint_length: float, wire_offset: float
    ) -> Self:
        """Build a finger of uniform rods.

        The centre is at half length, the inertia about it is m l²/12.

        >>> FingerGeometry.uniform([0.6], [2.0], 0.008, 0.005).link_inertia.round(6)
        array([0.06])
        """
        length, mass = (np.atleast_1d(np.asarray(a, float)) for a in (link_length, link_mass))
        _require_one_each("link_mass", mass, length.size)
        return cls(length, mass, length / 2, mass * length**2 / 12, joint_length, wire_offset)


def _require_one_each(name: str, value: NDArray, links: int) -> None:
    if value.shape != (links,):
        raise Fault(
            f"{name} has shape {value.shape}: it must have one value for each of the {links} links"
        )
