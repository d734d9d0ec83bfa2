"""What to record next, for what is open."""

from typing import Any

import numpy as np
import xarray as xr

from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.diagnose import Diagnosis
from softfinger.mismatch.experiment.protocols import (
    choose_protocol,
    list_protocols,
    plan_experiment,
)


def propose_experiment(found: Diagnosis, angles: xr.Dataset) -> dict[str, Any] | None:
    """Propose the protocol for a verdict's open questions.

    That is what its equivalent sets differ in, else what these recordings could not show. The
    protocols keep within the largest load and the longest trial that were recorded.

    Parameters
    ----------
    angles
        The `angles` artifact that it is of.

    Returns
    -------
    dict
        protocol, tells_apart, expected_gain_nats (effect → gain), n_trials, load_column, loads
        (one per history, in turn: time_s, load) and a statement; None where nothing is open, or no
        protocol would help.
    """
    wanted = list_open_questions(found)
    if not wanted:
        return None
    chosen = angles.sel(trial=found.problem.trials.name)
    largest = float(np.abs(chosen["load_torque"].values).max())
    protocols = list_protocols(largest, float(np.nanmax(chosen["time"].values)))
    best = choose_protocol(
        plan_experiment(found.problem, found.search.base, protocols), wanted, DECISIONS.shows
    )
    if best is None:
        return None
    name, gain = best
    column, scale = choose_column(chosen)
    protocol = protocols[name]
    seen = [
        str(effect)
        for effect in gain["effect"].values
        if float(gain.sel(effect=effect)) > DECISIONS.shows
    ]
    return {
        "protocol": name,
        "tells_apart": seen,
        "expected_gain_nats": {
            str(e): round(float(g), 1) for e, g in zip(wanted, gain, strict=True)
        },
        "n_trials": DECISIONS.design_trials,
        "load_column": column,
        "loads": [
            {"time_s": time.tolist(), "load": (torque * scale).tolist()}
            for time, torque in zip(protocol.load_time, protocol.load_torque, strict=True)
        ],
        "statement": f"{DECISIONS.design_trials} trials of the protocol '{name}', of the same "
        f"length and largest load, would show {', '.join(seen)}.",
    }


def list_open_questions(found: Diagnosis) -> list[str]:
    """Ids of effects that a verdict leaves open."""
    sets = [set(ids) for ids in found.posterior.equivalent]
    if found.verdict.decision == "ambiguous" and len(sets) > 1:
        return sorted(set.union(*sets) - set.intersection(*sets))
    return list(found.verdict.not_testable)


def choose_column(angles: xr.Dataset) -> tuple[str, float]:
    """Log column of this rig, and its factor."""
    kinds = angles["load_kind"].values.astype(str)
    if (kinds == "tension_n").all():
        return "tension_n", 1.0 / float(angles["wire_offset"])
    return ("torque_nm" if (kinds == "torque_nm").all() else "command"), 1.0
