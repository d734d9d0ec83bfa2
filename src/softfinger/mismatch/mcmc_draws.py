"""Draws of a sampled model under the names of the artifact `posterior`."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.mismatch.problem import OWN, Candidate, Problem


def name_effect_draws(
    problem: Problem, candidate: Candidate, draws: dict[str, NDArray[np.float64]]
) -> xr.Dataset:
    """Name draws as the artifact `posterior` does; effects on their physical scale.

    Returns
    -------
    Dataset
        mu_*, sigma_* (chain, draw, joint); log_k_v, … (chain, draw, trial, joint); noise_sd,
        noise_autocorrelation (chain, draw, joint); effect (chain, draw, effect_parameter).
    """
    joints = problem.trials.joints
    dims = ("chain", "draw")
    lead = draws["mean"].shape[:2]
    named = {}
    for k, name in enumerate(("log_k_v", "log_c_v", "log_c_p", "q_ini")):
        for level, source in (("mu", "mean"), ("sigma", "sd")):
            values = draws[source].reshape(*lead, joints, OWN)[..., k]
            named[f"{level}_{name}"] = ((*dims, "joint"), values)
        own = draws["own"].reshape(*lead, -1, joints, OWN)[..., k]
        named[name] = ((*dims, "trial", "joint"), own)
    sd = problem.noise["noise_sd"].values * draws["scale"][..., None]
    rho = problem.noise["noise_autocorrelation"].values
    named["noise_sd"] = ((*dims, "joint"), sd)
    named["noise_autocorrelation"] = ((*dims, "joint"), np.broadcast_to(rho, (*lead, joints)))
    entries = candidate.model.entries
    physical = draws["effect"].copy()
    for k, entry in enumerate(entries):
        if entry.parameter.log:
            physical[..., k] = np.exp(physical[..., k])
    named["effect"] = ((*dims, "effect_parameter"), physical)
    coords = {
        "chain": np.arange(lead[0]),
        "draw": np.arange(lead[1]),
        "trial": problem.trials.name,
        "joint": np.arange(1, joints + 1),
        "effect_parameter": [
            f"{candidate.model.pieces[e.piece].effect.id}.{e.name}" for e in entries
        ],
    }
    return xr.Dataset(named, coords)
