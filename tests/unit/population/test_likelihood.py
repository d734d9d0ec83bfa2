import numpy as np
import pytest

from softfinger.population.collapse import collapse_angles
from softfinger.population.frames import select_frames
from softfinger.population.likelihood import compute_log_likelihood_array, sum_log_likelihood
from softfinger.population.pilot import count_patterns
from softfinger.population.windows import localise_collapse


def get_noise(noise):
    return [noise[f"noise_{name}"].values for name in ("sd", "autocorrelation", "correlation")]


@pytest.fixture
def collapse(campaign):
    angles, _, _ = campaign
    angles["joint_angle"][1, 0, 7:9] = np.nan
    angles["joint_angle"][3, 2, 20:] = np.nan
    return collapse_angles(angles, select_frames(angles))


@pytest.fixture
def local(collapse):
    return localise_collapse(collapse)


def test_slopes_are_those_of_differences(local, eta, campaign):
    noise = get_noise(campaign[2])
    data = (local.windows, local.window, local.products, local.first, local.pattern)
    data += (local.patterns, local.gap, count_patterns(local))
    eta = eta + 0.02
    found = sum_log_likelihood(eta, *noise, *data)
    rng, step = np.random.default_rng(0), 1e-6
    for k, point in enumerate((eta, *noise[:2])):
        turn = rng.standard_normal(point.shape) * (np.abs(point) + 0.01)
        ends = []
        for sign in (1, -1):
            arguments = [eta, *noise]
            arguments[k] = point + sign * step * turn
            ends.append(sum_log_likelihood(*arguments, *data)[0])
        slope = (ends[0] - ends[1]) / (2 * step)
        assert (found[k + 1] * turn).sum() == pytest.approx(slope, rel=1e-5)


def test_sum_and_trials_agree(local, eta, campaign):
    noise = get_noise(campaign[2])
    data = (local.windows, local.window, local.products, local.first, local.pattern)
    data += (local.patterns, local.gap, count_patterns(local))
    total = sum_log_likelihood(eta, *noise, *data)[0] + local.offset.sum()
    each = compute_log_likelihood_array(local, eta, *noise)
    assert total == pytest.approx(each.sum(), rel=1e-12)


def test_an_absent_joint_has_no_say(local, eta, campaign):
    noise = get_noise(campaign[2])
    before = compute_log_likelihood_array(local, eta, *noise)
    eta[3, 2] += 0.3
    after = compute_log_likelihood_array(local, eta, *noise)
    assert after == pytest.approx(before, rel=1e-12)


def test_a_trial_without_frames_says_nothing(campaign, eta):
    angles, _, noise = campaign
    angles["joint_angle"][4] = np.nan
    local = localise_collapse(collapse_angles(angles, select_frames(angles)))
    found = compute_log_likelihood_array(local, eta, *get_noise(noise))
    assert found[4] == 0
    assert (found[:4] > 100).all()


def test_windows_of_each_trial_say_the_same_between_their_limits(collapse, local, eta, campaign):
    x = eta[..., 0] - eta[..., 1]
    smaller = localise_collapse(collapse, x - 0.3, x + 0.4)
    assert smaller.first.shape[1] < local.first.shape[1] / 2
    noise = get_noise(campaign[2])
    for shift in (0.0, 0.1):
        moved = eta + shift * np.array([1.0, -1.0, 0.5, 0.01])
        full = compute_log_likelihood_array(local, moved, *noise)
        found = compute_log_likelihood_array(smaller, moved, *noise)
        assert found == pytest.approx(full, abs=1e-5)
    far = compute_log_likelihood_array(smaller, eta + np.array([9.0, 0, 0, 0]), *noise)
    assert np.isfinite(far).all()
