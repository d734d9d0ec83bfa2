"""The posterior of a model with an effect.

It is compared with a plain rival and with known truths.

One joint creeps on a second time scale under a step of load. The rival is the same model written
anew in PyMC: every frame by itself, AR(1) noise, non-centred, sampled by nutpie. Ours is the
sampler that ships.
"""

from __future__ import annotations

import numpy as np
import pymc as pm
import pytensor.tensor as pt
import xarray as xr
from numpy.typing import NDArray

from softfinger.config import read_config
from softfinger.inference.posterior import Preparation, prepare_fit, sample_posterior
from softfinger.inference.simulate import build_recording, describe_noise, draw_noise_array
from softfinger.mechanics.effects.model_file import ModelFile
from softfinger.stages.linear_algebra import on_one_thread

TORQUE, DURATION_S, NOISE_RAD, RHO = 0.04, 30.0, 0.004, 0.3
MEAN, SPREAD = np.array([-2.3, -3.6, 3.0, 0.02]), np.array([0.3, 0.5, 0.6, 0.01])
SHARE, TIME_S, STIFFNESS = 0.25, 4.0, 0.1
NAMES = ("log_k_v", "log_c_v", "log_c_p", "q_ini")
EFFECT = {"id": "second_retardation", "form": "own_compliance", "joints": [1], "priors": {}}
CONTENT = ModelFile.model_validate(
    {"version": 1, "joint": "three_element", "torque": "constant_arm", "effects": [EFFECT]}
)
RIVAL_DRAWS, OUR_DRAWS = 5000, 5000
COMPARED_TRIALS, COMPARED_FRAMES_PER_S = 8, 2.0
COVERED_CAMPAIGNS, COVERED_TRIALS, COVERED_FRAMES_PER_S = 40, 20, 5.0


@on_one_thread
def measure_long() -> dict[str, float]:
    """Agreement with the rival, and coverage of 90 % intervals."""
    return {
        "posterior_shift_with_effect": compare_with_rival(1),
        "posterior_coverage_90_with_effect": measure_coverage(),
    }


def build_campaign(trials: int, frames_per_s: float, seed: int) -> xr.Dataset:
    """Draw a campaign of trials that creep on two time scales."""
    rng = np.random.default_rng([seed, 27])
    moment = np.arange(0.0, DURATION_S, 1.0 / frames_per_s)
    names = [f"trial_{i + 1:03d}" for i in range(trials)]
    angles = build_recording(moment, [0.0, DURATION_S], [TORQUE] * 2, 1, names)
    eta = MEAN + SPREAD * rng.standard_normal((trials, 4))
    motion = TORQUE * move(*np.exp(eta[:, :3, None].transpose(1, 0, 2)), moment) + eta[:, 3:]
    motion += TORQUE * SHARE / STIFFNESS * (1.0 - np.exp(-moment / TIME_S))
    noise = describe_noise(np.array([NOISE_RAD]), np.array([RHO]))
    drawn = draw_noise_array(moment * frames_per_s, noise, trials, rng)
    return angles.assign(joint_angle=(("trial", "joint", "frame"), motion[:, None] + drawn))


def move(k_v: NDArray, c_v: NDArray, c_p: NDArray, moment: NDArray) -> NDArray:
    """Angle per torque after a step [rad/(N m)] of the paper's joint."""
    return (1.0 - np.exp(-k_v / c_v * moment)) / k_v + moment / c_p


def compare_with_rival(seed: int) -> float:
    """Largest |Δ mean| / sd of μ, ln σ and φ."""
    angles = build_campaign(COMPARED_TRIALS, COMPARED_FRAMES_PER_S, seed)
    prepared = prepare_fit(angles, CONTENT)
    config = read_config()["estimation"] | {"draws": OUR_DRAWS}
    ours, _ = sample_posterior(prepared, config, np.random.default_rng(seed))
    theirs = sample_rival(angles, prepared, seed)
    worst = 0.0
    for name, draws in theirs.items():
        mine = gather(ours, name)
        shift = abs(mine.mean() - draws.mean()) / draws.std()
        print(
            f"  {name}: shift {shift:.3f} sd, sd ratio {mine.std() / draws.std():.3f}", flush=True
        )
        worst = max(worst, shift)
    return float(worst)


def gather(posterior: xr.Dataset, name: str) -> NDArray[np.float64]:
    """Our draws of a quantity that the rival has too."""
    if name.startswith("phi"):
        return posterior["effect_internal"].to_numpy()[..., int(name[-1])].ravel()
    level, parameter = name.split(" ")
    draws = posterior[f"{level}_{parameter}"].to_numpy().ravel()
    return np.log(draws) if level == "sigma" else draws


def sample_rival(
    angles: xr.Dataset, prepared: Preparation, seed: int
) -> dict[str, NDArray[np.float64]]:
    """Sample the plain model: every frame given the one before."""
    time, y = angles["time"].values[0], angles["joint_angle"].values[:, 0]
    prior, effects = prepared.given.prior, prepared.given.effects
    stiffness = float(prepared.recorded.problem.setting.stiffness[0])
    bounded = effects.bounded
    with pm.Model():
        mu = pm.Normal("mu", prior.mu_mean, prior.mu_sd)
        sigma = pm.LogNormal("sigma", np.log(prior.sigma_median), prior.sigma_log_sd)
        eta = mu + sigma * pm.Normal("z", shape=(len(y), 4))
        share = pm.HalfNormal("phi_0", effects.sd[0])
        late = pm.TruncatedNormal(
            "phi_1", effects.mean[1], effects.sd[1], lower=bounded.low[1], upper=bounded.high[1]
        )
        sd = pm.LogNormal("noise_sd", np.log(0.01), 0.5)
        rho = pm.Uniform("rho")
        k_v, c_v, c_p = (pt.exp(eta[:, k, None]) for k in range(3))
        motion = (1 - pt.exp(-k_v / c_v * time)) / k_v + time / c_p
        motion += share / stiffness * (1 - pt.exp(-time / pt.exp(late)))
        left = y - TORQUE * motion - eta[:, 3:]
        pm.Potential("first", pm.logp(pm.Normal.dist(0, sd), left[:, 0]).sum())
        step = pm.Normal.dist(rho * left[:, :-1], sd * pt.sqrt(1 - rho**2))
        pm.Potential("rest", pm.logp(step, left[:, 1:]).sum())
        drawn = pm.sample(
            RIVAL_DRAWS, tune=1500, chains=4, cores=2, random_seed=seed, nuts_sampler="nutpie",
            nuts={"target_accept": 0.95, "maxdepth": 12}, progressbar=False,
        )["posterior"]  # fmt: skip
    named = {f"phi_{k}": drawn[f"phi_{k}"].values.ravel() for k in range(2)}
    for k, name in enumerate(NAMES):
        named[f"mu {name}"] = drawn["mu"].values[..., k].ravel()
        named[f"sigma {name}"] = np.log(drawn["sigma"].values[..., k]).ravel()
    return named


def measure_coverage() -> float:
    """Coverage of 90 % intervals of μ, σ and φ."""
    inside = []
    for seed in range(COVERED_CAMPAIGNS):
        angles = build_campaign(COVERED_TRIALS, COVERED_FRAMES_PER_S, 1000 + seed)
        prepared = prepare_fit(angles, CONTENT)
        config = read_config()["estimation"]
        drawn, _ = sample_posterior(prepared, config, np.random.default_rng(seed))
        stiffness = float(prepared.recorded.problem.setting.stiffness[0])
        truth = {"phi_0": SHARE * stiffness / STIFFNESS, "phi_1": np.log(TIME_S)}
        truth |= {f"mu {name}": MEAN[k] for k, name in enumerate(NAMES)}
        truth |= {f"sigma {name}": np.log(SPREAD[k]) for k, name in enumerate(NAMES)}
        ranks = {name: (gather(drawn, name) < true).mean() for name, true in truth.items()}
        inside.append({name: abs(rank - 0.5) < 0.45 for name, rank in ranks.items()})
    for name in inside[0]:
        print(f"  {name}: {sum(row[name] for row in inside)} of {len(inside)}", flush=True)
    return float(np.mean([list(row.values()) for row in inside]))
