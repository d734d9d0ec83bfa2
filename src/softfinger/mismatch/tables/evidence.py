"""What a search found, as tables."""

import numpy as np
import xarray as xr

from softfinger.inference.problem import Problem
from softfinger.mismatch.candidates.rank import Candidate
from softfinger.mismatch.checks.lines import Line
from softfinger.mismatch.checks.locate import locate_between, locate_within
from softfinger.mismatch.search.calibrate import FalseAlarms
from softfinger.mismatch.search.settle import Posterior, join_ids
from softfinger.mismatch.search.stepwise import Search

MODELS = ("base", "final")


def tabulate_ranking(
    search: Search, posterior: Posterior, alarms: FalseAlarms, needed: float
) -> xr.Dataset:
    """Tabulate every model that was fitted, best first.

    Returns
    -------
    Dataset
        gain [nats], fitted, model_effects (model); set_probability (effect_set); inclusion,
        best_gain (effect), alone in a model; refused_reason (refused_effect); chance_gain
        (replicate), the largest gains of the bootstrap, and needed_gain [nats].
    """
    base = search.base.log_evidence
    best: dict[str, Candidate] = {}
    for candidate in [search.base, *search.candidates, *search.rejected, *search.beyond]:
        known = best.get(candidate.model.label)
        if known is None or candidate.log_evidence > known.log_evidence:
            best[candidate.model.label] = candidate
    ordered = sorted(best.items(), key=lambda item: (-item[1].log_evidence, item[0]))
    gain = {label: candidate.log_evidence - base for label, candidate in ordered}
    alone: dict[str, float] = {}
    for label, candidate in ordered:
        added = candidate.model.ids - search.base.model.ids
        if len(added) == 1:
            alone.setdefault(next(iter(added)), gain[label])
    sets = {join_ids(ids): p for ids, p in posterior.sets.items()}
    inclusion = {name: posterior.inclusion.get(name, 0.0) for name in alone}
    return xr.Dataset(
        {
            "gain": ("model", np.array(list(gain.values()), float)),
            "fitted": ("model", np.array([c.fit is not None for _, c in ordered], bool)),
            "model_effects": ("model", [join_ids(c.model.ids) for _, c in ordered]),
            "set_probability": ("effect_set", np.array(list(sets.values()), float)),
            "inclusion": ("effect", np.array(list(inclusion.values()), float)),
            "best_gain": ("effect", np.array(list(alone.values()), float)),
            "refused_reason": ("refused_effect", list(search.refused.values())),
            "chance_gain": ("replicate", alarms.gain),
            "needed_gain": ((), float(needed)),
        },
        coords={
            "model": list(gain),
            "effect_set": list(sets),
            "effect": list(alone),
            "refused_effect": list(search.refused),
            "replicate": np.arange(len(alarms.gain)),
        },
    )


def tabulate_location(
    problem: Problem, base: Candidate, final: Candidate, line: Line
) -> xr.Dataset:
    """Tabulate where the base and final model miss.

    Returns
    -------
    Dataset
        As `locate_within` (model, joint, phase, window), `locate_between` with the prefix
        `correlation` (model, joint, parameter, covariate), and the line.
    """
    parts = []
    for candidate in (base, final):
        between = locate_between(problem, candidate)
        names = {"p_value": "correlation_p_value", "q_value": "correlation_q_value"}
        parts.append(xr.merge([locate_within(problem, candidate), between.rename(names)]))
    both = xr.concat(parts, xr.IndexVariable("model", list(MODELS)))
    return both.assign(
        line_frequency=((), line.frequency_hz),
        line_joint=((), line.joint),
        line_p_value=((), line.p_value),
    )
