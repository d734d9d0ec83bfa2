"""A free law in an effect's own place.

A textbook form is one curve that nature may have. A free law is any smooth curve of the same
argument: Chebyshev terms that vanish at x = 0, higher ones shrunk more by their prior,

    law(x) = Σ w_k [T_k(2 x − 1) − T_k(−1)],   w_k ~ N(0, (size/k²)²),   x = argument / reach.

A finer law has more terms, shrunk as size/k: for curves with corners and waves, where the first has
left something. The size is the form's, or a part of it that the evidence chooses (`Piece.size`).
The terms are parameters like any other, so fit, evidence and prediction know nothing of it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Literal

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from softfinger.faults import Fault
from softfinger.mechanics.effects.effect import FREE, Form, Parameter, Values, signed
from softfinger.mechanics.forward.curve import KNOTS, build_weights, draw_curve

FLOOR = 2e-3  # of a term's prior sd
ALIKE, EACH = f"{FREE}_alike", f"{FREE}_each"
MOST_TERMS = KNOTS - 4
"""That the knots can follow: those of a finer law."""
_PLACES = np.linspace(0.0, 1.0, KNOTS)  # of the reach: values there determine a curve


@dataclass(frozen=True, eq=False)
class Law:
    """What a free law depends on.

    Attributes
    ----------
    name
        Of its terms; where the forward model has a slot for it, the slot's.
    argument
        What it depends on, its unit as suffix.
    reach
        Where the law ends, in the argument's unit: one for all joints, or (joint,).
    size
        Prior scale of the law.
    terms
        How many.
    per
        One law for the chain, one for each joint, or one for each two neighbours.
    kind
        What a reader is shown: the `factor` 1 + law, the `exponential` e^law, or the law itself
        as a `sum`.
    smooth
        Power of k by which higher terms are shrunk.
    """

    name: str
    argument: str
    reach: ArrayLike
    size: float
    terms: int = 7
    per: Literal["chain", "joint", "neighbours"] = "chain"
    kind: Literal["factor", "exponential", "sum"] = "factor"
    smooth: int = 2

    def __post_init__(self) -> None:
        """Refuse a law without a smooth, finite curve."""
        reach = np.asarray(self.reach, float)
        faults = {
            f"reach is {self.reach}; expected positive numbers": not np.all(
                np.isfinite(reach) & (reach > 0.0)
            ),
            f"size is {self.size}; expected a positive number": not 0.0 < self.size < np.inf,
            f"terms is {self.terms}; expected 1 to {MOST_TERMS}": not 1 <= self.terms <= MOST_TERMS,
        }
        for fault, is_there in faults.items():
            if is_there:
                raise Fault(f"law {self.name!r} of {self.argument!r}: its {fault}")

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """One parameter for each term."""
        sizes = [float(self.size / k**self.smooth) for k in range(1, self.terms + 1)]
        return tuple(
            signed(f"{self.name}_{k}", sd, per=self.per, floor=FLOOR * sd, term=True)
            for k, sd in enumerate(sizes, start=1)
        )

    def show(self, law: NDArray[np.float64]) -> NDArray[np.float64]:
        """Turn the law into what a reader is shown."""
        return {"factor": 1.0 + law, "exponential": np.exp(law), "sum": law}[self.kind]

    def hide(self, shown: NDArray[np.float64]) -> NDArray[np.float64]:
        """Turn what a reader is shown into the law."""
        if self.kind == "exponential":
            return np.log(shown)
        return shown - 1.0 if self.kind == "factor" else shown

    def get_reach(self, place: tuple[int, ...]) -> float:
        """Where the law ends, by joint or ()."""
        reach = np.asarray(self.reach, float)
        return float(reach[place[0]] if place and reach.ndim else reach)

    def fill(self, values: Values) -> NDArray[np.float64]:
        """Coefficients of the curve, (knot,) or (joint, knot); of neighbours the lower's."""
        terms = [np.asarray(values[parameter.name])[..., None] for parameter in self.parameters]
        curves = np.concatenate(terms, axis=-1) @ build_terms(self.terms)
        if self.per != "neighbours":
            return curves
        lower = np.arange(len(curves) - 1)
        return np.concatenate([curves[lower, lower + 1], np.zeros((1, curves.shape[-1]))])

    def evaluate(self, values: Values, argument: NDArray[np.float64]) -> NDArray[np.float64]:
        """The law at arguments (n,): (n,) or (joint, n)."""
        return draw_curve(self.fill(values), argument / np.asarray(self.reach))


def build_curves(terms: int, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Matrix (n, term) from terms to values (n,)."""
    return build_weights(x) @ build_terms(terms).T


@cache
def build_terms(terms: int) -> NDArray[np.float64]:
    """Build the coefficients of all terms' curves.

    They are (term, knot).

    Examples
    --------
    >>> draw_curve(build_terms(1), np.array([0.0, 0.5, 1.0])).round(9) + 0.0
    array([[0., 1., 2.]])
    """
    x = 2.0 * _PLACES - 1.0
    curves = np.array([chebyshev.Chebyshev.basis(k)(x) for k in range(1, terms + 1)])
    coefficients = np.linalg.solve(build_weights(_PLACES), (curves - curves[:, :1]).T).T
    coefficients.flags.writeable = False  # it is kept
    return coefficients


def make_alike(law: Law) -> Law:
    """One law for all joints, in place of one for each."""
    return replace(law, per="chain", reach=float(np.max(law.reach)))


def free_form(
    law: Law,
    constants: Mapping[str, ArrayLike],
    form: Form | None = None,
    *,
    local: bool = False,
    lent: bool = False,
    name: str = FREE,
) -> Form:
    """Build the free form of an effect, and the finer one.

    Parameters
    ----------
    constants
        Slots that go with it: where the law ends, what it is a law of.
    form
        A textbook form to which it is added.
    local, lent
        As in `Form`.
    """
    known = () if form is None else form.parameters

    def build(name: str, law: Law, finer: Form | None) -> Form:
        def slots(values: Values) -> dict:
            rest = {} if form is None else form.slots({p.name: values[p.name] for p in known})
            return {**rest, **constants, law.name: law.fill(values)}

        parameters = (*known, *law.parameters)
        kinds = {"local": local, "lent": lent, "linear": True}
        return Form(name, parameters, slots, law=law, finer=finer, **kinds)

    finer = build(f"{name}_finer", replace(law, terms=MOST_TERMS, smooth=1), None)
    return build(name, law, finer)


def list_free_forms(
    law: Law,
    reach: str,
    joints: int,
    constants: Mapping[str, ArrayLike] | None = None,
    name: str = FREE,
) -> list[Form]:
    """A law of each joint's own, and one for all joints.

    `reach` is the slot that states where it ends; `constants` as in `free_form`.
    """
    fixed = dict(constants or {})
    own = free_form(law, {**fixed, reach: law.reach}, name=name)
    if joints == 1:
        return [own]
    alike = make_alike(law)
    return [own, free_form(alike, {**fixed, reach: alike.reach}, name=f"{name}_alike")]
