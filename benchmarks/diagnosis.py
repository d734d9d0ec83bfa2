"""Wall time of a full diagnosis: trials of three joints and 40 s, an effect in them.

Everything is compiled before, on a campaign of three trials.
"""

from __future__ import annotations

import time

import numpy as np
import xarray as xr

from benchmarks.posterior import describe
from softfinger.config import read_config
from softfinger.estimation import diagnose_sampling
from softfinger.inference.posterior import fit_posterior
from softfinger.inference.simulate import build_recording, draw_noise_array
from softfinger.mechanics.effects.model_file import FittedTo
from softfinger.mechanics.forward.simulate import describe_unknown_finger, simulate_joint_angle
from softfinger.mismatch import diagnose
from softfinger.mismatch.diagnose import Diagnosis
from softfinger.mismatch.tables.outcome import describe_repair
from softfinger.mismatch.verdict.refine import refine_verdict

TRIALS, JOINTS, DURATION_S, FPS = 40, 3, 40.0, 30.0
MANY = (100, 1000)
MEAN = {"k_v": [-2.44, -2.30, -1.88], "c_v": [-3.66, -3.65, -3.88], "c_p": [2.85, 3.11, 3.3]}
SPREAD = {"k_v": [0.20, 0.22, 0.40], "c_v": [0.52, 0.48, 0.82], "c_p": [0.70, 0.85, 0.90]}


def measure() -> dict[str, float]:
    """Seconds for 40 trials without sampling, and of the repaired model's fit.

    The fit is that of the rule `fit`, leave-one-out included, in its own size and with its own
    limits; its time counts where they are met.
    """
    warm_up()
    found, seconds = time_diagnosis(TRIALS)
    return {"diagnosis_seconds": seconds, **time_repaired_fit(found)}


def measure_long() -> dict[str, float]:
    """Seconds for 40 trials with sampling, for 100 and for 1000 without."""
    warm_up()
    found, seconds = time_diagnosis(TRIALS)
    start = time.perf_counter()
    _, r_hat = refine_verdict(found, build_campaign(TRIALS), np.random.default_rng(1))
    figures = {"diagnosis_sampled_seconds": seconds + time.perf_counter() - start}
    print(f"  in the diagnosis: R-hat {r_hat:.4f}", flush=True)
    for trials in MANY:
        found, figures[f"diagnosis_{trials}_trials_seconds"] = time_diagnosis(trials)
        print(f"  {trials} trials: {found.verdict.decision}", flush=True)
    return figures


def time_repaired_fit(found: Diagnosis) -> dict[str, float]:
    """Wall seconds of a fit of the repaired model, if its chains agree."""
    content = describe_repair(found, FittedTo(campaign="benchmark", sha256="0" * 64))
    config, campaign = read_config()["estimation"], build_campaign(TRIALS)
    fit_posterior(campaign, config | {"tune": 10, "draws": 10}, 1, content, priors=False)
    start = time.perf_counter()
    fitted = fit_posterior(campaign, config, 1, content, priors=False)
    took = time.perf_counter() - start
    gates = diagnose_sampling(fitted, config)
    print(f"  the repaired model's fit: {gates.attrs['verdict']}, {describe(gates)}", flush=True)
    return {"repaired_fit_seconds": took} if gates.attrs["verdict"] == "green" else {}


def warm_up() -> None:
    """Compile everything."""
    diagnose(build_campaign(3), read_config()["mismatch"], 1)


def time_diagnosis(trials: int) -> tuple[Diagnosis, float]:
    """Diagnose a campaign; what was found, and the seconds of wall time."""
    campaign = build_campaign(trials)
    start = time.perf_counter()
    found = diagnose(campaign, read_config()["mismatch"], 1)
    return found, time.perf_counter() - start


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
            "noise_white": ("joint", np.zeros(JOINTS)),
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
