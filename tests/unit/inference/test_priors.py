"""One prior of the population's mean, for the mode, the diagnosis and the sampled posterior."""

import numpy as np

from softfinger.inference.posterior import prepare_fit
from softfinger.inference.priors import build_prior


def test_one_prior_of_the_mean_serves_all(draw):
    angles = draw(3, 2, 5)[0]
    prepared = prepare_fit(angles)
    problem, given = prepared.recorded.problem, prepared.given
    fitted = problem.build_prior(problem.base)
    np.testing.assert_allclose(fitted.mean, np.tile(given.prior.mu_mean, 2))
    np.testing.assert_allclose(fitted.precision, np.tile(given.prior.mu_sd, 2) ** -2.0)
    assert given.prior.mu_sd.tolist() == [1.5, 2.0, 2.0, 0.5]
    doubled = angles.assign(load_torque=2.0 * angles["load_torque"])
    other = build_prior(doubled, prepared.recorded.frames)
    np.testing.assert_allclose(other.mu_mean - given.prior.mu_mean, np.log([2, 2, 2, 1]))
