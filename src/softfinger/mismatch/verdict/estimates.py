"""A verdict's effects: where, how large, in words."""

import numpy as np
import xarray as xr
from scipy.stats import norm

from softfinger.artifacts.verdict import (
    Estimate,
    Location,
    StatedEffect,
    estimate_lognormal,
    estimate_normal,
)
from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics.effects.model import Entry
from softfinger.mechanics.effects.spread import CLOCK, take_spreads
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.checks.locate import find_window
from softfinger.mismatch.search.settle import Posterior
from softfinger.mismatch.search.stepwise import Search
from softfinger.mismatch.verdict.law import state_candidate_curves, state_law
from softfinger.mismatch.verdict.statements import state_effect
from softfinger.units import read_units


def state_effects(
    problem: Problem, search: Search, posterior: Posterior, decision: str
) -> list[StatedEffect]:
    """Effects of the best model; if `ambiguous`, its set."""
    final = search.best
    given = search.base.model.ids
    chosen = [(final, k) for k, p in enumerate(final.model.pieces) if p.effect.id not in given]
    if decision == "ambiguous":
        for ids in posterior.equivalent:
            other = posterior.best[ids]
            known = {c.model.pieces[k].effect.id for c, k in chosen}
            chosen += [
                (other, k)
                for k, piece in enumerate(other.model.pieces)
                if piece.effect.id not in known | given and other.fit is not None
            ]
    others = [*search.candidates, *search.rejected]
    effects = [
        describe(problem, search.base, c, k, posterior).model_copy(
            update={"law": state_law(c, k, others)}
        )
        for c, k in chosen
    ]
    return sorted(effects, key=lambda effect: -effect.probability)


def describe(
    problem: Problem, base: Candidate, candidate: Candidate, number: int, posterior: Posterior
) -> StatedEffect:
    """Describe one effect of a model."""
    piece = candidate.model.pieces[number]
    parameters = estimate_parameters(candidate, number)
    probability = min(1.0, posterior.inclusion[piece.effect.id])
    spread = find_spread(problem.noise, candidate, number)
    return StatedEffect(
        id=piece.effect.id,
        joints=piece.joints,
        probability=probability,
        parameters=parameters,
        spread=spread,
        statement=state_effect(
            piece.effect,
            piece.form.name,
            piece.joints,
            probability,
            parameters,
            spread,
            state_candidate_curves(problem, candidate, number),
            read_units(problem.noise.attrs),
        ),
        location=locate_effect(problem, base, candidate, number),
    )


def find_spread(measurement: xr.Dataset, candidate: Candidate, number: int) -> dict[str, float]:
    """Relative sd between trials of a piece's parameters that differ."""
    found = dict(
        zip(
            measurement["component"].values.astype(str).tolist(),
            measurement["component_size"].values.tolist(),
            strict=True,
        )
    )
    piece = candidate.model.pieces[number]
    spread = take_spreads(piece, candidate.model, found)
    if piece.effect.id == CLOCK and "clock_offset" in found:
        mean = estimate_parameters(candidate, number)["delay_s"].mean
        spread["delay_s"] = found["clock_offset"] / max(abs(mean), found["clock_offset"] / 10.0)
    return spread


def estimate_parameters(candidate: Candidate, number: int) -> dict[str, Estimate]:
    """Posterior of a piece's parameters, by name."""
    sd = np.sqrt(np.diag(candidate.fit.shared_covariance))
    estimates = {}
    for k, entry in enumerate(candidate.model.entries):
        if entry.piece == number:
            estimates |= estimate_entry(entry, float(candidate.fit.shared[k]), float(sd[k]))
    return estimates


def estimate_entry(entry: Entry, mean: float, sd: float) -> dict[str, Estimate]:
    """Posterior of one number of φ, by name.

    What is reported otherwise goes by its quantiles.
    """
    parameter = entry.parameter
    if parameter.term:
        return {}
    if not parameter.report:
        estimate = estimate_lognormal if parameter.log else estimate_normal
        return {entry.name: estimate(mean, sd)}
    level = (np.arange(BUDGET.quantile_points) + 0.5) / BUDGET.quantile_points
    internal = np.clip(mean + sd * norm.ppf(level), parameter.low, None)
    estimates = {}
    for name, values in entry.report(internal).items():
        low, lower, middle, upper, high = np.quantile(values, (0.05, 0.16, 0.5, 0.84, 0.95))
        estimates[name] = Estimate(mean=middle, sd=(upper - lower) / 2, q05=low, q95=high)
    return estimates


def locate_effect(problem: Problem, base: Candidate, candidate: Candidate, number: int) -> Location:
    """Where an effect acts, by each joint's p-value."""
    piece = candidate.model.pieces[number]
    sd = np.sqrt(np.diag(candidate.fit.shared_covariance))
    joints = {str(j + 1): 1.0 for j in range(problem.trials.joints)}
    for k, entry in enumerate(candidate.model.entries):
        if entry.piece == number and entry.parameter.amplitude:
            tail = 2 * norm.sf(abs(candidate.fit.shared[k]) / sd[k])
            tail = float(min(1.0, max(tail, 1e-300) * problem.trials.joints))
            touched = [entry.place[0]] if entry.place else range(problem.trials.joints)
            for j in touched:
                joints[str(j + 1)] = min(joints[str(j + 1)], tail)
    between = piece.effect.level == "between_trials"
    return Location(
        level=piece.effect.level,
        joints=joints,
        times_s=None if between else find_window(problem, base, candidate),
        trials=None,
        covariate=name_covariate(piece) if between else None,
    )


def name_covariate(piece: object) -> str:
    """What a between-trials effect moves with."""
    return piece.form.covariate or "trial_number"
