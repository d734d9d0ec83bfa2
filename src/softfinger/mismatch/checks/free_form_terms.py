"""What a free-form term may depend on.

Also the model with such a term in it.

Within trials a term adds to a joint's angle a cubic B-spline of time, of the time since the last
change of load, of the load, of the angle itself or, followed late, of its rate, the same in every
trial. Between trials it adds to a joint's parameters a spline of the trial number, of the load or
of a covariate.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from softfinger.faults import Fault
from softfinger.inference.problem import Candidate, Problem
from softfinger.inference.reduce import reduce_trials
from softfinger.inference.setting import load_at
from softfinger.mechanics import LOG_PARAMETERS, OWN
from softfinger.mismatch.checks.locate import list_trial_covariates, time_since_change
from softfinger.mismatch.checks.rate_law import compute_rate_array, follow_late_array
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.priors import PRIORS

ANGLE, RATE = "angle_rad", "rate_rad_per_s"

Array = NDArray[np.float64]


class Term(NamedTuple):
    """A free-form term on top of a fitted model.

    Attributes
    ----------
    argument, span
        What it depends on, and the range of that.
    labels, unit
        Of the quantities that it adds to, each with a spline of its own.
    sizes
        Candidates for the sd of the coefficients.
    linearise
        η (trial, d), φ and coefficients (p + `count`,) → Gram matrices of [∂F/∂η | ∂F/∂φ, … |
        residual], whitened; NaN where there is no motion.
    level
        (knots,), or 0: the basis where the term adds nothing, which is taken off everywhere.
    """

    argument: str
    span: tuple[float, float]
    labels: list[str]
    unit: str
    sizes: tuple[float, ...]
    linearise: Callable[[Array, Array], Array]
    level: Array | float = 0.0

    @property
    def count(self) -> int:
        """Number of coefficients."""
        return len(self.labels) * PRIORS.knots


def list_terms(problem: Problem, candidate: Candidate) -> list[Term]:
    """List the terms that the recordings allow.

    One trial under one load is one course in time, which creep
    gives any shape; so no term within it is tried.
    """
    terms, arguments = [], {}
    if not problem.setting.one_course:
        angle, _ = problem.simulate(candidate.model, candidate.fit.own, candidate.fit.shared)
        arguments = list_arguments(problem, angle) | {RATE: compute_rate_array(problem, candidate)}
    for name, values in arguments.items():
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        if high > low:
            terms.append(_build_within(problem, candidate, name, values, (low, high)))
    for name, values in list_trial_covariates(problem).items():
        if len(np.unique(values[np.isfinite(values)])) >= DECISIONS.least_values:
            terms.append(_build_between(problem, candidate, name, values))
    return terms


def list_arguments(problem: Problem, angle: Array) -> dict[str, Array]:
    """List arguments at nodes (trial, joint, node)."""
    trials = problem.trials
    shape = (len(trials.name), trials.joints, trials.node.shape[1], 2)
    since, load = np.zeros(shape), np.zeros(shape)
    for i, bins in enumerate(trials.bins):
        since[i, :, :bins] = time_since_change(problem, i)[None, :, None]
        load[i, :, :bins] = load_at(trials, i)[None, :, None]
    time = np.broadcast_to(trials.node[:, None], shape)
    flat = (shape[0], shape[1], -1)
    return {
        "time_s": time.reshape(flat),
        "time_since_change_s": np.log1p(np.maximum(since, 0.0) / trials.interval).reshape(flat),
        "load": load.reshape(flat),
        ANGLE: angle,
    }


def evaluate_basis_array(values: Array, derivative: int = 0) -> Array:
    """Evaluate a cubic B-spline basis (…, knots).

    It is clamped, on [0, 1]; its derivatives are evaluated too.

    >>> evaluate_basis_array(np.array([0.0, 0.3, 1.0])).sum(axis=-1).round(12)
    array([1., 1., 1.])
    """
    knots = np.concatenate([[0.0] * 3, np.linspace(0.0, 1.0, PRIORS.knots - 2), [1.0] * 3])
    spline = BSpline(knots, np.eye(PRIORS.knots), 3)
    return spline(np.clip(values, 0.0, 1.0), nu=derivative)


def _build_within(
    problem: Problem, candidate: Candidate, name: str, values: Array, span: tuple[float, float]
) -> Term:
    """Build a term of the angle: F + s(x).

    x is known or, for `ANGLE`, F itself.

    For `RATE` the angle follows s(x) late, and a joint at rest is left where it is.
    """
    joints, p = problem.trials.joints, len(candidate.fit.shared)
    width = span[1] - span[0]
    known = None if name == ANGLE else evaluate_basis_array(_scale(values, span))
    level = 0.0
    if name == RATE:
        level = evaluate_basis_array(_scale(np.zeros(()), span))
        known = follow_late_array(problem, candidate, known - level)

    def linearise(own: Array, shared: Array) -> Array:
        size = own.shape[1] + len(shared) + 1
        coefficients = shared[p:].reshape(joints, PRIORS.knots)
        try:
            angle, slope = problem.simulate(candidate.model, own, shared[:p])
        except (ArithmeticError, Fault):
            return np.full((len(own), size, size), np.nan)
        basis = evaluate_basis_array(_scale(angle, span)) if known is None else known
        if known is None:  # ∂(F + s(F)) = (1 + s′) ∂F
            rate = evaluate_basis_array(_scale(angle, span), 1) / width
            slope = slope * (1.0 + np.einsum("tjnk,jk->tjn", rate, coefficients))[..., None]
        columns = np.zeros((*angle.shape, joints * PRIORS.knots))
        for j in range(joints):
            columns[:, j, :, j * PRIORS.knots : (j + 1) * PRIORS.knots] = basis[:, j]
        moved = angle + np.einsum("tjnk,jk->tjn", basis, coefficients)
        return reduce_trials(problem.trials, moved, np.concatenate([slope, columns], axis=3))

    labels = [f"joint_angle_{j + 1}" for j in range(joints)]
    return Term(name, span, labels, "rad", PRIORS.shape_sizes_rad, linearise, level)


def _scale(values: Array, span: tuple[float, float]) -> Array:
    return np.nan_to_num((values - span[0]) / (span[1] - span[0]))


def _build_between(problem: Problem, candidate: Candidate, name: str, values: Array) -> Term:
    """Build a term of trials' parameters: F(η + s(x)).

    q_ini is left as it is.
    """
    d, p = candidate.fit.own.shape[1], len(candidate.fit.shared)
    seen = np.isfinite(values)
    span = float(values[seen].min()), float(values[seen].max())
    basis = evaluate_basis_array(np.where(seen, _scale(values, span), 0.5))
    basis = (basis - basis.mean(axis=0)) * seen[:, None]
    moving = [k for k in range(d) if k % OWN != OWN - 1]
    spread = np.zeros((len(values), d, len(moving) * PRIORS.knots))
    for place, k in enumerate(moving):
        spread[:, k, place * PRIORS.knots : (place + 1) * PRIORS.knots] = basis

    def linearise(own: Array, shared: Array) -> Array:
        gram = problem.linearise(candidate.model, own + spread @ shared[p:], shared[:p])
        added = np.concatenate([spread, np.zeros((len(own), p + 1, spread.shape[2]))], axis=1)
        same = np.broadcast_to(np.eye(d + p + 1), gram.shape)
        wide = np.concatenate([same[:, :, :-1], added, same[:, :, -1:]], axis=2)
        return wide.transpose(0, 2, 1) @ gram @ wide

    labels = [f"{LOG_PARAMETERS[k % OWN]}_{k // OWN + 1}" for k in moving]
    return Term(name, span, labels, "1", PRIORS.shape_sizes_log, linearise)
