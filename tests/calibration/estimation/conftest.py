"""Simulation-based calibration: truth from the prior, data from the truth, ranks in the fit."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import kstest

from softfinger.inference.posterior import compile_fit, prepare_fit, sample_posterior
from softfinger.inference.priors import build_prior
from softfinger.inference.simulate import (
    build_recording,
    describe_noise,
    draw_angles,
    draw_parameters,
)
from softfinger.measurement.frames import select_frames

SIZE = {
    "chains": 2,
    "tune": 200,
    "draws": 200,
    "cores": 1,
    "target_accept": 0.8,
    "max_depth": 10,
    "sampler": "nuts",
    "covariance": "independent",
}
THIN = 8
TRIALS, FRAMES, NOISE_RAD = 5, 60, 0.004
QUANTITIES = (
    *(f"{level}_{name}" for level in ("mu", "sigma") for name in ("log_k_v", "log_c_v", "log_c_p")),
    "mu_q_ini", "sigma_q_ini", "log_k_v", "log_c_p",
)  # fmt: skip


def draw_ranks(replicates: int, seed: int, wrong: float = 1.0) -> NDArray[np.float64]:
    """Rank of the truth among the draws, 0 to 1: (replicate, quantity).

    The model is wrong where it is told `wrong` times the true load.
    """
    time = np.arange(FRAMES) / 3.0
    names = [f"trial_{i}" for i in range(TRIALS)]
    blank = build_recording(time, [0.0, time[-1]], [0.04, 0.04], 1, names)
    blank = blank.assign(joint_angle=blank["joint_angle"].fillna(0.0))
    prior = build_prior(blank, select_frames(blank))
    density, ranks = None, []
    for replicate in range(replicates):
        rng = np.random.default_rng([seed, replicate])
        mu = rng.normal(prior.mu_mean, prior.mu_sd, (1, 4))
        sigma = np.exp(rng.normal(np.log(prior.sigma_median), prior.sigma_log_sd, (1, 4)))
        own = draw_parameters(mu, sigma, blank, rng)
        noise = describe_noise(np.array([NOISE_RAD]), rng.uniform(0.0, 0.9, 1))
        angles = draw_angles(blank, own, noise, rng)
        prepared = prepare_fit(angles.assign(load_torque=wrong * angles["load_torque"]))
        prepared = prepared._replace(given=prepared.given._replace(prior=prior))
        density = compile_fit(prepared, SIZE) if density is None else density
        draws, _ = sample_posterior(prepared, SIZE, rng, density)
        truth = [*mu[0, :3], *sigma[0, :3], mu[0, 3], sigma[0, 3]]
        truth += [np.log(own[name].values[0, 0]) for name in ("k_v", "c_p")]
        ranks.append(
            [_rank(draws[q].values, x, rng) for q, x in zip(QUANTITIES, truth, strict=True)]
        )
    return np.array(ranks)


def _rank(draws: NDArray, true: float, rng: np.random.Generator) -> float:
    """Share of thinned draws below the truth; of trial 0 and joint 1."""
    some = draws.reshape(*draws.shape[:2], -1)[:, ::THIN, 0].ravel()
    return ((some < true).sum() + rng.uniform()) / (some.size + 1)


@pytest.fixture(scope="session")
def find_p_values() -> Callable[..., dict[str, float]]:
    """p of uniform ranks, by quantity."""

    def find(replicates: int, seed: int, wrong: float = 1.0) -> dict[str, float]:
        ranks = draw_ranks(replicates, seed, wrong)
        p = [kstest(column, "uniform").pvalue for column in ranks.T]
        return dict(zip(QUANTITIES, p, strict=True))

    return find
