"""The `law` of a model file: values at places."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, model_validator
from scipy.interpolate import CubicSpline

from softfinger.mechanics.effects.law import FLOOR, build_curves
from softfinger.mechanics.effects.law_curve import LawPlace, list_laws
from softfinger.mechanics.effects.model import EffectModel, Known

PLACES, DIGITS = 25, 6  # twice as many places as a finer law has terms
_INSIDE = np.linspace(0.0, 1.0, PLACES)


class LawEntry(BaseModel):
    """Values of a law at places.

    The places are of its argument; it is smooth between. `sd` is of each value, where known.
    """

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)
    argument: str
    at: Annotated[list[float], Field(min_length=2)]
    value: list[float]
    sd: list[float] | None = None

    @model_validator(mode="after")
    def _fit_together(self) -> "LawEntry":
        if any(len(row) != len(self.at) for row in (self.value, self.sd or self.at)):
            raise ValueError(
                f"value and sd must have as many numbers as at, which has {len(self.at)}"
            )
        if not all(a < b for a, b in zip(self.at, self.at[1:], strict=False)):
            raise ValueError("at must rise from number to number")
        return self


def describe_laws(
    model: EffectModel, number: int, mean: NDArray[np.float64], covariance: NDArray[np.float64]
) -> LawEntry | list[LawEntry] | None:
    """Describe one piece's laws, given φ's covariance."""
    piece = model.pieces[number]
    laws = [one for one in list_laws(model) if one.effect == piece.effect.id]
    entries = [_describe(one, mean, covariance) for one in laws]
    return entries[0] if len(entries) == 1 and not laws[0].place else entries or None


def _describe(one: LawPlace, mean: NDArray, covariance: NDArray) -> LawEntry:
    curves = build_curves(one.law.terms, _INSIDE)
    law = curves @ mean[one.terms]
    spread = covariance[np.ix_(one.terms, one.terms)]
    sd = np.sqrt(np.maximum(np.einsum("nk,kl,nl->n", curves, spread, curves), 0.0))
    value = one.law.show(law)
    steep = np.abs(value) if one.law.kind == "exponential" else 1.0
    return LawEntry(
        argument=one.law.argument,
        at=_round(_INSIDE * one.law.get_reach(one.place)),
        value=_round(value),
        sd=_round(sd * steep),
    )


def read_laws(
    given: LawEntry | list[LawEntry] | None, model: EffectModel, place: str, faults: list[str]
) -> Known:
    """Fit terms to one effect's laws; add `faults`."""
    if given is None:
        return {}
    entries = given if isinstance(given, list) else [given]
    laws = list_laws(model)
    if len(laws) != len(entries):
        faults.append(f"{place}: it has {len(entries)} laws; this form has {len(laws)}")
        return {}
    known = {}
    for one, entry in zip(laws, entries, strict=True):
        known |= _read(one, entry, model, place, faults)
    return known


def _read(
    one: LawPlace, entry: LawEntry, model: EffectModel, place: str, faults: list[str]
) -> Known:
    if entry.argument != one.law.argument:
        faults.append(f"{place}: its law is of {entry.argument!r}; expected {one.law.argument!r}")
        return {}
    value = np.array(entry.value)
    if one.law.kind == "exponential" and value.min() <= 0.0:
        faults.append(f"{place}: its law has the value {value.min():g}; expected positive ones")
        return {}
    steep = value if one.law.kind == "exponential" else 1.0
    error = np.zeros(len(value)) if entry.sd is None else np.array(entry.sd) / steep
    at = np.array(entry.at) / one.law.get_reach(one.place)
    law, width = _continue(at, one.law.hide(value), error)
    prior = np.array([model.entries[k].parameter.sd for k in one.terms])
    inverse = np.linalg.pinv(build_curves(one.law.terms, _INSIDE))
    terms = inverse @ law
    sd = np.maximum(np.sqrt(inverse**2 @ width**2), FLOOR * prior)
    return {
        (one.effect, model.entries[k].name): (float(term), float(width))
        for k, term, width in zip(one.terms, terms, sd, strict=True)
    }


def _continue(at: NDArray, law: NDArray, error: NDArray) -> tuple[NDArray, NDArray]:
    """Values and errors of a law.

    Inside the reach it is smooth between its places, outside it is straight.

    Outside, the error grows by as much as the law does.
    """
    curve = CubicSpline(at, law)
    near = np.clip(_INSIDE, at[0], at[-1])
    beyond = curve(near, 1) * (_INSIDE - near)
    return curve(near) + beyond, np.interp(near, at, error) + np.abs(beyond)


def _round(values: NDArray[np.float64]) -> list[float]:
    return [float(f"{value:.{DIGITS}g}") for value in values]
