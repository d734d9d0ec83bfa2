"""Every effect in every form, ranked by evidence.

A form is scored by one linearisation at each of its starts; the promising ones are fitted, from
the best start, and freed of joints that they do not need.
"""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.mixed_effects_laplace import Fit
from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.effect import Setting
from softfinger.mechanics.effects.model import EffectModel, Piece
from softfinger.mechanics.effects.places import list_places
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.columns import Block, ScoreColumns
from softfinger.mismatch.candidates.law_size import list_sizes, resize_laws
from softfinger.mismatch.candidates.linearised import (
    Linearised,
    drop_places,
    evaluate_linearised,
    place_fit,
)
from softfinger.mismatch.decisions import DECISIONS

Progress = Callable[[Iterable, str], Iterable]


class Score(NamedTuple):
    """A linearised gain [nats], and its best start."""

    model: EffectModel
    gain: float
    shared: NDArray[np.float64]

    @property
    def effect(self) -> str:
        """Id of the effect that is scored."""
        return self.model.pieces[-1].effect.id

    def list_far(self, known: int) -> list[NDArray[np.float64]]:
        """List the far starts (p,) of what is beyond the first `known`."""
        named = [entry.parameter for entry in self.model.entries]
        there = [k >= known for k in range(len(named))]
        return [
            np.where(
                [new and p.name == name for new, p in zip(there, named, strict=True)],
                value,
                self.shared,
            )
            for name, parameter in {p.name: p for p in named[known:]}.items()
            for value in parameter.far
        ]


def list_pieces(setting: Setting) -> tuple[list[Piece], dict[str, str]]:
    """List every form that a campaign allows.

    Also why the other effects cannot show.

    Returns
    -------
    pieces, refused
        `refused`: effect id → reason.
    """
    pieces, refused, kin = [], {}, set()
    for effect in list_effects().values():
        forms = effect.list_forms(setting)
        if isinstance(forms, str):
            refused[effect.id] = forms
            continue
        shared = {form.kin for form in forms} & kin  # tried with an effect before
        kin |= {form.kin for form in forms if form.kin}
        for form in forms:
            if form.kin in shared:
                continue
            pieces.append(Piece(effect, form, list_places(form.parameters, setting)))
            if form.local and setting.joints > 1:
                pieces += [Piece(effect, form, ((j,),)) for j in range(setting.joints)]
    return pieces, refused


def score_pieces(problem: Problem, origin: Candidate, columns: ScoreColumns) -> list[Score]:
    """Score every form that was collected, best first.

    The score is the linearised gain from the form's best start.

    Places that the linearised model does not need are dropped, but where the form has a far start.
    """
    scores = []
    for _, block in choose_starts(problem, origin, columns):
        there = _stand(origin, columns, block)
        smaller, evidence = drop_places(problem, block.model, there, rounds=0)
        if Score(block.model, evidence, block.shared).list_far(len(origin.fit.shared)):
            smaller = block.model  # a place may be needed far from here
        shared = block.shared[block.model.match(smaller)]
        scores.append(Score(smaller, evidence - columns.level, shared))
    return sorted(scores, key=lambda score: -score.gain)


def choose_starts(
    problem: Problem, origin: Candidate, columns: ScoreColumns
) -> list[tuple[float, Block]]:
    """Choose each form's best start and size: gain [nats], block."""
    best: dict[str, tuple[float, Block]] = {}
    for block in columns.blocks:
        label = block.model.pieces[-1].label
        for model in list_sizes(block.model, len(block.model.pieces) - 1):
            sized = block._replace(model=model)
            gain = score_block(problem, origin, columns, sized)
            if label not in best or gain > best[label][0]:
                best[label] = gain, sized
    return list(best.values())


def score_block(problem: Problem, origin: Candidate, columns: ScoreColumns, block: Block) -> float:
    """Linearised gain [nats] of all places over the fit."""
    there = _stand(origin, columns, block)
    return evaluate_linearised(problem, block.model, there, rounds=0) - columns.level


def _stand(origin: Candidate, columns: ScoreColumns, block: Block) -> Linearised:
    gram = columns.linearise(block)
    return Linearised(gram, origin.fit.own, block.shared, origin.fit.omega)


def prune(problem: Problem, candidate: Candidate) -> Candidate:
    """Choose laws' sizes, drop needless places, and fit again."""
    fit = candidate.fit
    there = place_fit(fit)
    sized = resize_laws(problem, candidate.model, there)
    model, _ = drop_places(problem, sized, there, rounds=5)
    if model is candidate.model:
        return candidate
    start = fit.own, fit.shared[candidate.model.match(model)], fit.omega
    refit = problem.fit(model, start, first=fit.first, rival=candidate.log_evidence)
    if refit is None or refit.log_evidence < candidate.log_evidence:
        return candidate
    return Candidate(model, refit, refit.log_evidence)


def rank_pieces(
    problem: Problem,
    origin: Candidate,
    columns: ScoreColumns,
    progress: Progress,
    floor: float = -np.inf,
) -> tuple[list[Candidate], list[Score]]:
    """Score every form, and fit the promising ones.

    The forms are on top of a fitted model; best first.

    `floor` as in `fit_scored`.
    """
    scores = score_pieces(problem, origin, columns)
    return fit_scored(problem, origin, scores, progress, floor), scores


def fit_scored(
    problem: Problem,
    origin: Candidate,
    scores: list[Score],
    progress: Progress,
    floor: float = -np.inf,
    asked: float = -np.inf,
) -> list[Candidate]:
    """Fit every promising form among those scored.

    The best comes first.

    `floor` is the log evidence [nats] below which none of them could be chosen: what others of
    their kind have reached, or what is asked of them. Where none of their kind has reached what is
    `asked`, a fit goes on only as far as it may reach that.

    Promising are the best forms of the leading effects, and every form whose score is near the best
    fit so far. Each gets a few linearisations; one that then leads goes on at once. Those within
    reach of the best go on as well, but for further forms of the same effects that are clearly
    behind. One that does not come to rest counts by what it has reached, for its evidence is at
    least that. Forms that are not fitted count by their score. Those that come near the best are
    freed of needless places.
    """
    leading = set(list(dict.fromkeys(s.effect for s in scores))[: BUDGET.leading])
    begun, candidates, best = [], [], max(origin.log_evidence, floor)
    for score in progress(scores, "fitting effects"):
        gain = best - origin.log_evidence
        much = gain >= BUDGET.far_nats
        near = score.gain >= max(0.0, gain - max(BUDGET.near_nats, BUDGET.near_share * gain))
        near |= much and bool(score.list_far(len(origin.fit.shared)))  # no linear score knows it
        if not near and (score.effect not in leading or score.gain <= BUDGET.hopeless_nats):
            candidates.append(Candidate(score.model, None, origin.log_evidence + score.gain))
            continue
        leading.discard(score.effect)
        fit = _begin(problem, origin, score, best - reaching_nats(gain), much)
        if fit is not None and fit.log_evidence > best:
            fit = go_on(problem, score.model, fit, best - competing_nats(gain))
        if fit is None:
            continue
        best = max(best, fit.log_evidence)
        begun.append((score.model, fit))
    reach = reaching_nats(best - origin.log_evidence)
    begun.sort(key=lambda one: -one[1].log_evidence)
    alike: dict[frozenset[str], list[float]] = {}
    for model, fit in begun:
        before = alike.setdefault(model.ids, [])
        before.append(fit.log_evidence)
        behind = len(before) > BUDGET.alike and before[-1] < before[0] - BUDGET.reach_nats
        if behind or fit.log_evidence < best - reach:
            candidates.append(Candidate(model, None, fit.log_evidence))
            continue
        rival = best - competing_nats(best - origin.log_evidence) if best > asked else asked
        fit = go_on(problem, model, fit, rival)
        if fit is None:
            continue
        if has_reached(fit, rival):
            found = Candidate(model, fit, fit.log_evidence)
            near = fit.log_evidence >= best - BUDGET.reach_nats
            candidates.append(prune(problem, found) if near else found)
        else:
            candidates.append(Candidate(model, None, fit.log_evidence))
    return sorted(candidates, key=lambda c: -c.log_evidence)


def _begin(
    problem: Problem, origin: Candidate, score: Score, rival: float, much: bool
) -> Fit | None:
    """Begin to fit a form.

    By a few linearisations; where much is left out, also by a whole fit from each far start. There
    the evidence has several modes, and the nearest may be a poor one. A whole fit stops where it
    falls behind `rival`, below which it would not go on.
    """

    def fit(shared: NDArray[np.float64], steps: int | None = None) -> Fit | None:
        start = origin.fit.own, shared, origin.fit.omega
        return problem.fit(score.model, start, first=origin.fit.first, steps=steps, rival=rival)

    found = fit(score.shared, BUDGET.first_steps)
    if found is not None and not much:
        much = found.log_evidence - found.first >= BUDGET.far_nats
    far = score.list_far(len(origin.fit.shared))
    if not far or not much:
        return found
    near = None if found is None else go_on(problem, score.model, found, rival)
    return max(filter(None, (near, *map(fit, far))), key=lambda f: f.log_evidence, default=None)


def find_best(candidates: Iterable[Candidate]) -> float:
    """Best log evidence [nats] of fitted models; else −∞."""
    return max((c.log_evidence for c in candidates if c.fit is not None), default=-np.inf)


def competing_nats(gain: float) -> float:
    """Distance [nats] from a best that still competes."""
    return max(DECISIONS.rival_nats, DECISIONS.rival_share * gain)


def reaching_nats(gain: float) -> float:
    """Distance [nats] from a best within which a fit goes on."""
    return max(BUDGET.reach_nats, BUDGET.reach_share * gain)


def has_reached(fit: Fit, rival: float) -> bool:
    """Whether a fit came to rest, or to what is worth reaching."""
    return fit.converged or fit.log_evidence >= rival


def go_on(problem: Problem, model: EffectModel, fit: Fit, rival: float = -np.inf) -> Fit | None:
    """Fit on until at rest, or behind a rival."""
    if fit.converged:
        return fit
    return problem.fit(model, (fit.own, fit.shared, fit.omega), first=fit.first, rival=rival)
