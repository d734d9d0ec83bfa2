"""A trial that informs nothing has a reason; what cannot be estimated is listed."""

import numpy as np
import pytest
import xarray as xr

from softfinger.inference.problem import pose_problem
from softfinger.mismatch.verdict.assumed import list_assumed, list_unused

TIME = np.arange(300) / 30
LOAD = ([0.0, 2.0, 2.0, 6.0, 6.0], [0.02, 0.02, 0.06, 0.06, 0.01])


@pytest.fixture
def campaign(make_campaign):
    return make_campaign(np.random.default_rng(6), 6, time=TIME, load=LOAD, rho=0.0)[0]


def break_trial(angles, trial, change):
    values = angles["joint_angle"].values.copy()
    values[trial] = change(values[trial])
    return angles.assign(joint_angle=(angles["joint_angle"].dims, values))


def see_nothing(rows):
    return np.where(np.arange(300) < 5, rows, np.nan)


def see_one_frame(rows):
    return np.repeat(rows[:, :1], 300, axis=1)


def reach_limit(rows):
    return np.minimum(rows, np.quantile(rows, 0.2, axis=1)[:, None])


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (see_nothing, "in 5 of its 300 frames a joint was seen"),
        (see_one_frame, "299 of its 300 frames repeat the one before"),
    ],
)
def test_a_trial_that_informs_nothing_is_left_out_with_its_reason(campaign, change, reason):
    broken = break_trial(campaign, 2, change)
    name = str(campaign["trial"].values[2])
    problem, _ = pose_problem(broken)
    assert name not in problem.trials.name
    (told,) = list_unused(broken, problem.trials.name)
    assert told.trials == [name]
    assert told.statement == (
        f"Trial {name} is left out, for fewer than 8 of its frames inform: {reason}."
    )
    assert list_unused(campaign, campaign["trial"].values.tolist()) == []


def test_frames_at_a_limit_are_a_reason(campaign):
    broken = break_trial(campaign, 1, reach_limit)
    others = np.delete(campaign["trial"].values, 1).tolist()
    (told,) = list_unused(broken, others)
    assert "frames are at or after a limit of a sensor" in told.statement


def test_what_cannot_be_estimated_is_listed_with_what_is_assumed():
    measurement = xr.Dataset(
        {"noise_sd": ("joint", [0.003, 0.002]), "window_count": ("joint", [4, 0])},
        {"joint": [1, 2]},
    )
    quiet, load = list_assumed(measurement, load_known=False)
    assert quiet.statement.startswith("No quiet stretch shows the noise of joint 2: it is assumed")
    assert "sd 2 mrad" in quiet.statement
    assert load.statement.startswith("There is no load log: a load of 1")
    measurement["window_count"][:] = 3
    assert list_assumed(measurement, load_known=True) == []
