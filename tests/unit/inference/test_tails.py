"""Noise with heavy tails, by weights on white rows."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm
from scipy.stats import t as student

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.inference.reduce import whiten_residual
from softfinger.inference.tails import weigh_rows_array, weigh_tails
from softfinger.measurement.measure import add_components

FAR = st.floats(-30.0, 30.0)


@given(FAR, FAR, st.sampled_from((3.0, 4.0, 10.0, 80.0)))
def test_weights_give_a_lower_bound_of_the_density_with_tails(at, row, freedom):
    weight, gain = weigh_rows_array(np.array([at]), np.array([freedom]))
    bound = gain[0] - 0.5 * weight[0] * row**2 + norm.logpdf(0.0)
    density = student.logpdf(row, freedom, scale=np.sqrt((freedom - 2.0) / freedom))
    assert bound <= density + 1e-9
    if weight[0] < 1.0:
        known = student.logpdf(at, freedom, scale=np.sqrt((freedom - 2.0) / freedom))
        assert gain[0] - 0.5 * weight[0] * at**2 + norm.logpdf(0.0) == pytest.approx(known)


@pytest.fixture
def posed(make_campaign):
    problem, fit = pose_problem(make_campaign(np.random.default_rng(5), 6)[0])
    return problem, Candidate(problem.base, fit, fit.log_evidence)


def with_tails(problem, freedom):
    noise = problem.noise.isel(component=[])
    noise = add_components(noise, {"heavy_tails": freedom}, {"heavy_tails": 50.0})
    return replace(problem, noise=noise)


def test_without_heavy_tails_nothing_is_weighed(posed):
    problem, base = posed
    assert weigh_tails(problem, base, problem) is problem


def test_what_lies_far_off_counts_less(posed):
    problem, base = posed
    trials = problem.trials._replace(angle=problem.trials.angle.copy())
    trials.angle[0, 0, 0] += 20.0 * float(problem.noise["noise_sd"][0])
    tailed = with_tails(replace(problem, trials=trials), 3.0)
    weighed = weigh_tails(tailed, base, tailed).trials
    angle = problem.simulate(base.model, base.fit.own, base.fit.shared)[0]
    before, after = (whiten_residual(some, angle, 0)[0, 0] for some in (trials, weighed))
    assert abs(before) > 10.0
    assert after == pytest.approx(before * np.sqrt(4.0 / (1.0 + before**2)))
    assert np.median(weighed.trust) == 1.0
