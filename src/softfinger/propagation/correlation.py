"""Whether the parameters go together from trial to trial, and what that does to their shares.

Where the hierarchical model has correlations, they are its own. Where it takes the parameters as
independent, then given a draw of its trials' parameters, standardised by their population, the
correlation has an inverse-Wishart posterior under a prior that makes each correlation uniform on
(−1, 1): one correlation matrix is drawn per posterior draw.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import invwishart

from softfinger.progress import track_progress
from softfinger.propagation.config import read_config
from softfinger.propagation.hyperparameters import NAMES, select_posterior, take_draws
from softfinger.propagation.protocols import group_protocols, select_main_protocol
from softfinger.propagation.shapley import compute_shapley_array
from softfinger.propagation.sobol import QUANTILES, build_sobol_times

DEFINITION = "Shapley effects (Owen 2014) of correlated parameters; {}; c_p without truncation"
FITTED = "correlations of the fitted population"
AFTERWARDS = (
    "correlations from the trials' posterior parameters with an inverse-Wishart prior of uniform "
    "margins, for the fitted model itself takes the parameters as independent, which shrinks "
    "correlations of parameters that single trials hardly determine"
)


def compute_shapley(
    angles: xr.Dataset, posterior: xr.DataTree, config: Mapping[str, Any], rng: np.random.Generator
) -> xr.Dataset:
    """Compute how correlated parameters share the spread of the joint angle, over time.

    Parameters
    ----------
    angles, posterior
        The artifacts of these names; of the posterior also log_k_v, log_c_v, log_c_p, q_ini (chain,
        draw, trial, joint). The load is that of the protocol with most trials.
    config
        The propagation's block, see `PropagationConfig`.

    Returns
    -------
    Dataset
        shapley (joint, time, parameter) and correlation (joint, parameter, other_parameter), means
        over draws, and the same with `_quantile` (…, quantile).
    """
    knobs = read_config(config)
    protocol = select_main_protocol(group_protocols(angles))
    time = build_sobol_times(protocol, knobs)
    population = select_posterior(posterior, knobs.draws)
    trials = take_draws(posterior, NAMES, knobs.draws).to_dataarray("parameter")
    eta = trials.transpose("draw", "trial", "joint", "parameter").to_numpy()
    mu, sigma = (population[name].to_numpy() for name in ("mu", "sigma"))
    if "parameter_correlation" in posterior["posterior"]:
        correlation, source = select_correlations(posterior, knobs.draws), FITTED
    else:
        standard = (eta - mu[:, None]) / sigma[:, None]
        correlation, source = draw_correlations_array(standard, rng), AFTERWARDS
    covariance = correlation * sigma[..., :, None] * sigma[..., None, :]
    load = (protocol.load_time, protocol.load_torque)
    # a lattice of its own for each draw: one for all is as fine as the narrowest and as long as
    # the widest, which costs a hundredfold where a single trial leaves the spread open
    pairs = track_progress(zip(mu, covariance, strict=True), "Shapley effects", total=len(mu))
    effect = np.stack([compute_shapley_array(*pair, time, *load) for pair in pairs])
    parameter = population["parameter"].to_numpy()
    draws = xr.Dataset(
        {
            "shapley": (("draw", "joint", "time", "parameter"), effect),
            "correlation": (("draw", "joint", "parameter", "other_parameter"), correlation),
        },
        coords={
            "joint": population["joint"],
            "time": time,
            "parameter": parameter,
            "other_parameter": parameter,
        },
    )
    bounds = draws.quantile(QUANTILES, dim="draw").transpose(..., "quantile")
    bounds = bounds.rename({name: f"{name}_quantile" for name in draws})
    attrs = {"definition": DEFINITION.format(source), "protocol": protocol.name}
    return xr.merge([draws.mean("draw"), bounds]).assign_attrs(attrs)


def select_correlations(posterior: xr.DataTree, draws: int) -> NDArray[np.float64]:
    """Select the fitted correlations (draw, joint, p, p) of each joint's own parameters."""
    chosen = take_draws(posterior, ["parameter_correlation"], draws)["parameter_correlation"]
    whole = chosen.transpose("draw", "own", "other_own").to_numpy()
    p = len(NAMES)
    starts = range(0, whole.shape[1], p)
    return np.stack([whole[:, at : at + p, at : at + p] for at in starts], axis=1)


def draw_correlations_array(
    z: NDArray[np.float64], rng: np.random.Generator
) -> NDArray[np.float64]:
    """Draw correlation matrices (draw, joint, p, p) from standardised values.

    Parameters
    ----------
    z
        (draw, trial, joint, p), of mean 0 and sd 1 in the population.
    """
    n_draw, n_trial, n_joint, p = z.shape
    scatter = np.eye(p) + np.einsum("dtji,dtjk->djik", z, z)
    out = np.empty((n_draw, n_joint, p, p))
    for draw, joint in np.ndindex(n_draw, n_joint):
        drawn = invwishart(p + 1 + n_trial, scatter[draw, joint]).rvs(random_state=rng)
        sd = np.sqrt(np.diag(drawn))
        out[draw, joint] = drawn / np.outer(sd, sd)
    return out
