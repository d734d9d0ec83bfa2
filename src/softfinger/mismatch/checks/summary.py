"""Residuals, spread, elpd and bias of two fits."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import norm

from softfinger.artifacts.verdict import Elpd
from softfinger.inference.disturbed import locate_disturbances
from softfinger.inference.mixed_effects import Prior
from softfinger.inference.mixed_effects_laplace import Fit
from softfinger.inference.mixed_effects_loo import compute_left_out
from softfinger.inference.problem import Candidate, Problem, predict_frames
from softfinger.inference.reduce import whiten_residual
from softfinger.mechanics import LOG_PARAMETERS, OWN
from softfinger.mismatch.priors import PRIORS


def compute_residual(
    problem: Problem, candidate: Candidate, angles: xr.Dataset
) -> NDArray[np.float64]:
    """Recorded minus predicted angle (trial, joint, frame) [rad].

    It is NaN where a frame is not used.

    What a wrong log or clock most probably did counts as predicted.
    """
    chosen = angles.sel(trial=problem.trials.name)
    recorded = chosen["joint_angle"].transpose("trial", "joint", "frame").values
    time = chosen["time"].transpose("trial", "frame").values
    residual = recorded - predict_frames(problem, candidate, angles)
    residual = residual - locate_disturbances(problem, candidate, time)
    used = np.zeros(residual.shape[::2], bool)
    for i, frames in enumerate(problem.trials.used):
        used[i, frames] = True
    return np.where(used[:, None] & problem.trials.present[:, :, None], residual, np.nan)


def compute_elpd(problem: Problem, base: Candidate, final: Candidate) -> Elpd | None:
    """Leave-one-trial-out elpd of two fits; one trial: None."""
    before, after = ((c.fit, problem.build_prior(c.model)) for c in (base, final))
    return compare_elpd(problem, before, after)


def compare_elpd(
    problem: Problem, before: tuple[Fit, Prior], after: tuple[Fit, Prior]
) -> Elpd | None:
    """Leave-one-trial-out elpd, with priors; one trial: None."""
    trials = problem.trials
    if len(trials.name) < 2:
        return None
    rows, logdet = trials.size[trials.protocol], trials.logdet
    before, after = (compute_left_out(*fitted, rows, logdet) for fitted in (before, after))
    difference = after - before
    return Elpd(
        baseline=float(before.sum()),
        final=float(after.sum()),
        difference=float(difference.sum()),
        se=float(np.sqrt(len(difference) * difference.var(ddof=1))),
    )


def compute_spread(problem: Problem, candidate: Candidate) -> NDArray[np.float64]:
    """Variance between trials (joint, 4) of each parameter."""
    return np.diag(candidate.fit.omega).reshape(problem.trials.joints, OWN)


def explain_spread(
    problem: Problem, base: Candidate, final: Candidate
) -> dict[str, dict[str, float]]:
    """Share of trials' variance that physics explains."""
    share = 1.0 - compute_spread(problem, final) / compute_spread(problem, base)
    return {
        name: {str(j + 1): float(share[j, k]) for j in range(len(share))}
        for k, name in enumerate(LOG_PARAMETERS)
    }


def compare_parameters(problem: Problem, base: Candidate, final: Candidate) -> xr.Dataset:
    """Population means before and after, and the bias.

    Returns
    -------
    Dataset
        before, before_sd, after, after_sd, bias (joint, parameter); bias = before − after: of a
        logarithm about the relative error.
    """
    shape = (problem.trials.joints, OWN)
    values = {}
    for word, candidate in (("before", base), ("after", final)):
        values[word] = candidate.fit.mean.reshape(shape)
        values[f"{word}_sd"] = np.sqrt(np.diag(candidate.fit.mean_covariance)).reshape(shape)
    values["bias"] = values["before"] - values["after"]
    return xr.Dataset(
        {name: (("joint", "parameter"), value) for name, value in values.items()},
        coords={"joint": np.arange(1, shape[0] + 1), "parameter": list(LOG_PARAMETERS)},
    )


def compute_excess(problem: Problem, candidate: Candidate) -> tuple[float, float]:
    """Excess of the residual over the noise.

    It is within trials, and has a p-value.

    What a model misses lasts from bin to bin; noise, once whitened, does not, whatever its size.
    With a the correlation of neighbouring whitened residuals r of a joint, pooled over trials,

        a = Σ n_k a_k / Σ n_k,  a_k = Σ r_i r_(i+1) / Σ r_i²,  excess = a / (1 − a)

    is the variance of what lasts over that of what does not (von Neumann 1941, Ann. Math. Stat. 12,
    367). So noise of another size than the quiet windows show is no misfit. The p-value is of what
    lasts over the noise, Σ r_i r_(i+1) / max(Σ r_i², n_k): what lasts below it is no misfit either.
    """
    no_slopes = np.zeros(0, np.int64)
    fit = candidate.fit
    angle = problem.simulate(candidate.model, fit.own, fit.shared, no_slopes)[0]
    follows, above, pairs = 0.0, 0.0, 0
    for trial in range(len(problem.trials.name)):
        left = whiten_residual(problem.trials, angle, trial)
        for joint in left[:, problem.trials.present[trial]].T:
            lasts, square = float(joint[1:] @ joint[:-1]), float(joint @ joint)
            if square > 0.0:
                follows += (len(joint) - 1) * lasts / square
                above += (len(joint) - 1) * lasts / max(square, len(joint))
                pairs += len(joint) - 1
    share = min(follows / max(pairs, 1), np.nextafter(1.0, 0.0))
    sd = np.hypot(max(pairs, 1) ** -0.5, PRIORS.noise_memory_sd)
    return share / (1.0 - share), float(norm.sf(above / max(pairs, 1) / sd))


def compute_square_excess(fit: Fit, rows: NDArray[np.int64]) -> float:
    """Excess of χ² within trials over its expectation.

    Per number.

    Each trial's residual is taken perpendicular to what its own parameters could still take up, so
    the population has no part in it.
    """
    d = len(fit.omega)
    square, freedom = 0.0, 0
    for gram, n in zip(fit.gram, rows, strict=True):
        own, cross = gram[:d, :d], gram[:d, -1]
        rank = int(np.linalg.matrix_rank(own, tol=1e-9 * np.trace(own), hermitian=True))
        square += gram[-1, -1] - cross @ np.linalg.pinv(own, rcond=1e-9, hermitian=True) @ cross
        freedom += n - rank
    return float(square / max(freedom - len(fit.shared), 1) - 1.0)
