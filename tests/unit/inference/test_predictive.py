"""Predictions have the noise that the recordings were measured to have."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from softfinger.inference.posterior import prepare_fit
from softfinger.inference.predictive import predict_new_trials, predict_trials

MEAN = {"log_k_v": -2.4, "log_c_v": -3.6, "log_c_p": 2.8, "q_ini": 0.02}
DRAWS = 60


@pytest.fixture(scope="module")
def trials(draw):
    return prepare_fit(draw(6, 1, 11)[0]).recorded


@pytest.fixture(scope="module")
def posterior(trials):
    """One population and one finger, known exactly: whatever differs between draws is noise."""
    ones = np.ones((1, DRAWS, 1))
    dims, joint = ("chain", "draw"), ("joint",)
    known = {name: ((*dims, "trial", *joint), np.full((1, DRAWS, 6, 1), x)) for name, x in
             MEAN.items()}  # fmt: skip
    known |= {f"mu_{name}": ((*dims, *joint), x * ones) for name, x in MEAN.items()}
    known |= {f"sigma_{name}": ((*dims, *joint), 1e-9 * ones) for name in MEAN}
    known |= {"noise_sd": ((*dims, *joint), 0.002 * ones)}
    known |= {f"noise_{name}": ((*dims, *joint), 0.0 * ones)
              for name in ("autocorrelation", "white")}  # fmt: skip
    known["noise_correlation"] = ((*dims, *joint, "other_joint"), ones[..., None])
    known["effect_internal"] = ((*dims, "effect_parameter"), np.zeros((1, DRAWS, 0)))
    coords = {"chain": [0], "draw": np.arange(DRAWS), "joint": [1], "trial": np.arange(6)}
    return xr.Dataset(known, coords)


def scatter(recorded, posterior):
    rng = np.random.default_rng(5)
    again = predict_trials(recorded, posterior, DRAWS, rng)["joint_angle"]
    new = predict_new_trials(recorded, posterior, DRAWS, rng)["new_joint_angle"]
    return [float(np.sqrt(part.var("draw").mean())) for part in (again.isel(trial=2), new)]


def test_noise_is_as_large_as_the_trial_s(trials, posterior):
    assert scatter(trials, posterior) == pytest.approx([0.002, 0.002], rel=0.1)
    factor = trials.frames["noise_factor"] * 5.0
    louder = trials._replace(frames=trials.frames.assign(noise_factor=factor))
    assert scatter(louder, posterior) == pytest.approx([0.01, 0.01], rel=0.1)


def test_disturbances_are_drawn_as_large_as_they_are(trials, posterior):
    problem = trials.problem
    shape = len(problem.trials.name), 1, problem.trials.node[0].size, 1
    moved = replace(problem, directions=np.full(shape, 0.02))
    disturbed = trials._replace(problem=moved)
    assert scatter(disturbed, posterior) == pytest.approx([0.02, 0.02], rel=0.25)
