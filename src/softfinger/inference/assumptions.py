"""Test what the fit took for granted.

Independence. With z = (η − μ)/σ of a trial, the slope of log p(y_i) by the correlation of two
parameters, at none, is s_i = E[z_a z_b | y_i] (Fisher's identity), with mean 0 if they are
independent; Σ s_i / √(Σ s_i²) is then about standard normal. No fit with correlations is needed.

Priors. Power-scaling sensitivity of the hyperparameters and of the effects' parameters, by ArviZ,
to their own prior and to the likelihood with the trials' parameters integrated out.

References
----------
Kallioinen, Paananen, Bürkner, Vehtari (2024), Stat. Comput. 34, 57,
doi:10.1007/s11222-023-10366-5.
"""

import arviz_stats as az  # ArviZ without its plots, which take long to import
import numpy as np
import xarray as xr
from scipy.stats import lognorm, norm

from softfinger.inference.density import Effects
from softfinger.inference.priors import PopulationPrior
from softfinger.mechanics import LOG_PARAMETERS


def judge_independence(posterior: xr.Dataset) -> xr.Dataset:
    """Test whether parameters vary together over trials.

    Parameters
    ----------
    posterior
        Parameters of the trials, mu_… and sigma_….

    Returns
    -------
    Dataset
        mean_product, p_value (own, other_own): Σ s_i / n, which is near the correlation where
        the trials are well known, and the two-sided p of every pair (1 on the diagonal);
        smallest_p (), corrected for the number of pairs (Bonferroni).
    """
    joints = posterior["joint"].values
    z = np.stack(
        [
            ((posterior[name] - posterior[f"mu_{name}"]) / posterior[f"sigma_{name}"])
            .transpose("trial", "joint", "chain", "draw")
            .values
            for name in LOG_PARAMETERS
        ],
        axis=2,
    )
    trials = len(z)
    z = z.reshape(trials, len(joints) * len(LOG_PARAMETERS), -1)
    slope = np.einsum("iad,ibd->iab", z, z) / z.shape[-1]
    score = slope.sum(axis=0) / np.sqrt((slope**2).sum(axis=0))
    p_value = 2 * norm.sf(np.abs(score))
    np.fill_diagonal(p_value, 1.0)
    pairs = len(p_value) * (len(p_value) - 1) / 2
    own = [f"{name}[{joint}]" for joint in joints for name in LOG_PARAMETERS]
    dims = ("own", "other_own")
    return xr.Dataset(
        {
            "mean_product": (dims, slope.mean(axis=0)),
            "p_value": (dims, p_value),
            "smallest_p": ((), min(1.0, pairs * p_value.min())),
        },
        {"own": own, "other_own": own},
    )


def measure_prior_sensitivity(
    posterior: xr.Dataset, recording: xr.DataArray, prior: PopulationPrior, effects: Effects
) -> xr.Dataset:
    """Measure how each shared parameter depends on its prior.

    Parameters
    ----------
    recording
        log p(y_i | population, noise) (chain, draw, trial).
    prior, effects
        Those of the fit.

    Returns
    -------
    Dataset
        prior, likelihood (level, parameter, joint), effect_prior, effect_likelihood
        (effect_parameter): ArviZ's psense; above 0.05 is sensitive. Both: prior and data disagree.
        Only the prior: the data determine little.
    """
    logs = {
        "effect": posterior["effect_internal"].copy(
            data=norm.logpdf(posterior["effect_internal"], effects.mean, effects.sd)
        )
    }
    posterior = posterior.assign(effect=posterior["effect_internal"])
    for k, name in enumerate(LOG_PARAMETERS):
        mu, sigma = posterior[f"mu_{name}"], posterior[f"sigma_{name}"]
        log_mu = norm.logpdf(mu, prior.mu_mean[k], prior.mu_sd[k])
        log_sigma = lognorm.logpdf(sigma, prior.sigma_log_sd[k], scale=prior.sigma_median[k])
        logs[f"mu_{name}"], logs[f"sigma_{name}"] = mu.copy(data=log_mu), mu.copy(data=log_sigma)
    tree = xr.DataTree.from_dict(
        {
            "posterior": posterior[[*logs]],
            "log_prior": xr.Dataset(logs),
            "log_likelihood": recording.to_dataset(name="recording"),
        }
    )
    found = {}
    for group in ("prior", "likelihood"):
        sensitivity = az.psense(tree, group=group)
        found[f"effect_{group}"] = sensitivity["effect"].variable
        levels = [
            np.stack([sensitivity[f"{level}_{name}"].values for name in LOG_PARAMETERS])
            for level in ("mu", "sigma")
        ]
        found[group] = (("level", "parameter", "joint"), np.stack(levels))
    coords = {
        "level": ["mu", "sigma"],
        "parameter": list(LOG_PARAMETERS),
        "joint": posterior["joint"],
        "effect_parameter": posterior["effect_parameter"],
    }
    return xr.Dataset(found, coords)
