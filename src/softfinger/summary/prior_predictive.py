"""The priors carried to the joint angle over time."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.motion import Move, move_paper_joint
from softfinger.summary.population import stack_population

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
SAME_LOAD = 0.02
"""Relative difference up to which loads are the same."""
TIMES = 61
LARGEST_LOG = 300.0
"""A draw beyond it would leave the floating-point range."""


def compute_prior_predictive(
    prior: xr.Dataset, angles: xr.Dataset, rng: np.random.Generator, move: Move = move_paper_joint
) -> xr.Dataset:
    """Compute the joint angle that the priors expect.

    It is that of a new trial, beside the recordings.

    Each draw of the population's prior gives one trial. The load is that of the trial of median
    largest load, and the recordings are those of trials with the same largest load.

    Parameters
    ----------
    prior
        mu_* and sigma_* (chain, draw, joint) of every population, from the prior.
    rng
        Draws each trial from its population.
    move
        The model, its effects in the prior's order of draws.

    Returns
    -------
    Dataset
        joint_angle_quantile (quantile, joint, time), recorded_low and recorded_high (joint, time)
        [rad]; load (), the largest load.
    """
    peaks = np.abs(angles["load_torque"].values).max(axis=1)
    chosen = int(np.argsort(peaks, kind="stable")[peaks.size // 2])
    same = np.abs(peaks - peaks[chosen]) <= SAME_LOAD * peaks[chosen]
    time = np.linspace(0.0, float(np.nanmax(angles["time"].values[chosen])), TIMES)
    population = stack_population(prior)
    z = rng.standard_normal(population["mu"].shape)
    own = population["mu"].values + population["sigma"].values * z
    own[..., :3] = np.clip(own[..., :3], -LARGEST_LOG, LARGEST_LOG)
    load = (angles[name].values[chosen] for name in ("load_time", "load_torque"))
    angle = move(own, np.arange(len(own)), np.full(len(own), chosen), time, *load)
    low, high = span_recordings(angles.isel(trial=np.flatnonzero(same)), time)
    return xr.Dataset(
        {
            "joint_angle_quantile": (
                ("quantile", "joint", "time"),
                np.nanquantile(angle, QUANTILES, axis=0),
            ),
            "recorded_low": (("joint", "time"), low),
            "recorded_high": (("joint", "time"), high),
        },
        coords={"quantile": list(QUANTILES), "joint": angles["joint"], "time": time},
    ).assign(load=((), float(peaks[chosen])))


def span_recordings(angles: xr.Dataset, time: NDArray) -> tuple[NDArray, NDArray]:
    """Lowest and highest unflagged angles (joint, time)."""
    seen = angles["joint_angle"].where(angles["angle_flag"] == 0)
    rows = np.full((seen.sizes["trial"], seen.sizes["joint"], time.size), np.nan)
    for trial, own in enumerate(angles["time"].values):
        for joint, values in enumerate(seen.transpose("trial", "joint", "frame").values[trial]):
            good = np.isfinite(values)
            if good.any():
                rows[trial, joint] = np.interp(
                    time, own[good], values[good], left=np.nan, right=np.nan
                )
    empty = np.isnan(rows).all(axis=0)
    low = np.where(empty, np.nan, np.nanmin(np.where(empty, 0.0, rows), axis=0))
    high = np.where(empty, np.nan, np.nanmax(np.where(empty, 0.0, rows), axis=0))
    return low, high
