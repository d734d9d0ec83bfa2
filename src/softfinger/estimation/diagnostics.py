"""Whether the sampling can be trusted."""

from collections.abc import Iterator, Mapping
from typing import Any

import arviz_stats as az  # ArviZ without its plots, which take long to import
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.decisions import DECISIONS

EXPANSION = ("expansion_pareto_k", "expansion_error")
HYPERPARAMETERS = ("mu", "sigma", "parameter", "noise", "effect")


def diagnose_sampling(tree: xr.DataTree, config: Mapping[str, Any]) -> xr.Dataset:
    """Diagnose the sampling of the hyperparameters and noise.

    Parameters
    ----------
    config
        The `estimation` block: r_hat_max, ess_min, divergences_max.

    Returns
    -------
    Dataset
        r_hat, ess_bulk, ess_tail (quantity) and divergences (); the limits as attributes and
        `verdict`: green if R-hat < r_hat_max and both kinds of effective draws > ess_min for every
        quantity, divergences ≤ divergences_max, and the expansion that was sampled is near enough
        the model to be weighed, else red. `expansion_pareto_k`, `expansion_error` (): how near.
    """
    names, draws = zip(*list_quantities(tree["posterior"].to_dataset()), strict=True)
    quantities = xr.DataArray(
        np.stack(draws), {"quantity": list(names)}, ("quantity", "chain", "draw")
    ).to_dataset(name="x")
    found = xr.Dataset(
        {
            "r_hat": az.rhat(quantities)["x"],
            "ess_bulk": az.ess(quantities, method="bulk")["x"],
            "ess_tail": az.ess(quantities, method="tail")["x"],
            "divergences": ((), int(tree["sample_stats"]["diverging"].sum())),
        }
    )
    stats = tree["sample_stats"].dataset
    found = found.assign({name: stats[name] for name in EXPANSION if name in stats})
    limits = {name: config[name] for name in ("r_hat_max", "ess_min", "divergences_max")}
    return found.assign_attrs(**limits, verdict="green" if _passes(found, limits) else "red")


def list_quantities(posterior: xr.Dataset) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """List name and draws of every hyperparameter.

    Draws are (chain, draw). Of correlations only those below the diagonal are listed.

    What has one fixed value was not sampled, and is left out.

    >>> drawn = np.arange(10.0).reshape(2, 5, 1)
    >>> draws = xr.DataArray(drawn, {"joint": [7]}, ("chain", "draw", "joint"))
    >>> [name for name, _ in list_quantities(draws.to_dataset(name="mu_q_ini"))]
    ['mu_q_ini[7]']
    """
    for name, array in posterior.data_vars.items():
        if str(name).split("_")[0] not in HYPERPARAMETERS:
            continue
        ordered = array.transpose("chain", "draw", ...)
        axes = [ordered[dim].values for dim in ordered.dims[2:]]
        for index in np.ndindex(*ordered.shape[2:]):
            if len(index) == 2 and index[1] >= index[0]:
                continue
            if ordered.size and np.ptp(ordered.values[(..., *index)]) == 0:
                continue
            label = ", ".join(str(axis[i]) for axis, i in zip(axes, index, strict=True))
            yield f"{name}[{label}]", ordered.values[(..., *index)]


def _passes(found: xr.Dataset, limits: Mapping[str, float]) -> bool:
    fewest = min(float(found["ess_bulk"].min()), float(found["ess_tail"].min()))
    return (
        float(found["r_hat"].max()) < limits["r_hat_max"]
        and fewest > limits["ess_min"]
        and int(found["divergences"]) <= limits["divergences_max"]
        and not float(found.get("expansion_pareto_k", np.nan)) > DECISIONS.largest_k
    )
