"""PITs of trials against populations that did not see them."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from softfinger.inference.loo_pit import compute_loo_pit
from softfinger.inference.posterior import prepare_fit

MEAN = np.array([-2.4, -3.6, 2.8, 0.02])
SD = np.array([0.2, 0.4, 0.5, 0.01])
NAMES = ("log_k_v", "log_c_v", "log_c_p", "q_ini")


def know_population(widened: float, draws: int = 500):
    """The population that conftest's first joint is drawn from, known exactly but for σ."""
    known = {f"mu_{name}": MEAN[k] for k, name in enumerate(NAMES)}
    known |= {f"sigma_{name}": widened * SD[k] for k, name in enumerate(NAMES)}
    known["noise_sd"] = 0.002
    dims = ("sample", "joint")
    population = xr.Dataset({name: (dims, np.full((draws, 1), x)) for name, x in known.items()})
    return population.assign(effect_internal=(("sample", "effect_parameter"), np.zeros((draws, 0))))


@pytest.fixture(scope="module")
def trials(draw):
    return prepare_fit(draw(90, 1, 11)[0]).recorded


def judge(trials, widened):
    others = [know_population(widened)] * trials.angles.sizes["trial"]
    return compute_loo_pit(trials, others, np.random.default_rng(2))


def test_pits_of_the_right_population_are_uniform(trials):
    found = judge(trials, 1.0)
    assert found["smallest_p"] > 0.05
    assert abs(found["pit"].std() - 1 / np.sqrt(12)) < 0.02
    np.testing.assert_allclose(found["pit_time"][0], [0.0, 5 / 7.5, 50 / 7.5, 149 / 7.5])


@pytest.mark.parametrize("widened", [0.5, 2.0])
def test_pits_of_a_wrong_spread_are_not(trials, widened):
    assert judge(trials, widened)["smallest_p"] < 0.01


def test_pits_know_how_large_a_frame_s_noise_is(trials):
    """Noise that drowns all motion leaves each PIT at a half."""
    wide = trials.frames["noise_factor"] * 1e4
    noisy = trials._replace(frames=trials.frames.assign(noise_factor=wide))
    assert np.abs(judge(noisy, 1.0)["pit"] - 0.5).max() < 0.1


def test_pits_know_the_disturbances(trials):
    problem = trials.problem
    directions = np.full((*problem.trials.angle.shape[:1], 1, problem.trials.node[0].size, 1), 50.0)
    disturbed = trials._replace(problem=replace(problem, directions=directions))
    assert np.abs(judge(disturbed, 1.0)["pit"] - 0.5).max() < 0.1
