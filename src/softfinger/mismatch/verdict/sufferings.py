"""What the recordings suffer from, in words."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import xarray as xr

from softfinger.inference.spreads import is_spread
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.verdict.schema import Suffering, Warned


class _Words(NamedTuple):
    """How a component appears in a verdict.

    Key of the size, the sentence from size and measurement, and the verdict's id if another.
    """

    key: str
    say: Callable[[float, xr.Dataset], str]
    id: str = ""


def describe_measurement(measurement: xr.Dataset) -> list[Suffering]:
    """Describe every component, the most evident first.

    Parameters of effects that differ between trials are the effects', not the measurement's.
    """
    names = measurement["component"].values.astype(str).tolist()
    sizes = measurement["component_size"].values.tolist()
    evidence = measurement["component_evidence"].values.tolist()
    found = []
    for name, size, nats in zip(names, sizes, evidence, strict=True):
        if is_spread(name):
            continue
        words = WORDS[name]
        found.append(
            Suffering(
                id=words.id or name,
                joints=[],
                trials=_list_trials(name, measurement),
                size={words.key: size},
                evidence=nats,
                statement=words.say(size, measurement),
            )
        )
    return sorted(found, key=lambda one: -one.evidence)


def doubt_declared(measurement: xr.Dataset) -> list[Warned]:
    """Warn where a declared sd does not fit recordings."""
    declared = measurement["noise_sd"].values
    shown = measurement["recorded_noise_sd"].values
    ratio = float(np.exp(np.nanmean(np.log(shown / declared)))) if (shown > 0).any() else 1.0
    if DECISIONS.contradicts**-1 <= ratio <= DECISIONS.contradicts:
        return []
    statement = (
        f"campaign.yaml, noise_sd_rad: {declared[0]:g} rad is declared and used, but the "
        f"recordings show {ratio:.2g} times that; check the number, or leave it out."
    )
    return [Warned(id="declared_noise", trials=[], statement=statement)]


def doubt_patience(cut_short: bool, longest_s: float) -> list[Warned]:
    """Warn where the search ended at its limit of time."""
    if not cut_short:
        return []
    statement = (
        f"mismatch.longest_search_s: the search ended after {longest_s:g} s, before all sets of "
        "effects were tried; the verdict is the best so far. Raise the limit and diagnose again."
    )
    return [Warned(id="search_cut_short", trials=[], statement=statement)]


def _list_trials(name: str, measurement: xr.Dataset) -> list[str]:
    """Trials that suffer; empty where all do alike."""
    trials = measurement["trial"].values.astype(str)
    if name == "outliers":
        hit = (measurement["outlier_distance"].values > 0).any(axis=1)
    elif name == "repeated_frames":
        hit = measurement["repeated"].values.any(axis=1)
    elif name == "saturated_sensor":
        hit = measurement["saturated"].values.any(axis=1)
    elif name == "uneven_noise":
        hit = (
            np.abs(np.log(_scale_trials(measurement))) > np.log(DECISIONS.other_noise)
        ).to_numpy()
    else:
        return []
    return trials[hit].tolist()


def _scale_trials(measurement: xr.Dataset) -> xr.DataArray:
    """Noise (trial,) over the campaign's, joints averaged."""
    return np.exp(np.log(measurement["trial_factor"]).mean("joint"))


def _say_uneven(size: float, measurement: xr.Dataset) -> str:
    factor = _scale_trials(measurement)
    worst = factor["trial"].values[np.abs(np.log(factor.values)).argmax()]
    return (
        f"The noise differs between trials by {100 * np.expm1(size):.0f} %; that of {worst} is "
        f"{float(factor.sel(trial=worst)):.2g} times the campaign's."
    )


def _say_signal(size: float, measurement: xr.Dataset) -> str:
    sd = 1e3 * float(np.sqrt((measurement["noise_sd"] ** 2).mean()))
    grown = sd * np.sqrt(1.0 + size**2)
    return (
        f"The noise grows with the deflection: from {sd:.2g} mrad at rest to {grown:.2g} mrad "
        "at 1 rad."
    )


def _say_hum(size: float, measurement: xr.Dataset) -> str:
    tones = list(dict.fromkeys(f"{f:.3g}" for f in measurement["hum_frequency"].values))
    listed = " and ".join([", ".join(tones[:-1]), tones[-1]] if len(tones) > 1 else tones)
    return f"The angles hum at {listed} Hz with {1e3 * size:.2g} mrad, whatever the load does."


WORDS = {
    "outliers": _Words(
        "share", lambda s, _: f"{100 * s:.2g} % of the frames are gross errors, and are left out."
    ),
    "heavy_tails": _Words(
        "freedom",
        lambda s, _: (
            f"The noise has heavy tails, like Student's t with {s:.0f} degrees of freedom."
        ),
    ),
    "repeated_frames": _Words(
        "share",
        lambda s, _: f"{100 * s:.2g} % of the frames repeat the one before, and are left out.",
    ),
    "saturated_sensor": _Words(
        "share",
        lambda s, _: (
            f"{100 * s:.2g} % of the frames are at or after a limit of their sensor, and are left "
            "out."
        ),
    ),
    "lost_frames": _Words("share", lambda s, _: f"{100 * s:.2g} % of the frames are missing."),
    "uneven_noise": _Words("log_sd", _say_uneven),
    "signal_noise": _Words("per_rad", _say_signal),
    "noisy_load": _Words(
        "relative_sd",
        lambda s, _: f"The load log scatters by {100 * s:.2g} %: {10 * s:.2g} N at 10 N.",
    ),
    "load_drift": _Words(
        "relative_sd",
        lambda s, _: f"The gain of the load cell drifts within a trial by {100 * s:.2g} %.",
        "noisy_load",
    ),
    "timing_jitter": _Words(
        "sd_s", lambda s, _: f"The times of the frames jitter by {1e3 * s:.2g} ms."
    ),
    "clock_offset": _Words(
        "sd_s", lambda s, _: f"Camera and load log are apart by {1e3 * s:.2g} ms, trial by trial."
    ),
    "clock_rate": _Words(
        "relative_sd",
        lambda s, _: f"The clocks of camera and load log differ by {100 * s:.2g} % in rate.",
    ),
    "drift": _Words(
        "noise_sd",
        lambda s, _: f"The angles drift within a trial by {s:.2g} times the noise.",
    ),
    "gain_drift": _Words(
        "relative_sd",
        lambda s, _: f"The gain of the angles' sensor drifts within a trial by {100 * s:.2g} %.",
        "drift",
    ),
    "hum": _Words("amplitude_rad", _say_hum, "drift"),
}
