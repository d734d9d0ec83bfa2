"""PyMC with nutpie on the hierarchical model, non-centred and whitened by a pilot fit.

It is the best of its kind: NUTS in Rust on a compiled density, in the coordinates in which the
pilot's posterior is standard normal, started at its mode. Every frame of every trial is in the
density. With the pilot's mode η̂, its covariance V = L Lᵀ given μ, and its population N(μ̂, Ω),

    η = η̂ + V Ω⁻¹ (μ − μ̂) + L z,   μ = μ̂ + M u,   log σ = ½ log diag Ω + v / √(2 n),

so that trials which the data fix stay where they are, and the others move with μ.
"""

from __future__ import annotations

import time
from typing import NamedTuple

import arviz as az
import numpy as np
import nutpie
import pymc as pm
import pytensor.tensor as pt
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.mixed_effects_laplace import Fit

CHAINS, TUNE, DRAWS = 2, 400, 800
CENTRE, WIDTH = [-2.5, -3.5, 3.0, 0.0], [1.5, 2.0, 2.0, 0.5]  # of the prior of μ
MEDIAN, LOG_WIDTH = [0.3, 0.3, 0.3, 0.02], 1.0  # of the prior of σ


class Sampled(NamedTuple):
    """Smallest bulk ESS of the hyperparameters, largest R-hat, and CPU seconds of the sampling."""

    ess: float
    r_hat: float
    cpu: float
    draws: int


def run(angles: xr.Dataset, fit: Fit, torque: float, limit_s: float, seed: int) -> Sampled:
    """Sample for so long at most; compilation is not counted."""
    compiled = nutpie.compile_pymc_model(build_model(angles, fit, torque))
    begin = time.process_time()
    sampler = nutpie.sample(
        compiled, draws=DRAWS, tune=TUNE, chains=CHAINS, cores=2, seed=seed, progress_bar=False,
        blocking=False,
    )  # fmt: skip
    try:
        trace = sampler.wait(timeout=limit_s)
    except TimeoutError:
        trace = sampler.abort()
    cpu = time.process_time() - begin
    kept = trace["posterior"].to_dataset()[["mu", "sigma", "noise_sd"]]
    ess = min(float(x.min()) for x in az.ess(kept, method="bulk").data_vars.values())
    r_hat = max(float(x.max()) for x in az.rhat(kept).data_vars.values())
    return Sampled(ess, r_hat, cpu, kept.sizes["chain"] * kept.sizes["draw"])


def build_model(angles: xr.Dataset, fit: Fit, torque: float) -> pm.Model:
    """Every frame of every trial, white noise; the step solution as the paper has it."""
    seen = angles["joint_angle"].to_numpy()
    trials, joints, frames = seen.shape
    size = joints * 4
    moment = angles["time"].to_numpy()[0]
    sd = np.sqrt(np.mean(np.diff(seen, axis=2) ** 2, axis=(0, 2)) / 2.0)  # of white noise
    lower = np.linalg.cholesky(fit.own_covariance)
    follow = fit.own_covariance @ np.linalg.inv(fit.omega)
    with pm.Model() as model:
        u, v = pm.Flat("u", shape=size), pm.Flat("v", shape=size)
        w, z = pm.Flat("w", shape=joints), pm.Flat("z", shape=(trials, size))
        mu = pm.Deterministic("mu", fit.mean + np.linalg.cholesky(fit.mean_covariance) @ u)
        log_sigma = 0.5 * np.log(np.diag(fit.omega)) + v / np.sqrt(2.0 * trials)
        sigma = pm.Deterministic("sigma", pt.exp(log_sigma))
        log_noise = np.log(sd) + w / np.sqrt(2.0 * trials * frames)
        noise = pm.Deterministic("noise_sd", pt.exp(log_noise))
        eta = fit.own + pt.tensordot(follow, mu - fit.mean, ((2,), (0,)))
        eta = eta + pt.sum(lower * z[:, None, :], axis=2)
        _score("prior_mu", pm.Normal.dist(np.tile(CENTRE, joints), np.tile(WIDTH, joints)), mu)
        spread = pm.Normal.dist(np.tile(np.log(MEDIAN), joints), LOG_WIDTH)
        _score("prior_sigma", spread, log_sigma)
        _score("prior_noise", pm.Normal.dist(np.log(0.005), 1.5), log_noise)
        _score("population", pm.Normal.dist(mu, sigma), eta)
        motion = _move(eta.reshape((trials, joints, 4)), moment, torque)
        pm.Normal("y", motion, noise[:, None], observed=seen)
    return model


def _score(name: str, distribution: pt.TensorVariable, value: pt.TensorVariable) -> None:
    pm.Potential(name, pm.logp(distribution, value).sum())


def _move(eta: pt.TensorVariable, moment: NDArray, torque: float) -> pt.TensorVariable:
    """Angles (trial, joint, frame) [rad] after a step."""
    k_v, c_v, c_p = (pt.exp(eta[..., k])[..., None] for k in range(3))
    lag = 1 - pt.exp(-k_v / c_v * moment)
    return torque / k_v * lag + torque / c_p * moment + eta[..., 3:]
