"""Bars of estimates and curves of fitted densities."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

PLACES, MOST_BARS = 161, 60
CURVE_QUANTILES = (0.05, 0.5, 0.95)


def compute_histograms(least_squares: xr.Dataset, population: xr.Dataset | None) -> xr.Dataset:
    """Compute every parameter's histogram and densities, by joint.

    Densities are per unit of the natural logarithm, of q_ini per rad.

    Parameters
    ----------
    least_squares
        estimate, kept (trial, joint, parameter), population_mean, population_sd (joint, parameter).
    population
        Draws mu, sigma (sample, joint, parameter) of the posterior.

    Returns
    -------
    Dataset
        bar_edge (joint, parameter, edge) on the parameter's own scale, NaN after the last one;
        kept_density, dropped_density (joint, parameter, bar); abscissa, two_stage_density (joint,
        parameter, place), posterior_density (joint, parameter, place, quantile); dropped (joint,
        parameter), how many the paper's rule drops, and estimates (joint, parameter) of how many.
        NaN where there is no such density.
    """
    parts = [
        _compute_one(
            least_squares.sel(joint=joint, parameter=parameter),
            None if population is None else population.sel(joint=joint, parameter=parameter),
            logarithmic=parameter != "q_ini",
        )
        for joint in least_squares["joint"].values
        for parameter in least_squares["parameter"].values
    ]
    shape = least_squares.sizes["joint"], least_squares.sizes["parameter"]
    lead = ("joint", "parameter")
    found = xr.concat(parts, "cell", join="exact")
    split = {name: (lead + v.dims[1:], v.values.reshape(*shape, *v.shape[1:]))
             for name, v in found.data_vars.items()}  # fmt: skip
    coords = {name: least_squares[name].values for name in lead}
    return xr.Dataset(split, {**coords, "quantile": list(CURVE_QUANTILES)})


def _compute_one(
    own: xr.Dataset, population: xr.Dataset | None, *, logarithmic: bool
) -> xr.Dataset:
    estimate, kept = own["estimate"].values, own["kept"].values.astype(bool)
    usable = np.isfinite(estimate) & (estimate > 0 if logarithmic else True)
    value = np.where(usable, estimate, np.nan)
    value = np.log(value) if logarithmic else value
    used, dropped = value[usable & kept], value[usable & ~kept]
    mean, sd = float(own["population_mean"]), float(own["population_sd"])
    normals = [(mean, sd)] if sd > 0 else []  # a single trial has no spread, or NaN
    curves = np.full((PLACES, len(CURVE_QUANTILES)), np.nan)
    if population is not None:
        normals.append((float(population["mu"].median()), float(population["sigma"].median())))
    grid = choose_grid(used, normals)
    if population is not None:
        drawn = density(grid[:, None], population["mu"].values, population["sigma"].values)
        curves = np.quantile(drawn, CURVE_QUANTILES, axis=1).T
    edges = choose_edges(used, grid)
    heights = [
        _pad(np.histogram(values, edges)[0] / max(used.size, 1) / np.diff(edges), MOST_BARS)
        for values in (used, dropped)
    ]
    place = np.exp if logarithmic else np.asarray
    return xr.Dataset(
        {
            "bar_edge": ("edge", _pad(place(edges), MOST_BARS + 1)),
            "kept_density": ("bar", heights[0]),
            "dropped_density": ("bar", heights[1]),
            "abscissa": ("place", place(grid)),
            "two_stage_density": ("place", density(grid, *(normals[0] if sd > 0 else (0, np.nan)))),
            "posterior_density": (("place", "quantile"), curves),
            "dropped": ((), int((~kept).sum())),
            "estimates": ((), kept.size),
        }
    )


def _pad(values: NDArray, length: int) -> NDArray[np.float64]:
    return np.pad(values.astype(float), (0, length - values.size), constant_values=np.nan)


def choose_grid(
    values: NDArray[np.float64], normals: list[tuple[float, float]]
) -> NDArray[np.float64]:
    """Choose the stretch to draw.

    3.2 sd of each normal, and the middle 98 % of the trials.

    >>> choose_grid(np.array([]), [(1.0, 0.5)])[[0, -1]].round(2)
    array([-0.6,  2.6])
    """
    ends = [end for mean, sd in normals for end in (mean - 3.2 * sd, mean + 3.2 * sd)]
    ends += [float(end) for end in np.quantile(values, (0.01, 0.99))] if values.size else []
    low, high = min(ends, default=-1.0), max(ends, default=1.0)
    margin = 0.0 if high > low else 0.5
    return np.linspace(low - margin, high + margin, PLACES)


def choose_edges(values: NDArray[np.float64], grid: NDArray[np.float64]) -> NDArray[np.float64]:
    """Choose even edges that suit the kept trials."""
    bars = np.clip(1.5 * np.sqrt(values.size), 6, 24)
    span = grid[-1] - grid[0]
    width = np.ptp(values) / bars if values.size > 1 else span / bars
    count = int(np.clip(np.ceil(span / width), 6, MOST_BARS)) if width > 0 else 6
    return np.linspace(grid[0], grid[-1], count + 1)


def density(
    value: NDArray[np.float64], mean: NDArray | float, sd: NDArray | float
) -> NDArray[np.float64]:
    """Normal density.

    >>> round(float(density(np.array(0.0), 0.0, 1.0)), 4)
    0.3989
    """
    return np.exp(-0.5 * ((value - mean) / sd) ** 2) / (np.sqrt(2 * np.pi) * sd)
