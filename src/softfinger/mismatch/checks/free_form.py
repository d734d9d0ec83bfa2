"""A free-form term for what no effect explains.

It is a spline in the argument that fits best.

Coefficients are normal; their sd is the one of a grid that the evidence prefers. One linearisation
ranks the terms. It does not settle them: where every trial has parameters of its own, a spline may
seem to explain how trials differ, by steps far beyond where the model is straight. So the best term
is fitted to the end before it counts.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.budget import BUDGET as INFERENCE
from softfinger.inference.mixed_effects import Prior, fit_linear
from softfinger.inference.mixed_effects_laplace import Fit, fit_nonlinear
from softfinger.inference.mixed_effects_linearised import SharedBounds, centre_gram
from softfinger.inference.problem import Candidate, Problem
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.checks.free_form_terms import Term, evaluate_basis_array, list_terms
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.priors import PRIORS


class FreeForm(NamedTuple):
    """The best free-form term.

    Attributes
    ----------
    gain
        [nats] over the model without it.
    argument, joints
        What it depends on, and the joints in which it differs from zero.
    shape
        Dataset: value, sd (quantity, place).
    fit, prior
        Of the model with the term; its coefficients are the last numbers of φ.
    """

    gain: float
    argument: str
    joints: list[int]
    shape: xr.Dataset
    fit: Fit
    prior: Prior


class TermScore(NamedTuple):
    """Score of a term by one linearisation.

    Its coefficients have some sd; the gain is in [nats].
    """

    gain: float
    size: float
    term: Term


def fit_free_form(problem: Problem, candidate: Candidate) -> FreeForm | None:
    """Fit the free-form term that gains most, if any."""
    scores = [s for t in list_terms(problem, candidate) for s in score_term(problem, candidate, t)]
    best: FreeForm | None = None
    for score in sorted(scores, key=lambda s: -s.gain):
        if score.gain <= (0.0 if best is None else best.gain):
            break
        settled = settle_term(problem, candidate, score, 0.0 if best is None else best.gain)
        if settled is not None and settled.gain > (0.0 if best is None else best.gain):
            best = settled
    return best


def score_term(problem: Problem, candidate: Candidate, term: Term) -> list[TermScore]:
    """Score a term's sizes over the candidate, Ω adapting."""
    fit = candidate.fit
    shared = np.concatenate([fit.shared, np.zeros(term.count)])
    gram = term.linearise(fit.own, shared)
    start = len(fit.omega) + len(fit.shared)
    moved, wide, _ = centre_gram(gram, _widen(problem, candidate, term, 1.0), fit.own, shared)
    without = np.delete(np.delete(moved, np.s_[start:-1], axis=1), np.s_[start:-1], axis=2)
    narrow = wide._replace(mean=wide.mean[:start], precision=wide.precision[:start])
    base = fit_linear(without, narrow, fit.omega).log_evidence
    scores = []
    for size in term.sizes:
        precision = np.concatenate([wide.precision[:start], np.full(term.count, size**-2.0)])
        wider = wide._replace(precision=precision)
        linear = fit_linear(moved, wider, fit.omega, rounds=2, tolerance=0.1)
        scores.append(TermScore(linear.log_evidence - base - np.log(len(term.sizes)), size, term))
    return scores


def settle_term(
    problem: Problem, candidate: Candidate, score: TermScore, rival: float = -np.inf
) -> FreeForm | None:
    """Fit a term to the end.

    It stops where it clearly gains less than a rival [nats].

    None where the model leaves its range.
    """
    term, before, sizes = score.term, candidate.fit, np.log(len(score.term.sizes))
    given = problem.build_bounds(candidate.model)
    free = np.full(term.count, np.inf)
    bounds = SharedBounds(
        np.concatenate([given.low, -free]),
        np.concatenate([given.high, free]),
        np.concatenate([given.step, free]),
    )
    prior = _widen(problem, candidate, term, score.size)
    try:
        fit = fit_nonlinear(
            term.linearise,
            prior,
            bounds,
            np.tile(INFERENCE.longest_step, problem.trials.joints),
            (before.own, np.concatenate([before.shared, np.zeros(term.count)]), before.omega),
            steps=BUDGET.shape_steps,
            rival=before.log_evidence + sizes + rival,
        )
    except np.linalg.LinAlgError:
        return None
    gain = fit.log_evidence - before.log_evidence - sizes
    start = len(before.shared)
    shape = _describe(term, fit.shared[start:], fit.shared_covariance[start:, start:])
    if term.argument == "time_since_change_s":
        shape["place"] = problem.trials.interval * np.expm1(shape["place"])
    return FreeForm(float(gain), term.argument, _list_joints(shape), shape, fit, prior)


def _widen(problem: Problem, candidate: Candidate, term: Term, size: float) -> Prior:
    """Prior with a term's coefficients of sd `size`."""
    prior = problem.build_prior(candidate.model)
    return prior._replace(
        mean=np.concatenate([prior.mean, np.zeros(term.count)]),
        precision=np.concatenate([prior.precision, np.full(term.count, size**-2.0)]),
    )


def _describe(term: Term, mean: NDArray[np.float64], covariance: NDArray[np.float64]) -> xr.Dataset:
    grid = np.linspace(0.0, 1.0, BUDGET.shape_points)
    basis = evaluate_basis_array(grid) - term.level
    blocks = [slice(k * PRIORS.knots, (k + 1) * PRIORS.knots) for k in range(len(term.labels))]
    value = np.stack([basis @ mean[b] for b in blocks])
    sd = np.stack(
        [np.sqrt(np.einsum("gk,kl,gl->g", basis, covariance[b, b], basis)) for b in blocks]
    )
    place = term.span[0] + grid * (term.span[1] - term.span[0])
    return xr.Dataset(
        {
            "value": (("quantity", "place"), value, {"units": term.unit}),
            "sd": (("quantity", "place"), sd, {"units": term.unit}),
        },
        coords={"quantity": term.labels, "place": place},
        attrs={"argument": term.argument},
    )


def _list_joints(shape: xr.Dataset) -> list[int]:
    """Joints in which a spline clearly differs from zero."""
    size = np.abs(shape["value"]) / np.maximum(shape["sd"], 1e-300)
    strong = shape["quantity"][(size.max("place") > DECISIONS.joint_sd).values].values
    return sorted({int(str(label).rsplit("_", 1)[1]) for label in strong})
