import numpy as np

from softfinger.mechanics import OWN
from softfinger.mismatch.checks.rate_law import APART, compute_rate_array, follow_late_array


def test_rates_are_those_of_the_three_element_model(clean):
    problem, base = clean.problem, clean.search.base
    k_v, c_v, c_p = np.exp(base.fit.own.reshape(-1, OWN)[:, :3]).T[:, :, None]
    time = problem.trials.node.reshape(len(base.fit.own), -1) + APART * problem.trials.interval / 2
    torque = problem.trials.load_torque[:, :1]
    wanted = torque * (np.exp(-time * k_v / c_v) / c_v + 1.0 / c_p)
    found = compute_rate_array(problem, base)[:, 0]
    pulled = time < 8.0
    np.testing.assert_allclose(found[pulled], wanted[pulled], rtol=2e-3)


def test_what_follows_late_solves_its_equation(clean):
    """b = t: δ = t − τ (1 − exp(−t/τ))."""
    problem, base = clean.problem, clean.search.base
    time = problem.trials.node.reshape(len(base.fit.own), 1, -1, 1)
    time = time - time[:, :, :1]
    log_late = base.fit.own[:, 1] - base.fit.own[:, 0]
    late = np.exp(log_late).reshape(-1, 1, 1, 1)
    followed = follow_late_array(problem, base, time)
    np.testing.assert_allclose(followed, time + late * np.expm1(-time / late), atol=1e-9)
