"""Small campaigns drawn from the model: 5 trials, 3 joints, 90 frames, 2 knots."""

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

from softfinger.population.simulate import (
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
