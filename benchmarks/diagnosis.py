"""Wall time of a full diagnosis: 40 trials of three joints and 40 s, an effect in them."""

from __future__ import annotations

import time

import numpy as np
import xarray as xr

from softfinger.config import read_config
from softfinger.mechanics.forward.simulate import describe_unknown_finger, simulate_joint_angle
from softfinger.mismatch import diagnose
from softfinger.population.simulate import build_recording, draw_noise_array

TRIALS, JOINTS, DURATION_S, FPS = 40, 3, 40.0, 30.0
MEAN = {"k_v": [-2.44, -2.30, -1.88], "c_v": [-3.66, -3.65, -3.88], "c_p": [2.85, 3.11, 3.3]}
SPREAD = {"k_v": [0.20, 0.22, 0.40], "c_v": [0.52, 0.48, 0.82], "c_p": [0.70, 0.85, 0.90]}


def measure() -> dict[str, float]:
    """Seconds for one campaign; the code is compiled before, on a campaign of three trials."""
    config = read_config()["mismatch"]
    diagnose(build_campaign(3), config, 1)
    campaign = build_campaign(TRIALS)
    start = time.perf_counter()
    diagnose(campaign, config, 1)
    return {"diagnosis_seconds": time.perf_counter() - start}


def build_campaign(trials: int) -> xr.Dataset:
    """Levels with release; joint 2 has a second retardation of 6 s that takes 10 %."""
    rng = np.random.default_rng(20261121)
    moment = np.arange(0.0, DURATION_S, 1.0 / FPS)
    load_time = np.tile([0.0, 25.0, 25.0, DURATION_S], (trials, 1))
    level = np.resize([0.02, 0.03, 0.04, 0.05], trials)
    load = level[:, None] * np.array([1.0, 1.0, 0.0, 0.0])
    names = [f"trial_{i + 1:03d}" for i in range(trials)]
    angles = build_recording(moment, load_time, load, JOINTS, names)
    own = {
        key: (
            ("trial", "joint"),
            np.exp(MEAN[key] + SPREAD[key] * rng.normal(size=(trials, JOINTS))),
        )
        for key in MEAN
    }
    own["q_ini"] = (("trial", "joint"), rng.normal(0.02, 0.01, (trials, JOINTS)))
    slots = {"second_share": np.array([0.0, 0.1, 0.0]), "second_time": 6.0}
    parameters = xr.Dataset(own, coords={"trial": names, "joint": angles["joint"]})
    finger = describe_unknown_finger(JOINTS)
    moved = simulate_joint_angle(parameters, finger, moment, load_time, load, slots)["joint_angle"]
    noise = xr.Dataset(
        {
            "noise_sd": ("joint", np.full(JOINTS, 0.003)),
            "noise_autocorrelation": ("joint", np.full(JOINTS, 0.3)),
            "noise_correlation": (("joint", "other_joint"), np.eye(JOINTS)),
        }
    )
    noisy = moved.values + draw_noise_array(moment * FPS, noise, trials, rng)
    undeclared = {
        name: ("joint", np.full(JOINTS, np.nan))
        for name in ("link_length", "link_mass", "link_centre", "link_inertia")
    }
    return angles.assign(
        joint_angle=(("trial", "joint", "frame"), noisy),
        started_at=("trial", np.full(trials, np.nan)),
        joint_length=np.nan,
        wire_offset=np.nan,
        **undeclared,
    )
