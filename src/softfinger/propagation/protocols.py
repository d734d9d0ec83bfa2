"""Protocols: trials that had the same load history."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.mechanics.load import evaluate_load_array

SAME_LOAD = 0.02  # mean absolute difference over the larger peak, up to which loads are the same


class Protocol(NamedTuple):
    """Trials of one load history, the longest's."""

    name: str
    trials: NDArray[np.int_]
    load_time: NDArray[np.float64]
    load_torque: NDArray[np.float64]
    duration: float


def group_protocols(angles: xr.Dataset) -> list[Protocol]:
    """Group trials by load history.

    Two loads are the same if they differ by at most 2 % of the larger peak, as a mean over the
    time that both were recorded: so much as logging and starting jitter make.

    Returns
    -------
    list of Protocol
        Each named `protocol_1` …, with places of its trials.
    """
    duration = angles["time"].max("frame").to_numpy()
    load = angles[["load_time", "load_torque"]].transpose("trial", "knot")
    knots = list(zip(load["load_time"].to_numpy(), load["load_torque"].to_numpy(), strict=True))
    groups: list[list[int]] = []
    for trial in np.flatnonzero(np.isfinite(duration)):
        for group in groups:
            shared = min(duration[trial], duration[group[0]])
            if _measure_difference(knots[trial], knots[group[0]], shared) <= SAME_LOAD:
                group.append(trial)
                break
        else:
            groups.append([trial])
    longest = [max(group, key=lambda trial: duration[trial]) for group in groups]
    return [
        Protocol(f"protocol_{number}", np.array(group), *knots[trial], float(duration[trial]))
        for number, (group, trial) in enumerate(zip(groups, longest, strict=True), start=1)
    ]


def select_main_protocol(protocols: list[Protocol]) -> Protocol:
    """Select the first protocol with most trials."""
    return max(protocols, key=lambda protocol: protocol.trials.size)


def name_protocols(protocols: list[Protocol], n_trials: int) -> list[str]:
    """Name trials' protocols, "" without any frame."""
    names = [""] * n_trials
    for protocol in protocols:
        for trial in protocol.trials:
            names[trial] = protocol.name
    return names


def describe_truncation(c_p_truncation_sd: float | None) -> str:
    """Name the part of c_p's population that is propagated."""
    if c_p_truncation_sd is None:
        return "none: the log-normal population of c_p is complete"
    return f"|log c_p − μ| ≤ {c_p_truncation_sd:g} σ"


def _measure_difference(
    one: tuple[NDArray, NDArray], other: tuple[NDArray, NDArray], duration: float
) -> float:
    time = np.linspace(0.0, duration, 2000)
    first, second = (evaluate_load_array(time, *load) for load in (one, other))
    peak = max(np.abs(first).max(), np.abs(second).max())
    return float(np.abs(first - second).mean() / peak) if peak > 0 else 0.0
