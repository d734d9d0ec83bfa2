"""Populations to propagate: the two-stage estimate, and draws of the posterior, in one shape."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from softfinger.faults import Fault
from softfinger.mechanics import PARAMETERS

ESTIMATES = ("two_stage", "posterior")
NAMES = ("log_k_v", "log_c_v", "log_c_p", "q_ini")  # of the populations, in order of PARAMETERS


def select_two_stage(least_squares: xr.Dataset) -> xr.Dataset:
    """Select the population of the paper's two-stage estimate.

    Parameters
    ----------
    least_squares
        The `least_squares` artifact: population_mean, population_sd (joint, parameter),
        residual_rms (trial, joint) [rad].

    Returns
    -------
    Dataset
        mu, sigma (draw, joint, parameter), of the logs except for q_ini [rad], and noise_sd
        (draw, joint) [rad], the median residual; one draw.
    """
    chosen = least_squares.sel(parameter=list(PARAMETERS))
    return (
        xr.Dataset(
            {
                "mu": chosen["population_mean"].transpose("joint", "parameter"),
                "sigma": chosen["population_sd"].transpose("joint", "parameter"),
                "noise_sd": least_squares["residual_rms"].median("trial"),
            }
        )
        .drop_vars(["trial"], errors="ignore")
        .expand_dims(draw=1)
    )


def select_posterior(posterior: xr.DataTree, draws: int) -> xr.Dataset:
    """Select populations from the posterior, spread evenly over chains and draws.

    Parameters
    ----------
    posterior
        The `posterior` artifact: mu_* and sigma_* (chain, draw, joint) of every population and
        noise_sd (chain, draw, joint) [rad].
    draws
        At most so many.

    Returns
    -------
    Dataset
        As `select_two_stage`, with as many draws as asked for or there are.

    Raises
    ------
    Fault
        If a hyperparameter is missing.
    """
    wanted = [f"{kind}_{name}" for kind in ("mu", "sigma") for name in NAMES] + ["noise_sd"]
    stacked = take_draws(posterior, wanted, draws)
    parameter = xr.IndexVariable("parameter", list(PARAMETERS))
    population = {
        kind: xr.concat([stacked[f"{kind}_{name}"] for name in NAMES], parameter).transpose(
            "draw", "joint", "parameter"
        )
        for kind in ("mu", "sigma")
    }
    noise_sd = stacked["noise_sd"].transpose("draw", "joint")
    return xr.Dataset({**population, "noise_sd": noise_sd})


def take_draws(posterior: xr.DataTree, names: Sequence[str], draws: int) -> xr.Dataset:
    """Take at most so many draws of some variables, spread evenly over chains and draws.

    Raises
    ------
    Fault
        If the posterior lacks one of the variables.
    """
    group = posterior["posterior"].to_dataset()
    missing = [name for name in names if name not in group]
    if missing:
        raise Fault(
            f"the posterior holds no {', '.join(missing)}: propagation needs every hyperparameter; "
            "fit the campaign again"
        )
    stacked = group[list(names)].stack(sample=("chain", "draw")).reset_index("sample", drop=True)
    chosen = np.linspace(0, stacked.sizes["sample"] - 1, min(draws, stacked.sizes["sample"]))
    return stacked.isel(sample=np.rint(chosen).astype(int)).rename(sample="draw")
