"""Curves of a fitted model's free laws, with bands."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import norm

from softfinger.mechanics.effects.law import Law, build_curves
from softfinger.mechanics.effects.model import EffectModel

PLACES = 41
LOW, HIGH = 0.05, 0.95
TEXTS = ("effect", "argument_name", "kind")


class LawPlace(NamedTuple):
    """A law's effect, joint or (), places in φ."""

    effect: str
    law: Law
    place: tuple[int, ...]
    terms: NDArray[np.int64]


def list_laws(model: EffectModel) -> list[LawPlace]:
    """List a model's free laws, by joint if different."""
    found = []
    for number, piece in enumerate(model.pieces):
        law = piece.form.law
        if law is None:
            continue
        names = {parameter.name for parameter in law.parameters}
        for place in piece.places if law.per != "chain" else [()]:
            terms = [
                k
                for k, entry in enumerate(model.entries)
                if (entry.piece, entry.place) == (number, place) and entry.parameter.name in names
            ]
            found.append(LawPlace(piece.effect.id, law, place, np.array(terms, int)))
    return found


def compute_law_curves(
    model: EffectModel,
    mean: NDArray[np.float64],
    covariance: NDArray[np.float64],
    places: int = PLACES,
) -> xr.Dataset:
    """Compute the curves of free laws.

    Parameters
    ----------
    mean, covariance
        (p,) and (p, p) of φ, on the internal scale.
    places
        How many values of the argument.

    Returns
    -------
    value, low, high (law, place): the curve as it is shown (`Law.kind`) with its 0.05 and 0.95
    quantiles; argument (law, place); effect, argument_name, kind and joint (law,), the joint from
    1, 0 where one law is that of all. No law: an empty dimension.
    """
    laws = list_laws(model)
    x = np.linspace(0.0, 1.0, places)
    rows: dict[str, list] = {name: [] for name in (*TEXTS, "joint", "argument", "value", "low")}
    rows["high"] = []
    for one in laws:
        curves = build_curves(one.law.terms, x)
        spread = covariance[np.ix_(one.terms, one.terms)]
        middle = curves @ mean[one.terms]
        sd = np.sqrt(np.maximum(np.einsum("nk,kl,nl->n", curves, spread, curves), 0.0))
        for name, quantile in {"low": LOW, "value": 0.5, "high": HIGH}.items():
            rows[name].append(one.law.show(middle + norm.ppf(quantile) * sd))
        rows["argument"].append(x * one.law.get_reach(one.place))
        rows["joint"].append(one.place[0] + 1 if one.place else 0)
        rows["effect"].append(one.effect)
        rows["argument_name"].append(one.law.argument)
        rows["kind"].append(one.law.kind)
    curve = {
        name: (("law", "place"), np.array(rows[name], float).reshape(len(laws), places))
        for name in ("argument", "value", "low", "high")
    }
    text = {name: ("law", np.array(rows[name], object)) for name in TEXTS}
    return xr.Dataset({**curve, **text, "joint": ("law", np.array(rows["joint"], int))})
