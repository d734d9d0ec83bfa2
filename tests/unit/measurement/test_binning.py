import numpy as np
import pytest

from softfinger.measurement.binning import (
    build_whitening,
    compute_bin_covariance_array,
    cut_bins_array,
    place_nodes_array,
)


@pytest.fixture
def trial():
    rng = np.random.default_rng(3)
    time = np.cumsum(rng.uniform(0.5, 1.5, 61))
    starts = np.array([0, 1, 2, 4, 9, 23, 24, 40, 61])
    return time, rng.uniform(0.5, 2.0, 61), starts


def test_covariance_of_bins_is_the_average_of_that_of_frames(trial):
    time, scale, starts = trial
    sd, rho = np.array([1.0, 2.0, 0.5]), np.array([0.0, 0.6, 0.95])
    white = np.array([0.0, 0.5, 0.2])
    mixing = np.array([[1.0, -0.5, 0.1], [-0.5, 1.0, -0.4], [0.1, -0.4, 1.0]])
    stationary = np.outer(sd, sd) * mixing
    got = compute_bin_covariance_array(time, scale, starts, stationary, rho, white)
    average = np.zeros((8, 61))
    for b in range(8):
        average[b, starts[b] : starts[b + 1]] = 1.0 / (starts[b + 1] - starts[b])
    gap = time[None, :] - time[:, None]
    got = got.reshape(8, 3, 8, 3)
    for j in range(3):
        for k in range(3):
            later = np.where(gap > 0, rho[k], rho[j]) ** np.abs(gap)
            later *= np.sqrt((1 - white[j]) * (1 - white[k]))
            later += np.sqrt(white[j] * white[k]) * np.eye(61)
            frames = stationary[j, k] * later * np.outer(scale, scale)
            np.testing.assert_allclose(got[:, j, :, k], average @ frames @ average.T, atol=1e-12)


def test_whitened_noise_has_unit_covariance(trial):
    time, scale, starts = trial
    covariance = compute_bin_covariance_array(
        time, scale, starts, np.eye(1), np.array([0.9]), np.zeros(1)
    )
    whitening = build_whitening(covariance)
    factor = np.linalg.cholesky(covariance)
    np.testing.assert_allclose(whitening.matrix @ factor, np.eye(8), atol=1e-7)
    assert whitening.logdet == pytest.approx(np.linalg.slogdet(covariance)[1])


def test_nodes_average_a_cubic_over_even_bins():
    time = np.arange(12.0) * 0.1
    starts = np.array([0, 1, 5, 12])
    nodes = place_nodes_array(time, starts)
    cubic = np.polynomial.Polynomial([1.0, -2.0, 0.5, 3.0])
    expected = [cubic(time[a:b]).mean() for a, b in [(0, 1), (1, 5), (5, 12)]]
    np.testing.assert_allclose(cubic(nodes).mean(axis=1), expected, rtol=1e-12)


def test_bins_end_at_changes_of_load_and_at_gaps():
    time = np.delete(np.arange(0.0, 40.0, 0.1), slice(300, 320))
    starts = cut_bins_array(time, np.array([0.0, 20.05]), 0.1)
    assert np.searchsorted(time, 20.05) in starts
    assert 300 in starts
    assert len(starts) < 150
    np.testing.assert_array_equal(starts[:8], np.arange(8))
