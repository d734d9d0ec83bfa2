"""Whether parameters are correlated.

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

from softfinger.inference.motion import Move, move_paper_joint
from softfinger.mechanics import LOG_PARAMETERS, OWN
from softfinger.propagation.config import ShapleyConfig, read_config
from softfinger.propagation.new_trials import Source
from softfinger.propagation.populations import (
    are_independent,
    select_own_blocks_array,
    select_posterior,
    take_population_draws,
)
from softfinger.propagation.protocols import (
    describe_truncation,
    group_protocols,
    select_main_protocol,
)
from softfinger.propagation.routes import choose_route
from softfinger.propagation.sobol import build_sobol_times, compute_quantiles
from softfinger.propagation.subsets import compute_shapley_effects

DEFINITION = "Shapley effects (Owen 2014) of correlated parameters; truncation of c_p: {}; {}"
FITTED = "correlations of the fitted population"
AFTERWARDS = (
    "correlations from the trials' posterior parameters, with an inverse-Wishart prior of uniform "
    "margins. The fitted model itself takes the parameters as independent; this shrinks "
    "correlations of parameters that single trials hardly determine"
)


def compute_shapley(
    angles: xr.Dataset,
    posterior: xr.DataTree,
    config: Mapping[str, Any],
    rng: np.random.Generator,
    move: Move = move_paper_joint,
) -> xr.Dataset:
    """Compute how correlated parameters share the angle's spread.

    Parameters
    ----------
    angles, posterior
        The artifacts of these names; of the posterior also log_k_v, log_c_v, log_c_p, q_ini (chain,
        draw, trial, joint). The load is that of the protocol with most trials.

    Returns
    -------
    Dataset
        shapley (joint, time, parameter) and correlation (joint, parameter, other_parameter), means
        over draws, and the same with `_quantile` (…, quantile).
    """
    knobs = read_config(config, ShapleyConfig)
    protocol = select_main_protocol(group_protocols(angles))
    time = build_sobol_times(protocol, knobs)
    population, source = select_posterior(posterior, knobs.draws), FITTED
    if are_independent(population):
        population, source = _correlate_afterwards(posterior, population, rng), AFTERWARDS
    moved = Source(population, move, knobs, int(rng.integers(2**32)))
    effect = compute_shapley_effects(choose_route(moved).share_variance(moved, protocol, time))
    correlation = select_own_blocks_array(population["correlation"].to_numpy())
    series, pairs = ("joint", "time", "parameter"), ("joint", "parameter", "other_parameter")
    parameter = population["parameter"].to_numpy()
    coords = {"joint": population["joint"], "parameter": parameter}
    parts = [
        xr.Dataset({"shapley": (("draw", *series), effect)}, {**coords, "time": time}),
        xr.Dataset(
            {"correlation": (("draw", *pairs), correlation)},
            {**coords, "other_parameter": parameter},
        ),
    ]
    parts += [compute_quantiles(part) for part in parts]
    text = DEFINITION.format(describe_truncation(knobs.c_p_truncation_sd), source)
    means = [part.mean("draw") if "draw" in part.dims else part for part in parts]
    return xr.merge(means).assign_attrs(definition=text, protocol=protocol.name)


def draw_correlations_array(
    z: NDArray[np.float64], rng: np.random.Generator
) -> NDArray[np.float64]:
    """Draw correlation matrices from standardised values.

    They are (draw, joint, p, p).

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


def _correlate_afterwards(
    posterior: xr.DataTree, population: xr.Dataset, rng: np.random.Generator
) -> xr.Dataset:
    """Give populations their trials' correlations within joints."""
    trials = take_population_draws(
        posterior, LOG_PARAMETERS, population.sizes["draw"]
    ).to_dataarray("parameter")
    own = trials.transpose("draw", "trial", "joint", "parameter").to_numpy()
    mu, sigma = (population[name].to_numpy()[:, None] for name in ("mu", "sigma"))
    whole = np.zeros(population["correlation"].shape)
    for joint, block in enumerate(
        np.moveaxis(draw_correlations_array((own - mu) / sigma, rng), 1, 0)
    ):
        places = slice(OWN * joint, OWN * (joint + 1))
        whole[:, places, places] = block
    return population.assign(correlation=(population["correlation"].dims, whole))
