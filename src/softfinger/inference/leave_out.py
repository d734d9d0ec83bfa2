"""Leave-one-trial-out scores of a posterior.

They show how well the other trials predict a trial, its own parameters integrated:

    elpd_i = log p(y_i | y_-i) = log ∫ p(y_i | μ, σ, noise) p(μ, σ, noise | y_-i)

By Pareto-smoothed importance sampling from the posterior of all trials (`arviz.loo`) where that
works. Few trials are no cloud of points: each of them decides some of the many hyperparameters, and
the weights fail (Pareto k > 0.7) even for a perfect model. For such trials the same compiled model
is sampled once more with the likelihood of that trial taken away.

References
----------
Vehtari, Gelman, Gabry (2017), Stat. Comput. 27, 1413, doi:10.1007/s11222-016-9696-4.
"""

import warnings
from collections.abc import Callable

import arviz_stats as az  # ArviZ without its plots, which take long to import
import numpy as np
import xarray as xr
from scipy.special import logsumexp

from softfinger.inference.budget import BUDGET
from softfinger.inference.decisions import DECISIONS
from softfinger.mechanics import LOG_PARAMETERS


def leave_trials_out(
    recording: xr.DataArray,
    posterior: xr.Dataset,
    refit: Callable[[int], tuple[xr.Dataset, np.ndarray]],
    rng: np.random.Generator,
) -> tuple[xr.Dataset, list[xr.Dataset]]:
    """Score every trial by the others' prediction of it.

    Parameters
    ----------
    recording
        log p(y_i | population, noise) (chain, draw, trial) [nats].
    refit
        Samples without trial i and gives log p(y_i | population, noise) of every draw.
    rng
        Resamples draws by their weights.

    Returns
    -------
    scores
        elpd, pareto_k, refitted (trial); pareto_k is that of the importance sampling, whose elpd
        was replaced where `refitted`. The worst trials come first, at most `refits`.
    others
        For every trial draws of hyperparameters, effects and noise (sample, …) without it.
    """
    tree = xr.DataTree.from_dict(
        {"posterior": posterior, "log_likelihood": recording.to_dataset(name="recording")}
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # the bad ones are dealt with here
        estimate = az.loo(tree, pointwise=True, var_name="recording")
    elpd, pareto_k = np.array(estimate.elpd_i, float), np.array(estimate.pareto_k, float)
    worst = [i for i in np.argsort(-pareto_k) if pareto_k[i] > DECISIONS.largest_k]
    worst = worst[: BUDGET.refits // len(pareto_k)]
    weights = estimate.log_weights.transpose("chain", "draw", "trial").values
    weights = np.exp(weights - logsumexp(weights, axis=(0, 1)))
    others = [_resample(posterior, weights[..., i], rng) for i in range(len(elpd))]
    for trial in worst:
        draws, logs = refit(int(trial))
        elpd[trial] = logsumexp(logs) - np.log(logs.size)
        others[trial] = _resample(draws, np.full(logs.shape[:2], 1 / logs.size), rng)
    refitted = np.isin(np.arange(len(elpd)), worst)
    scores = xr.Dataset(
        {
            "elpd": ("trial", elpd, {"units": "1", "long_name": "leave-one-trial-out elpd [nats]"}),
            "pareto_k": ("trial", pareto_k, {"units": "1"}),
            "refitted": ("trial", refitted),
        },
        {"trial": recording["trial"]},
    )
    return scores, others


def _resample(draws: xr.Dataset, weight: np.ndarray, rng: np.random.Generator) -> xr.Dataset:
    """Draw hyperparameters (sample, joint) by weight (chain, draw)."""
    names = [f"{level}_{name}" for level in ("mu", "sigma") for name in LOG_PARAMETERS]
    place = rng.choice(weight.size, BUDGET.left_out_draws, p=weight.ravel())
    chain, draw = (xr.DataArray(at, dims="sample") for at in np.unravel_index(place, weight.shape))
    names += [n for n in ("noise_sd", "effect_internal", "parameter_correlation") if n in draws]
    return draws[names].isel(chain=chain, draw=draw).transpose("sample", ...)
