import numpy as np
import pytest

from softfinger.population.collapse import collapse_angles, restrict_collapse
from softfinger.population.frames import select_frames
from softfinger.population.likelihood import compute_log_likelihood_array, sum_log_likelihood
from softfinger.population.pilot import count_patterns


def get_noise(noise):
    return [noise[f"noise_{name}"].values for name in ("sd", "autocorrelation", "correlation")]


@pytest.fixture
def collapse(campaign):
    angles, _, _ = campaign
    angles["joint_angle"][1, 0, 7:9] = np.nan
    angles["joint_angle"][3, 2, 20:] = np.nan
    return collapse_angles(angles, select_frames(angles))


def test_slopes_are_those_of_differences(collapse, eta, campaign):
    noise = get_noise(campaign[2])
    data = (*collapse.table, collapse.products, collapse.first, collapse.pattern)
    data += (collapse.patterns, collapse.gap, count_patterns(collapse))
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


def test_sum_and_trials_agree(collapse, eta, campaign):
    noise = get_noise(campaign[2])
    data = (*collapse.table, collapse.products, collapse.first, collapse.pattern)
    data += (collapse.patterns, collapse.gap, count_patterns(collapse))
    total = sum_log_likelihood(eta, *noise, *data)[0] + collapse.offset.sum()
    each = compute_log_likelihood_array(collapse, eta, *noise)
    assert total == pytest.approx(each.sum(), rel=1e-12)


def test_an_absent_joint_has_no_say(collapse, eta, campaign):
    noise = get_noise(campaign[2])
    before = compute_log_likelihood_array(collapse, eta, *noise)
    eta[3, 2] += 0.3
    after = compute_log_likelihood_array(collapse, eta, *noise)
    assert after == pytest.approx(before, rel=1e-12)


def test_a_trial_without_frames_says_nothing(campaign, eta):
    angles, _, noise = campaign
    angles["joint_angle"][4] = np.nan
    collapse = collapse_angles(angles, select_frames(angles))
    found = compute_log_likelihood_array(collapse, eta, *get_noise(noise))
    assert found[4] == 0
    assert (found[:4] > 100).all()


def test_fewer_modes_say_the_same_between_their_limits(collapse, eta, campaign):
    x = eta[..., 0] - eta[..., 1]
    smaller = restrict_collapse(collapse, x.min() - 0.3, x.max() + 0.3)
    assert smaller.first.shape[1] < collapse.first.shape[1]
    noise = get_noise(campaign[2])
    for shift in (0.0, 0.1):
        full = compute_log_likelihood_array(collapse, eta + shift, *noise)
        assert compute_log_likelihood_array(smaller, eta + shift, *noise) == pytest.approx(
            full, abs=1e-4
        )
