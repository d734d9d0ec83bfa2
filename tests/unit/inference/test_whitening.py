import numpy as np
import pytest

from softfinger.inference.whitening import (
    colour_trials,
    pull_colours_back,
    shift_pull,
    whiten_about,
)

TRIALS, SIZE = 3, 5


@pytest.fixture
def parts(rng):
    root = rng.standard_normal((TRIALS, SIZE, SIZE))
    curvature = np.moveaxis(root @ root.transpose(0, 2, 1), 0, -1).copy()
    pull, z = rng.standard_normal((2, SIZE, TRIALS))
    mean = rng.standard_normal(SIZE)
    spread = rng.standard_normal((SIZE, SIZE))
    return z, curvature, pull, mean, spread @ spread.T + np.eye(SIZE)


def test_mean_and_covariance_are_those_of_stand_in_and_population(parts):
    z, curvature, pull, mean, precision = parts
    eta, log_volume, _ = colour_trials(z, curvature, pull, mean, precision)
    for i in range(TRIALS):
        both = curvature[..., i] + precision
        centre = np.linalg.solve(both, pull[:, i] + precision @ mean)
        turn = np.linalg.inv(np.linalg.cholesky(both)).T
        assert eta[:, i] == pytest.approx(centre + turn @ z[:, i])
        assert log_volume[i] == pytest.approx(-0.5 * np.linalg.slogdet(both)[1])


def test_without_data_parameters_are_the_populations(parts):
    z, curvature, pull, mean, precision = parts
    eta, _, _ = colour_trials(z, 0 * curvature, 0 * pull, mean, precision)
    turn = np.linalg.inv(np.linalg.cholesky(precision)).T
    assert eta == pytest.approx(mean[:, None] + turn @ z)


def test_whitening_undoes_colouring(parts):
    z, *rest = parts
    centre, _, factor = colour_trials(np.zeros_like(z), *rest)
    assert whiten_about(colour_trials(z, *rest)[0], centre, factor) == pytest.approx(z)


def test_slopes_are_those_of_differences(parts, rng):
    z, curvature, pull, mean, precision = parts
    eta_bar, volume_bar = rng.standard_normal((SIZE, TRIALS)), rng.standard_normal(TRIALS)

    def value(z, pull, mean, precision):
        eta, volume, _ = colour_trials(z, curvature, pull, mean, precision)
        return (eta * eta_bar).sum() + (volume * volume_bar).sum()

    eta, _, factor = colour_trials(*parts)
    found = pull_colours_back(eta, z, factor, mean, precision, eta_bar, volume_bar)
    step = 1e-6
    for k, point in enumerate((z, pull, mean, precision)):
        turn = rng.standard_normal(point.shape)
        turn = turn + turn.T if k == 3 else turn
        ends = []
        for sign in (1, -1):
            arguments = [z, pull, mean, precision]
            arguments[k] = point + sign * step * turn
            ends.append(value(*arguments))
        assert (found[k] * turn).sum() == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-6)


def test_effects_shift_the_pull_by_their_cross(rng):
    pull, cross, change = rng.standard_normal((4, 3)), rng.standard_normal((4, 2, 3)), [0.5, -2.0]
    shifted = shift_pull(pull, cross, np.array(change))
    np.testing.assert_allclose(shifted, pull - np.einsum("aki,k->ai", cross, change))
