"""Elements and networks: a tree.

It is read as stiffness or compliance at any Laplace variable s.

    spring     τ = k q          S(s) = k
    dashpot    τ = c q̇          S(s) = c s
    springpot  τ = V d^a q/dt^a S(s) = V s^a,  0 < a < 1
    parallel   stiffnesses S add        series   compliances C = 1/S add

Misprint: the paper prints the transfer function of its own joint (three_element) with c₂ k_v s in
the denominator; it is q/τ = ((c_v + c_p) s + k_v) / (s (c_v c_p s + c_p k_v)).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from softfinger.faults import Fault
from softfinger.mechanics.checks import require_positive


@dataclass(frozen=True)
class Spring:
    """τ = stiffness · q, stiffness [N m/rad]."""

    stiffness: float

    def __post_init__(self) -> None:
        """Refuse a stiffness that is not positive."""
        require_positive("stiffness", self.stiffness, "N m/rad")


@dataclass(frozen=True)
class Dashpot:
    """τ = damping · q̇, damping [N m s/rad]."""

    damping: float

    def __post_init__(self) -> None:
        """Refuse a damping that is not positive."""
        require_positive("damping", self.damping, "N m s/rad")


@dataclass(frozen=True)
class Springpot:
    """A springpot, between spring and dashpot.

    τ = coefficient · d^exponent q/dt^exponent, coefficient [N m s^exponent/rad].
    """

    coefficient: float
    exponent: float

    def __post_init__(self) -> None:
        """Refuse wrong coefficients and exponents."""
        require_positive("coefficient", self.coefficient, "N m s^a/rad")
        if not 0.0 < self.exponent < 1.0:
            raise Fault(f"exponent = {self.exponent:g}: it must lie between 0 and 1, both excluded")


@dataclass(frozen=True)
class Network:
    """Parts in series (angles add) or parallel (torques)."""

    kind: Literal["series", "parallel"]
    parts: tuple["Element", ...]

    def __post_init__(self) -> None:
        """Refuse a network without parts."""
        if not self.parts:
            raise Fault(f"a {self.kind} network without parts: it must have at least one")


Element = Spring | Dashpot | Springpot | Network


def series(*parts: Element) -> Network:
    """Put parts one behind the other: their angles add."""
    return Network("series", parts)


def parallel(*parts: Element) -> Network:
    """Put parts side by side: their torques add."""
    return Network("parallel", parts)


def maxwell(stiffness: float, damping: float) -> Network:
    """Build a spring in series with a dashpot."""
    return series(Spring(stiffness), Dashpot(damping))


def kelvin_voigt(stiffness: float, damping: float) -> Network:
    """Build a spring beside a dashpot."""
    return parallel(Spring(stiffness), Dashpot(damping))


def zener(stiffness: float, voigt_stiffness: float, voigt_damping: float) -> Network:
    """Build a spring and Kelvin–Voigt element in series."""
    return series(Spring(stiffness), kelvin_voigt(voigt_stiffness, voigt_damping))


def three_element(k_v: float, c_v: float, c_p: float) -> Network:
    """Build a Kelvin–Voigt element and dashpot in series."""
    return series(kelvin_voigt(k_v, c_v), Dashpot(c_p))


def burgers(
    stiffness: float, voigt_stiffness: float, voigt_damping: float, damping: float
) -> Network:
    """Build Maxwell and Kelvin–Voigt elements in series."""
    voigt = kelvin_voigt(voigt_stiffness, voigt_damping)
    return series(Spring(stiffness), voigt, Dashpot(damping))


def generalised_maxwell(
    equilibrium: float, stiffnesses: Sequence[float], dampings: Sequence[float]
) -> Network:
    """Build a spring beside Maxwell branches."""
    branches = (maxwell(k, c) for k, c in zip(stiffnesses, dampings, strict=True))
    return parallel(Spring(equilibrium), *branches)


def generalised_voigt(
    stiffness: float, stiffnesses: Sequence[float], dampings: Sequence[float]
) -> Network:
    """Build a spring in series with Kelvin–Voigt elements."""
    voigts = (kelvin_voigt(k, c) for k, c in zip(stiffnesses, dampings, strict=True))
    return series(Spring(stiffness), *voigts)


NAMED = {
    "maxwell": {"series": ["spring", "dashpot"]},
    "kelvin_voigt": {"parallel": ["spring", "dashpot"]},
    "zener": {"series": ["spring", {"parallel": ["spring", "dashpot"]}]},
    "three_element": {"series": [{"parallel": ["spring", "dashpot"]}, "dashpot"]},
    "burgers": {"series": ["spring", {"parallel": ["spring", "dashpot"]}, "dashpot"]},
}
"""The named models of a fixed size, as a model file would spell them."""


def build_network(description: str | Mapping, values: Sequence[float]) -> Element:
    """Build a network from a model file's `joint`.

    Parameters
    ----------
    description
        A name of `NAMED`, "spring", "dashpot", "springpot", or {"series" or "parallel": [parts]}.
    values
        In the order of the description: stiffness, damping, or coefficient and exponent.

    Examples
    --------
    >>> build_network({"series": ["dashpot", "spring"]}, [2.0, 0.5])
    Network(kind='series', parts=(Dashpot(damping=2.0), Spring(stiffness=0.5)))
    """
    remaining = iter(values)
    try:
        network = _build(description, remaining)
    except StopIteration:
        raise Fault(f"{len(values)} values for {description}: it needs more") from None
    if next(remaining, None) is not None:
        raise Fault(f"{len(values)} values for {description}: it needs fewer")
    return network


def _build(description: str | Mapping, values: Iterator[float]) -> Element:
    if isinstance(description, Mapping) and len(description) == 1:
        ((kind, parts),) = description.items()
        if kind in ("series", "parallel"):
            return Network(kind, tuple([_build(part, values) for part in parts]))
    elif description in NAMED:
        return _build(NAMED[description], values)
    elif description == "spring":
        return Spring(next(values))
    elif description == "dashpot":
        return Dashpot(next(values))
    elif description == "springpot":
        return Springpot(next(values), next(values))
    raise Fault(
        f"unknown viscoelastic model {description!r}: it must be one of {', '.join(NAMED)}, "
        "spring, dashpot, springpot, or a mapping {series: [...]} or {parallel: [...]}"
    )


def is_fractional(element: Element) -> bool:
    """Tell whether a springpot is anywhere in the network."""
    if isinstance(element, Network):
        return any(is_fractional(part) for part in element.parts)
    return isinstance(element, Springpot)


def compute_impulse(element: Element) -> float:
    """Compute the impulse's weight lim S(s)/s [N m s/rad]."""
    if isinstance(element, Network):
        impulses = np.array([compute_impulse(part) for part in element.parts])
        if element.kind == "parallel":
            return float(impulses.sum())
        return float(1.0 / (1.0 / impulses).sum()) if impulses.all() else 0.0
    return element.damping if isinstance(element, Dashpot) else 0.0


def compute_instant_compliance(element: Element) -> float:
    """Compute J(0) [rad/(N m)].

    It is the angle with which a unit step of torque is met at once.
    """
    if isinstance(element, Network):
        instant = np.array([compute_instant_compliance(part) for part in element.parts])
        if element.kind == "series":
            return float(instant.sum())
        return float(1.0 / (1.0 / instant).sum()) if instant.all() else 0.0
    return 1.0 / element.stiffness if isinstance(element, Spring) else 0.0


def compute_regular_stiffness(element: Element, s: np.ndarray) -> np.ndarray:
    """Compute S(s) less its impulse [N m/rad]."""
    if isinstance(element, Spring):
        return np.full_like(s, element.stiffness)
    if isinstance(element, Dashpot):
        return np.zeros_like(s)
    if isinstance(element, Springpot):
        return element.coefficient * s**element.exponent
    regular = [compute_regular_stiffness(part, s) for part in element.parts]
    if element.kind == "parallel":
        return sum(regular)
    impulses = [compute_impulse(part) for part in element.parts]
    stiffness = 1.0 / sum(1.0 / (c * s + r) for c, r in zip(impulses, regular, strict=True))
    if not all(impulses):
        return stiffness
    missed = sum(r / (c * (c * s + r)) for c, r in zip(impulses, regular, strict=True))
    return stiffness * compute_impulse(element) * missed


def compute_transfer_function(element: Element, s: np.ndarray) -> np.ndarray:
    """Compute the compliance C(s) = q/τ.

    s [1/s] is complex, off the negative real axis; C [rad/(N m)].

    >>> compute_transfer_function(kelvin_voigt(2.0, 1.0), np.array([3.0 + 0j]))
    array([0.2+0.j])
    """
    s = np.asarray(s, complex)
    return 1.0 / (compute_impulse(element) * s + compute_regular_stiffness(element, s))
