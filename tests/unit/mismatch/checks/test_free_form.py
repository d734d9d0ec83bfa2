import numpy as np
import pytest
import xarray as xr
from scipy.signal import detrend

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.inference.simulate import build_recording, draw_angles, draw_parameters
from softfinger.mismatch.checks.free_form import fit_free_form, score_term, settle_term
from softfinger.mismatch.checks.free_form_terms import list_terms

TRIALS = 60
MU = np.array([[-2.3, -3.6, 2.9, 0.02]])
SIGMA = np.array([[0.3, 0.4, 0.5, 0.01]])


def draw_step():
    """One joint under one step, in many trials of very different stiffness."""
    rng = np.random.default_rng(1)
    time = np.arange(0.0, 20.0, 0.1)
    names = [f"t{i}" for i in range(TRIALS)]
    recording = build_recording(time, [0.0, 20.0], [0.04, 0.04], 1, names)
    noise = xr.Dataset(
        {
            "noise_sd": ("joint", [0.002]),
            "noise_autocorrelation": ("joint", [0.0]),
            "noise_white": ("joint", [0.0]),
            "noise_correlation": (("joint", "other_joint"), np.eye(1)),
        }
    )
    angles = draw_angles(recording, draw_parameters(MU, SIGMA, recording, rng), noise, rng)
    unknown = {f"link_{k}": ("joint", [np.nan]) for k in ("length", "mass", "centre", "inertia")}
    return angles.assign(
        started_at=("trial", np.full(TRIALS, np.nan)),
        joint_length=np.nan,
        wire_offset=np.nan,
        **unknown,
    ).assign_attrs(campaign="drawn")


def pose(angles):
    problem, fit = pose_problem(angles)
    return problem, Candidate(problem.base, fit, fit.log_evidence)


@pytest.fixture(scope="module")
def step():
    return draw_step()


def test_a_spline_does_not_take_the_place_of_what_differs_between_trials(step):
    """One linearisation says that it does, by steps far beyond where the model is straight."""
    problem, base = pose(step)
    scores = [s.gain for t in list_terms(problem, base) for s in score_term(problem, base, t)]
    assert max(scores) > 10.0
    assert fit_free_form(problem, base) is None


def test_a_shape_in_time_is_found_in_size(step):
    shape = 0.006 * np.sin(2 * np.pi * step["time"].values / 8.0)
    moved = step.assign(joint_angle=step["joint_angle"] + shape[:, None])
    free = fit_free_form(*pose(moved))
    assert free.gain > 100.0
    assert free.argument == "time_s"
    assert free.joints == [1]
    within = free.shape["value"][0].sel(place=slice(2.0, 18.0))
    wanted = 0.006 * np.sin(2 * np.pi * within["place"] / 8.0)
    # stiffness and flow swallow a constant and a line
    assert np.corrcoef(detrend(within.values), detrend(wanted.values))[0, 1] > 0.9


def test_a_shape_in_the_time_since_the_load_changed_stands_at_its_seconds(step):
    """One load from the start: both times are the same."""
    problem, base = pose(step)
    term = next(t for t in list_terms(problem, base) if t.argument == "time_since_change_s")
    score = max(score_term(problem, base, term), key=lambda s: s.gain)
    place = settle_term(problem, base, score).shape["place"]
    last = float(problem.trials.node.max())
    np.testing.assert_allclose(place[[0, -1]], [0.0, last], atol=0.1)


def test_products_of_a_term_are_its_derivatives(step):
    few = step.isel(trial=slice(0, 6))
    problem, base = pose(few)
    rng = np.random.default_rng(2)
    for term in list_terms(problem, base):
        own = base.fit.own + 0.05 * rng.normal(size=base.fit.own.shape)
        shared = 0.3 * term.sizes[0] * rng.normal(size=term.count)
        gram = term.linearise(own, shared)
        turn = 1e-5 * rng.normal(size=term.count)
        ahead, behind = (term.linearise(own, shared + s * turn)[:, -1, -1] for s in (1, -1))
        slope = -2.0 * gram[:, 4 : 4 + term.count, -1] @ turn
        np.testing.assert_allclose((ahead - behind) / 2, slope, rtol=2e-2, atol=1e-4)
