"""What the recordings suffer from, in words."""

import numpy as np
import xarray as xr

from softfinger.artifacts.verdict import Suffering, Warned
from softfinger.inference.spreads import is_spread
from softfinger.measurement.decisions import DECISIONS as MEASURING
from softfinger.measurement.words import find_words, list_moved_joints, scale_trials
from softfinger.mismatch.decisions import DECISIONS
from softfinger.units import read_units


def describe_measurement(measurement: xr.Dataset) -> list[Suffering]:
    """Describe every component, the most evident first.

    Those with the evidence that a claim needs. Parameters of effects that differ between trials are
    the effects', not the measurement's; and how long the noise lasts is no fault.
    """
    names = measurement["component"].values.astype(str).tolist()
    sizes = measurement["component_size"].values.tolist()
    evidence = measurement["component_evidence"].values.tolist()
    found = []
    for name, size, nats in zip(names, sizes, evidence, strict=True):
        slight = nats < MEASURING.present_nats
        if slight or is_spread(name) or not (words := find_words(name)).fault:
            continue
        found.append(
            Suffering(
                id=words.id or name,
                joints=list_moved_joints(name, measurement.sizes["joint"]),
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
    units = read_units(measurement.attrs)
    key = "specimen.motion.noise_sd" if units.specimen else "noise_sd_rad"
    sd = f"{declared[0] * units.size:g} {'' if units.motion == '1' else units.motion}".rstrip()
    statement = (
        f"campaign.yaml, {key}: {sd} is declared and used, but the "
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
        hit = (np.abs(np.log(scale_trials(measurement))) > np.log(DECISIONS.other_noise)).to_numpy()
    else:
        return []
    return trials[hit].tolist()
