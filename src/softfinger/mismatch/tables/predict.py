"""How well trials are predicted by others.

Bands for trials and for load levels left out.

Trials are left out in folds. What the others show of μ and φ is solved in the model linearised at
all trials' modes; for a level that is left out the model is fitted again. New trials are then drawn
from that, moved by the full forward model under the left-out trials' own loads, and noise is added.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.budget import BUDGET as INFERENCE
from softfinger.inference.mixed_effects import hold_omega
from softfinger.inference.mixed_effects_laplace import fit_nonlinear
from softfinger.inference.mixed_effects_linearised import centre_gram
from softfinger.inference.problem import Problem
from softfinger.mechanics import OWN
from softfinger.mechanics.forward.simulate import simulate_joint_angle_array
from softfinger.mechanics.forward.slots import SlotArrays
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.rank import Candidate
from softfinger.mismatch.decisions import DECISIONS


class Population(NamedTuple):
    """Mean, covariance of (μ, φ), and Ω."""

    mean: NDArray[np.float64]
    covariance: NDArray[np.float64]
    omega: NDArray[np.float64]


def learn_without(
    problem: Problem, candidate: Candidate, left_out: NDArray[np.bool_]
) -> Population:
    """Learn the population linearly from other trials."""
    fit = candidate.fit
    moved, near, centre = centre_gram(
        fit.gram, problem.build_prior(candidate.model), fit.own, fit.shared
    )
    solved = hold_omega(moved[~left_out], near, fit.omega)
    return Population(solved.shared + centre, solved.shared_covariance, fit.omega)


def refit_without(
    problem: Problem, candidate: Candidate, left_out: NDArray[np.bool_]
) -> Population | None:
    """Fit the model again to the other trials.

    None where that fails.

    The left-out trials stay in their places with no information, so that whatever differs between
    trials keeps its meaning.
    """
    model, fit = candidate.model, candidate.fit
    known = ~left_out[:, None, None]

    def linearise(own: NDArray, shared: NDArray) -> NDArray:
        return problem.linearise(model, own, shared) * known

    try:
        again = fit_nonlinear(
            linearise,
            problem.build_prior(model),
            problem.build_bounds(model),
            np.tile(INFERENCE.longest_step, problem.trials.joints),
            (fit.own, fit.shared, fit.omega),
            steps=BUDGET.refit_steps,
        )
    except np.linalg.LinAlgError:
        return None
    return learn_without(problem, candidate._replace(fit=again), left_out)


def predict_left_out(
    problem: Problem,
    candidate: Candidate,
    groups: list[tuple[NDArray[np.bool_], Population]],
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Draw new trials' angles under left-out loads.

    (draw, trial, joint, bin) [rad].

    Parameters
    ----------
    groups
        Which trials (trial,) are drawn from which population; NaN for trials in none.
    """
    trials, model = problem.trials, candidate.model
    n, d = len(trials.name), len(candidate.fit.omega)
    drawn = np.full((BUDGET.draws, n, trials.joints, trials.node.shape[1]), np.nan)
    inside = np.any([chosen for chosen, _ in groups], axis=0)  # others need no simulation
    for k in range(BUDGET.draws):
        own, parts = candidate.fit.own.copy(), []
        for chosen, population in groups:
            both = rng.multivariate_normal(population.mean, population.covariance, method="eigh")
            spread = rng.multivariate_normal(np.zeros(d), population.omega, n, method="eigh")
            own[chosen] = both[:d] + spread[chosen]
            shared = np.clip(both[d:], model.low, model.high)
            parts.append((chosen, model.fill_slots(shared)))
        angle, _ = simulate_joint_angle_array(
            own[inside].reshape(-1, trials.joints, OWN),
            _merge_slots(parts, inside),
            [],
            problem.finger,
            trials.node[inside].reshape(inside.sum(), -1),
            trials.load_time[inside],
            trials.load_torque[inside],
            by_own=False,
            tolerance=INFERENCE.angle_error,
        )
        drawn[k, inside] = angle.reshape(inside.sum(), *drawn.shape[2:], 2).mean(axis=-1)
    return drawn


def _merge_slots(parts: list[tuple[NDArray, SlotArrays]], inside: NDArray) -> SlotArrays:
    merged = SlotArrays(*(array.copy() for array in parts[0][1]))
    for chosen, slots in parts[1:]:
        for whole, part in zip(merged, slots, strict=True):
            whole[chosen] = part[chosen]
    return SlotArrays(*(whole[inside] for whole in merged))


def rank_recordings(
    drawn: NDArray[np.float64],
    recorded: NDArray[np.float64],
    noise_sd: NDArray[np.float64],
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Rank recordings (trial, joint, bin) among noisy draws.

    Ranks are in (0, 1), NaN where unknown.

    >>> draws = np.array([1.0, 2.0, 3.0]).reshape(3, 1, 1, 1)
    >>> rank_recordings(draws, np.full((1, 1, 1), 2.5), np.zeros((1, 1, 1)),
    ...                 np.random.default_rng(1))
    array([[[0.625]]])
    """
    noisy = drawn + noise_sd * rng.standard_normal(drawn.shape)
    rank = (np.sum(noisy < recorded, axis=0) + 0.5) / (len(drawn) + 1)
    return np.where(np.isfinite(recorded) & np.isfinite(noisy).all(axis=0), rank, np.nan)


def list_folds(trials: int) -> list[NDArray[np.bool_]]:
    """List the trials to leave out together.

    >>> [int(fold.sum()) for fold in list_folds(7)]
    [2, 2, 1, 1, 1]
    """
    number = np.arange(trials) % min(BUDGET.folds, trials)
    return [number == k for k in range(min(BUDGET.folds, trials))]


def list_levels(problem: Problem) -> dict[float, NDArray[np.bool_]]:
    """List the load levels of a campaign.

    Largest load → its trials; at most six, evenly chosen.

    Empty where all trials reach one level, so that none can be predicted from the others.
    """
    largest = np.abs(problem.trials.load_torque).max(axis=1)
    order = np.argsort(largest, kind="stable")
    jump = np.diff(largest[order]) > DECISIONS.same_level * max(largest.max(), 1e-300)
    number = np.empty(len(largest), int)
    number[order] = np.concatenate([[0], np.cumsum(jump)])
    if number.max() == 0:
        return {}
    chosen = np.unique(np.linspace(0, number.max(), BUDGET.levels).astype(int))
    return {float(np.median(largest[number == k])): number == k for k in chosen}
