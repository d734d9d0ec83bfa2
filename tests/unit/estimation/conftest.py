"""A small campaign whose truth is known, and one fit of it that the tests share."""

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

from softfinger.estimation import fit_posterior
from softfinger.population.simulate import (
    build_recording,
    describe_noise,
    draw_angles,
    draw_parameters,
)

MEAN = np.array([[-2.4, -3.6, 2.8, 0.02], [-2.3, -3.5, 3.1, 0.03]])
SD = np.array([[0.2, 0.4, 0.5, 0.01], [0.3, 0.5, 0.6, 0.02]])
CONFIG = {
    "chains": 4, "tune": 300, "draws": 250, "cores": 1, "target_accept": 0.8, "max_depth": 10,
    "sampler": "nuts",
    "covariance": "independent",
    "predictive_draws": 40,
    "r_hat_max": 1.05, "ess_min": 100.0, "divergences_max": 0,
    "outlier_rule": "scaled_mad", "outlier_cutoff": 3.0,
}  # fmt: skip


def draw_campaign(trials: int, joints: int, seed: int, time: np.ndarray | None = None):
    """Draw a campaign of the model itself, and its parameters."""
    rng = np.random.default_rng(seed)
    time = np.arange(150) / 7.5 if time is None else time
    names = [f"trial_{i}" for i in range(trials)]
    recording = build_recording(time, [0.0, time[-1]], [0.04, 0.04], joints, names)
    own = draw_parameters(np.resize(MEAN, (joints, 4)), np.resize(SD, (joints, 4)), recording, rng)
    noise = describe_noise(np.full(joints, 0.002), np.full(joints, 0.3))
    return draw_angles(recording, own, noise, rng), own


@pytest.fixture(scope="session")
def draw() -> Callable:
    return draw_campaign


@pytest.fixture(scope="session")
def campaign() -> tuple[xr.Dataset, xr.Dataset]:
    return draw_campaign(7, 2, 5)


@pytest.fixture(scope="session")
def tree(campaign) -> xr.DataTree:
    return fit_posterior(campaign[0], CONFIG, 3)
