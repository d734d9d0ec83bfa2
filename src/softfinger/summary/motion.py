"""Motion of trials by the fitted model."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.motion import Move, move_paper_joint
from softfinger.mechanics import LOG_PARAMETERS

"""A trial's own parameters, as the fit names and orders them."""


def compute_fitted_angle(
    angles: xr.Dataset, posterior: xr.Dataset, move: Move = move_paper_joint
) -> xr.DataArray:
    """Compute the motion at each trial's mean parameters.

    Parameters
    ----------
    posterior
        The trials' own parameters (chain, draw, trial, joint), logs but for q_ini [rad].
    move
        The fitted model; its draw 0 of the effects is used.

    Returns
    -------
    DataArray
        (trial, joint, frame) [rad], of the trials that the fit has.
    """
    mean = [posterior[name].mean(("chain", "draw")) for name in LOG_PARAMETERS]
    fitted = xr.concat(mean, xr.IndexVariable("parameter", list(LOG_PARAMETERS)), join="exact")
    own = fitted.transpose("trial", "joint", "parameter")
    place = angles.indexes["trial"].get_indexer(own["trial"].values)
    chosen = angles.isel(trial=place)
    first = np.zeros(1, int)
    columns = [chosen[name].values for name in ("time", "load_time", "load_torque")]
    rows = zip(own.values, place, *columns, strict=True)
    moved = np.stack([_move_one(move, row, first, np.array([at]), *s) for row, at, *s in rows])
    coords = {"trial": own["trial"], "joint": own["joint"]}
    return xr.DataArray(moved, coords, ("trial", "joint", "frame"))


def _move_one(
    move: Move, own: NDArray, draw: NDArray, like: NDArray, time: NDArray, *load: NDArray
) -> NDArray[np.float64]:
    recorded = np.isfinite(time)
    angle = np.full((len(own), time.size), np.nan)
    angle[:, recorded] = move(own[None], draw, like, time[recorded], *load)[0]
    return angle
