"""Small campaigns drawn from the model, and one fit that tests share."""

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

from softfinger.inference.posterior import fit_posterior
from softfinger.inference.simulate import (
    build_recording,
    describe_noise,
    draw_angles,
    draw_parameters,
)

MEAN = np.array([[-2.4, -3.6, 2.9, 0.02], [-2.3, -3.5, 3.1, 0.01], [-1.9, -3.7, 3.3, 0.03]])
SD = np.array([0.2, 0.4, 0.7, 0.01])


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20)


@pytest.fixture
def make_campaign() -> Callable[..., tuple[xr.Dataset, xr.Dataset, xr.Dataset]]:
    def make(
        rng: np.random.Generator,
        trials: int = 5,
        joints: int = 3,
        time: np.ndarray | None = None,
        rho: float = 0.4,
        sd: float = 0.003,
        load: tuple = ([0.0, 2.0], [0.04, 0.03]),
    ) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
        time = np.arange(90) / 30 if time is None else time
        names = [f"trial_{i}" for i in range(trials)]
        recording = build_recording(time, np.array(load[0]), np.array(load[1]), joints, names)
        parameters = draw_parameters(MEAN[:joints], SD, recording, rng)
        spread = sd * np.array([1.0, 0.8, 1.3])[:joints]
        noise = describe_noise(spread, rho * np.array([1.0, 0.7, 0.9])[:joints], -0.5)
        return draw_angles(recording, parameters, noise, rng), parameters, noise

    return make


@pytest.fixture
def campaign(make_campaign, rng):
    """angles, parameters, noise."""
    return make_campaign(rng)


def stack(parameters: xr.Dataset) -> np.ndarray:
    return np.stack(
        [np.log(parameters[name]) for name in ("k_v", "c_v", "c_p")] + [parameters["q_ini"]],
        axis=-1,
    )


@pytest.fixture
def eta(campaign) -> np.ndarray:
    """(trial, joint, 4) of the campaign."""
    return stack(campaign[1])


OWN_MEAN = np.array([[-2.4, -3.6, 2.8, 0.02], [-2.3, -3.5, 3.1, 0.03]])
OWN_SD = np.array([[0.2, 0.4, 0.5, 0.01], [0.3, 0.5, 0.6, 0.02]])
FIT = {
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
    own = draw_parameters(
        np.resize(OWN_MEAN, (joints, 4)), np.resize(OWN_SD, (joints, 4)), recording, rng
    )
    noise = describe_noise(np.full(joints, 0.002), np.full(joints, 0.3))
    return draw_angles(recording, own, noise, rng), own


@pytest.fixture(scope="session")
def draw() -> Callable:
    return draw_campaign


@pytest.fixture(scope="session")
def known_campaign() -> tuple[xr.Dataset, xr.Dataset]:
    """7 trials, 2 joints: angles, and the parameters that they were drawn with."""
    return draw_campaign(7, 2, 5)


@pytest.fixture(scope="session")
def tree(known_campaign) -> xr.DataTree:
    return fit_posterior(known_campaign[0], FIT, 3)
