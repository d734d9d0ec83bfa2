"""What the fit took for granted."""

import numpy as np
import xarray as xr

UNLIKELY = 0.05
"""p-value, corrected for looks, below which something is doubted."""
SENSITIVE = 0.05
"""Power-scaling sensitivity above which ArviZ speaks of it."""
DISAGREE = "prior and recordings may disagree"
LITTLE = "the recordings determine little"
FINE = "–"


def list_doubtful_pairs(found: xr.Dataset) -> xr.Dataset:
    """List the pairs of parameters, most doubtful first.

    A pair is of one trial's parameters.

    Parameters
    ----------
    found
        The fit's group `independence`.

    Returns
    -------
    Dataset
        one, other (pair): labels; mean_product, p_value (pair); smallest_p (), doubted ().
    """
    row, column = np.tril_indices(found.sizes["own"], -1)
    p_value = found["p_value"].values[row, column]
    order = np.argsort(p_value, kind="stable")
    labels = found["own"].values.astype(str)
    product = found["mean_product"].values[row, column]
    return xr.Dataset(
        {
            "one": ("pair", labels[column[order]]),
            "other": ("pair", labels[row[order]]),
            "mean_product": ("pair", product[order]),
            "p_value": ("pair", p_value[order]),
            **_judge(found["smallest_p"]),
        }
    )


def judge_loo_pit(found: xr.Dataset) -> xr.Dataset:
    """Judge where trials lie in what the others predict.

    Parameters
    ----------
    found
        The fit's group `loo_pit`.

    Returns
    -------
    Dataset
        mean_share, p_value (joint, moment); time (moment) [s], the median over trials;
        smallest_p (), doubted ().
    """
    return xr.Dataset(
        {
            "mean_share": found["pit"].mean("trial").transpose("joint", "moment"),
            "p_value": found["p_value"].transpose("joint", "moment"),
            "time": found["pit_time"].median("trial"),
            **_judge(found["smallest_p"]),
        },
        coords={"joint": found["joint"].values},
    )


def judge_prior_sensitivity(found: xr.Dataset) -> xr.Dataset:
    """Read the sensitivities of the fit's group `prior_sensitivity`.

    Returns
    -------
    Dataset
        prior, likelihood, reading (level, parameter, joint); the same of the effects, effect_…
        (effect_parameter).
    """
    read = np.vectorize(read_sensitivity, otypes=[str])
    for of in ("", "effect_"):
        pair = found[f"{of}prior"], found[f"{of}likelihood"]
        reading = read(*pair) if pair[0].size else np.empty(0, str)
        found = found.assign({f"{of}reading": (pair[0].dims, reading)})
    return found


def read_sensitivity(prior: float, likelihood: float) -> str:
    """Read a pair of sensitivities as ArviZ does.

    >>> read_sensitivity(0.01, 0.3), read_sensitivity(0.3, 0.01)
    ('–', 'the recordings determine little')
    """
    if not prior > SENSITIVE:
        return FINE
    return DISAGREE if likelihood > SENSITIVE else LITTLE


def _judge(smallest_p: xr.DataArray) -> dict[str, tuple]:
    smallest = float(smallest_p)
    return {"smallest_p": ((), smallest), "doubted": ((), smallest < UNLIKELY)}
