"""An effect's free law in a verdict."""

from collections.abc import Iterable

from softfinger.artifacts.verdict import StatedLaw
from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics.effects.law_curve import compute_law_curves, list_laws
from softfinger.mismatch.verdict.statements import state_curves
from softfinger.units import read_units


def state_candidate_curves(problem: Problem, candidate: Candidate, number: int) -> str:
    """State the free laws of one effect of a fitted model."""
    fit = candidate.fit
    laws = compute_law_curves(candidate.model, fit.shared, fit.shared_covariance, places=2)
    units = read_units(problem.noise.attrs)
    return state_curves(laws, candidate.model.pieces[number].effect.id, units)


def state_law(candidate: Candidate, number: int, others: Iterable[Candidate]) -> StatedLaw | None:
    """State the free law of one effect.

    None where its form is a textbook's.

    Parameters
    ----------
    others
        Other fitted models: of those with the same effects, the best of each textbook form shows
        how far that form is from the law [nats].
    """
    piece = candidate.model.pieces[number]
    mine = [one for one in list_laws(candidate.model) if one.effect == piece.effect.id]
    if not mine:
        return None
    nats: dict[str, float] = {}
    for other in others:
        if other.fit is None or other.model.ids != candidate.model.ids:
            continue
        form = next(p.form for p in other.model.pieces if p.effect.id == piece.effect.id)
        if not form.is_free:
            behind = other.log_evidence - candidate.log_evidence
            nats[form.name] = max(behind, nats.get(form.name, behind))
    return StatedLaw(
        argument=mine[0].law.argument,
        form=piece.form.name,
        range=(0.0, max(one.law.get_reach(one.place) for one in mine)),
        artifact="laws.nc",
        forms_nats=nats,
    )
