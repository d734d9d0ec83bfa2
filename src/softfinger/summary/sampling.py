"""The draws of the hyperparameter whose chains agree least."""

import numpy as np
import xarray as xr


def pick_worst_quantity(sampling: xr.Dataset, posterior: xr.Dataset) -> xr.Dataset:
    """Pick the quantity of largest R-hat.

    Its draws are standardised.

    Parameters
    ----------
    posterior
        The draws of every hyperparameter.

    Returns
    -------
    Dataset
        worst_quantity (); worst_draws and their running_mean (chain, draw), in standard deviations
        from the mean.
    """
    worst = str(sampling["quantity"].values[int(sampling["r_hat"].argmax("quantity"))])
    draws = select_quantity(posterior, worst)
    standard = ((draws - draws.mean()) / draws.std()).reset_coords(drop=True)
    count = xr.DataArray(np.arange(1, standard.sizes["draw"] + 1), dims="draw")
    return xr.Dataset(
        {
            "worst_quantity": ((), worst),
            "worst_draws": standard,
            "running_mean": standard.cumsum("draw") / count,
        }
    )


def select_quantity(posterior: xr.Dataset, quantity: str) -> xr.DataArray:
    """Select the draws (chain, draw) of one quantity.

    Its name is that in the artifact `sampling`.

    >>> draws = xr.DataArray(np.zeros((2, 5, 3)), {"joint": [1, 2, 3]}, ("chain", "draw", "joint"))
    >>> select_quantity(draws.to_dataset(name="mu_q_ini"), "mu_q_ini[2]").sizes["draw"]
    5
    """
    name, _, labels = quantity.rstrip("]").partition("[")
    draws = posterior[name].transpose("chain", "draw", ...)
    for dim, label in zip(draws.dims[2:], labels.split(", "), strict=True):
        draws = draws.isel({dim: draws[dim].values.astype(str).tolist().index(label)}, drop=True)
    return draws
