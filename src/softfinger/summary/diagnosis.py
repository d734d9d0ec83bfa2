"""What the diagnosis found, for figures and sentences."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

SEEN = 0.05
"""p-value below which a joint or line shows misfit."""
NEEDED = 0.5
"""Probability from which an effect is drawn as needed."""
SINCE = np.geomspace(0.05, 100.0, 12)
"""Edges of the time since the last change of load [s]."""
DEFLECTION = SPEED = np.linspace(0.0, 1.0, 41)  # a speed in rad/s
"""At which the noise is shown [rad]."""
CHANGE_QUANTILES = (0.05, 0.5, 0.95)


def summarise_misfit(repair: xr.Dataset) -> xr.Dataset:
    """Choose the trial to show, and average squared residuals.

    All squared residuals are over their noise.

    Returns
    -------
    Dataset
        trial_base, trial_final (): where the base model leaves most, over the noise, and where the
        repair takes away most; like_base, like_final (trial): whether a trial has its load;
        mean_square (model, joint, since_change), 1 is noise alone, NaN where there is no bin.
    """
    left = repair["recorded_angle"] - repair["fitted_angle"]
    square = (left / repair["bin_noise_sd"]) ** 2
    misfit = square.sum(("joint", "bin"))
    shown = {"base": misfit.sel(model="base")}
    shown["final"] = shown["base"] - misfit.sel(model="final")
    names = repair["trial"].values
    place = xr.DataArray(np.digitize(repair["since_change"].values, SINCE), dims=("trial", "bin"))
    mean = [square.where(place == k).mean(("trial", "bin")) for k in range(1, SINCE.size)]
    middle = xr.IndexVariable("since_change", np.sqrt(SINCE[1:] * SINCE[:-1]))
    picked: dict[str, tuple] = {}
    for model, size in shown.items():
        trial = int(size.values.argmax())
        picked[f"trial_{model}"] = ((), str(names[trial]))
        picked[f"like_{model}"] = ("trial", find_same_load(repair, trial))
    mean_square = xr.concat(mean, middle, join="exact").transpose("model", "joint", "since_change")
    return xr.Dataset({"mean_square": mean_square, **picked}, {"trial": names})


SAME_LOAD = 0.02
"""Largest difference of two loads that count as one, over the largest load."""


def find_same_load(repair: xr.Dataset, trial: int) -> NDArray[np.bool_]:
    """Which trials (trial,) have the load of one, at all of its times."""
    time, load = (repair[name].transpose("trial", "bin").values for name in ("time", "load"))
    largest = np.nanmax(np.abs(load))
    at = time[trial][np.isfinite(time[trial])]
    drawn = []
    for when, level in zip(time, load, strict=True):
        known = np.isfinite(when)
        drawn.append(np.interp(at, when[known], level[known]))
    own = drawn[trial]
    return np.array([np.median(np.abs(one - own)) <= SAME_LOAD * largest for one in drawn])


def summarise_evidence(
    ranking: xr.Dataset, masking: xr.Dataset | None, sentences: Mapping[str, str]
) -> xr.Dataset:
    """Decide which effects are drawn as needed.

    Also what chance alone gains.

    Parameters
    ----------
    ranking, masking
        The artifacts of these names.
    sentences
        Effect → what happens.

    Returns
    -------
    Dataset
        needed (effect); sentence (effect), refused_sentence (refused_effect), unfitted_sentence
        (unfitted_effect), of the effects whose first estimate gained too little for a fit;
        chance_range (end) [nats], least and largest gain of the drawn campaigns.
    """
    chance = ranking["chance_gain"].values
    known = {name: ranking[name].values.tolist() for name in ("effect", "refused_effect")}
    looked = [] if masking is None else masking["effect"].values.tolist()
    known["unfitted_effect"] = [name for name in looked if name not in known["effect"]]
    told = {
        f"{dim.removesuffix('effect')}sentence": (
            dim,
            np.array([str(sentences.get(str(name), "–")) for name in names], dtype=object),
        )
        for dim, names in known.items()
    }
    return xr.Dataset(
        {
            "needed": ranking["inclusion"] > NEEDED,
            **told,
            "chance_range": ("end", [chance.min(), chance.max()]),
        },
        {dim: np.array(names, dtype=object) for dim, names in known.items()},
    )


def summarise_location(
    angles: xr.Dataset, verdict: Mapping[str, Any], location: xr.Dataset | None
) -> xr.Dataset:
    """Decide in which joints the misfit shows.

    Also whether it shows as a spectral line.

    Returns
    -------
    Dataset
        shows (joint), by the verdict's p-values of the misfit; line_shows ().
    """
    found = verdict.get("location") or {}
    p_value = {int(joint): p for joint, p in (found.get("joints") or {}).items()}
    joints = angles["joint"].values
    shows = [p_value.get(int(joint), 1.0) < SEEN for joint in joints]
    line = location is not None and float(location["line_p_value"]) < SEEN
    return xr.Dataset({"shows": ("joint", shows), "line_shows": ((), line)}, {"joint": joints})


def summarise_measurement(measurement: xr.Dataset) -> xr.Dataset:
    """Sum up what each trial suffers from.

    Also how its noise grows.

    Returns
    -------
    Dataset
        gross_share, repeated_share, saturated_share (trial), of the frames that were seen;
        noise_ratio (trial, joint), sd over the campaign's, NaN where a joint is absent; grown_sd
        (deflection, joint) and fast_sd (speed, joint) [rad], sd of the noise at a deflection [rad]
        and at a speed [rad/s] of the coordinate.
    """
    gross = measurement["outlier_distance"] > 0
    repeated, saturated = (measurement[name] == 1 for name in ("repeated", "saturated"))
    seen = (gross | repeated | saturated | (measurement["used"] == 1)).sum("frame")
    deflection = xr.DataArray(DEFLECTION, {"deflection": DEFLECTION}, "deflection")
    speed = xr.DataArray(SPEED, {"speed": SPEED}, "speed")
    grown = measurement["noise_per_rad"] * deflection, measurement["noise_per_rate"] * speed
    away, fast = (np.sqrt(1.0 + part**2) * measurement["noise_sd"] for part in grown)
    share = {"gross_share": gross, "repeated_share": repeated, "saturated_share": saturated}
    return xr.Dataset(
        {
            **{name: marked.sum("frame") / seen.clip(min=1) for name, marked in share.items()},
            "noise_ratio": measurement["trial_factor"].where(measurement["present"] == 1),
            "grown_sd": away,
            "fast_sd": fast,
        }
    )


def summarise_assumptions(assumptions: xr.Dataset) -> xr.Dataset:
    """Sum up the simulated fingers' changes of parameters.

    Median and 90 % of the changes of their fitted parameters.

    Returns
    -------
    Dataset
        fitted_change (quantile, joint, parameter), fitted over true less 1.
    """
    change = assumptions["fitted_change"].quantile(list(CHANGE_QUANTILES), "trial")
    return xr.Dataset({"fitted_change": change.transpose("quantile", "joint", "parameter")})
