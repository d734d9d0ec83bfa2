"""From fitted models to a decision.

Which effects, how probable, what looks alike.

Prior ½ on the base model, the rest shared evenly by the sets of effects that were fitted, and
within a set by its forms. Where several sets remain that share an effect and differ in what they
add to it, and that adds hardly anything, the shared part is what is known.
"""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
from scipy.stats import norm

from softfinger.mismatch.candidates.rank import Candidate
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.priors import PRIORS
from softfinger.mismatch.search.demand import allow_form_error
from softfinger.mismatch.search.stepwise import Search

Ids = frozenset[str]
Refit = Callable[[Candidate, Ids], Candidate | None]


class Posterior(NamedTuple):
    """Posterior probabilities.

    Attributes
    ----------
    sets
        Set of effect ids → probability, most probable first; the empty set is the base model.
    inclusion
        Effect id → probability that it is needed.
    best
        Set of effect ids → its best model.
    """

    sets: dict[Ids, float]
    inclusion: dict[str, float]
    best: dict[Ids, Candidate]

    @property
    def equivalent(self) -> list[Ids]:
        """The fewest sets of effects that reach `DECISIONS.sure` together."""
        total, chosen = 0.0, []
        for ids, probability in self.sets.items():
            chosen.append(ids)
            total += probability
            if total >= DECISIONS.sure:
                break
        return chosen

    @property
    def needs_many(self) -> bool:
        """Whether each likely set has more effects than are named.

        Free laws in three places follow nearly any motion, so that they fit shows no three causes.
        """
        return all(len(ids) > DECISIONS.most_named for ids in self.equivalent)

    def doubt(self, probability: float) -> "Posterior":
        """Allow for a probability of unlisted physics.

        With it, what is missing is not in the catalogue.
        """
        inclusion = {name: probability * p for name, p in self.inclusion.items()}
        return self._replace(inclusion=inclusion)


def weigh_models(
    base: Candidate, others: Iterable[Candidate], free: Ids | None = None
) -> Posterior:
    """Weigh the fitted models by evidence and prior.

    The base model is one of them. What the best set adds to the effects that it shares with another
    may be the error of their textbook forms. It leads the other by no more than exceeds that error.

    Parameters
    ----------
    free
        Effects that have a free law; None where all have.
    """
    groups: dict[Ids, list[Candidate]] = {}
    for candidate in others:
        groups.setdefault(candidate.model.ids - base.model.ids, []).append(candidate)
    groups.pop(frozenset(), None)
    log_weight = {frozenset(): np.log(PRIORS.base) + base.log_evidence}
    for ids, members in groups.items():
        evidence = np.array([member.log_evidence for member in members])
        share = np.logaddexp.reduce(evidence) - np.log(len(members))
        log_weight[ids] = share + np.log((1.0 - PRIORS.base) / len(groups))
    if free is not None and groups:
        log_weight |= _allow_for_forms(base, groups, log_weight, free)
    total = np.logaddexp.reduce(list(log_weight.values()))
    sets = {ids: float(np.exp(weight - total)) for ids, weight in log_weight.items()}
    sets = dict(sorted(sets.items(), key=lambda item: (-item[1], sorted(item[0]))))
    names = dict.fromkeys(name for ids in sets for name in sorted(ids))
    inclusion = {name: sum(p for ids, p in sets.items() if name in ids) for name in names}
    best = {ids: max(members, key=lambda c: c.log_evidence) for ids, members in groups.items()}
    best[frozenset()] = base
    return Posterior(sets, inclusion, best)


def _allow_for_forms(
    base: Candidate, groups: dict[Ids, list[Candidate]], weight: dict[Ids, float], free: Ids
) -> dict[Ids, float]:
    """Log weights of the best set's rivals, with what forms may err."""
    top = max(groups, key=lambda ids: weight[ids])
    allowed = {}
    for ids in groups:
        core = groups.get(ids & top, [])
        if core and not ids <= top and not top <= ids:
            explained = max(c.log_evidence for c in core) - base.log_evidence
            error = allow_form_error(ids & top, explained, free)
            allowed[ids] = min(weight[top], weight[ids] + error)
    return allowed


def settle_search(search: Search, free: Ids | None = None) -> Search:
    """Keep what the likely sets of effects share.

    They disagree about a slight rest, or it is a third effect's.

    Such a rest is too small, and too little like any one effect, to be given a name. A gain may
    pass the test of false alarms, as one in a hundred does by chance. If the base model is still
    the most probable, nothing counts as missing.
    """
    posterior = weigh_models(search.base, search.candidates, free)
    likely = posterior.equivalent
    if not likely[0]:
        return search._replace(best=search.base)
    core = find_core(posterior)
    kept = posterior.best.get(core) if core and [core] != likely else None
    if kept is None or kept.fit is None:
        return search
    added = search.best.log_evidence - kept.log_evidence
    if added > DECISIONS.slight * (kept.log_evidence - search.base.log_evidence):
        return search
    size = len(kept.model.ids)
    fewer = [c for c in search.candidates if len(c.model.ids) <= size]
    more = [c for c in search.candidates if len(c.model.ids) > size]
    return search._replace(candidates=fewer, rejected=[*more, *search.rejected], best=kept)


def find_core(posterior: Posterior) -> Ids:
    """Find what the likely sets share.

    Of more effects than are named it is the best part that has as many.
    """
    core = frozenset.intersection(*posterior.equivalent)
    if len(core) <= DECISIONS.most_named:
        return core
    parts = [ids for ids in posterior.best if ids < core and len(ids) == DECISIONS.most_named]
    return max(parts, key=lambda ids: posterior.best[ids].log_evidence, default=core)


def drop_lent(search: Search) -> Search:
    """Drop effects that only use another's law.

    Play without a gap, with the free spring beyond it, is a stiffening, and competes as that.
    """
    kept = [c for c in search.candidates if c is search.best or not _is_lent(c)]
    return search._replace(candidates=kept)


def _is_lent(candidate: Candidate) -> bool:
    """Whether an effect has nothing but a lent law.

    Its own amplitudes beside it may all be zero.
    """
    if candidate.fit is None:
        return False
    model, fit = candidate.model, candidate.fit
    sure = np.abs(fit.shared) > norm.ppf(0.95) * np.sqrt(np.diag(fit.shared_covariance))
    own = model.amplitudes & ~model.terms
    present = {entry.piece for entry, is_it in zip(model.entries, sure & own, strict=True) if is_it}
    lent = {number for number, piece in enumerate(model.pieces) if piece.form.lent}
    return not lent <= present


def drop_negligible(search: Search, refit: Refit) -> Search:
    """Take back what lies below an effect's floor.

    A good rig's own errors reach that far.

    What is taken back has been explained; so no rival of it, and no larger set, is claimed either.

    Parameters
    ----------
    refit
        Fits a model without some effects, for sets that the search left out.
    """
    best, base = search.best, search.base
    negligible = _list_negligible(best, base)
    if not negligible:
        return search
    wanted = best.model.ids - base.model.ids - negligible
    kept = weigh_models(base, search.candidates).best.get(wanted)
    if wanted and (kept is None or kept.fit is None):
        kept = refit(best, negligible)
    kept = base if kept is None or kept.fit is None else kept
    size = len(kept.model.ids)
    known = [kept, *(c for c in search.candidates if c is not kept)]
    fewer = [c for c in known if base.model.ids < c.model.ids and len(c.model.ids) <= size]
    more = [c for c in search.candidates if len(c.model.ids) > size]
    left = search._replace(candidates=fewer, rejected=[*more, *search.rejected], best=kept)
    if kept is base:
        return left
    # alone, another may explain more than what is left of the best set
    rivals = [c for c in fewer if c.fit is not None and not _list_negligible(c, base)]
    best = max([kept, *rivals], key=lambda c: c.log_evidence)
    return drop_negligible(left._replace(best=best), refit)


def _list_negligible(candidate: Candidate, base: Candidate) -> Ids:
    """Effects of a fitted model that lie below their floors."""
    return candidate.model.list_negligible(candidate.fit.shared) - base.model.ids


def join_ids(ids: Ids) -> str:
    """Name a set of effects.

    >>> join_ids(frozenset({"gravity", "actuator_lag"}))
    'actuator_lag+gravity'
    """
    return "+".join(sorted(ids)) or "none"
