import numpy as np
import pytest

from softfinger.concealed.noise import (
    NOISE_KINDS,
    Noise,
    draw_frame_times,
    draw_missing,
    draw_noise,
    whiten,
)

JOINTS, SD, INTERVAL = 3, 0.004, 0.05


def _draw(kind, duration=400.0):
    rng = np.random.default_rng(3)
    noise = Noise(kind, SD, INTERVAL)
    time = draw_frame_times(noise, duration, rng)
    return noise, time, draw_noise(noise, time, JOINTS, rng)


@pytest.mark.parametrize("kind", NOISE_KINDS)
def test_noise_has_the_declared_sd_and_neighbours_share_a_link(kind):
    _, _, values = _draw(kind, 6000.0)
    assert np.allclose(values.std(axis=0), SD, rtol=0.1)
    link = np.corrcoef(values.T)
    assert np.allclose(np.diag(link, 1), -0.5, atol=0.08)
    assert abs(link[0, 2]) < 0.1


@pytest.mark.parametrize(("kind", "rho"), [("white", 0.0), ("ar_0.3", 0.3), ("ar_0.9", 0.9)])
def test_noise_remembers_over_a_frame(kind, rho):
    _, _, values = _draw(kind, 1000.0)
    found = np.corrcoef(values[1:, 0], values[:-1, 0])[0, 1]
    assert found == pytest.approx(rho, abs=0.03)


def test_heavy_tails_are_heavy():
    _, _, values = _draw("heavy_tailed", 2000.0)
    assert (np.abs(values) > 4.0 * SD).mean() > 5e-4
    _, _, normal = _draw("white", 2000.0)
    assert (np.abs(normal) > 4.0 * SD).mean() < 3e-4


@pytest.mark.parametrize("kind", ["white", "ar_0.9", "ar_0.98", "uneven"])
def test_whitened_noise_is_white_with_unit_sd(kind):
    noise, time, values = _draw(kind)
    white = whiten(noise, time, values)
    assert white.std() == pytest.approx(1.0, abs=0.02)
    joints = np.corrcoef(white.T) - np.eye(JOINTS)
    assert np.abs(joints).max() < 0.05
    assert abs(np.corrcoef(white[1:, 1], white[:-1, 1])[0, 1]) < 0.05


def test_whitening_keeps_the_likelihood_over_a_gap():
    noise = Noise("ar_0.9", SD, INTERVAL)
    time = np.array([0.0, 0.05, 0.35, 0.40])
    memory = 0.9 ** (np.abs(time[:, None] - time) / INTERVAL)
    link = np.eye(2) - 0.5 * np.eye(2)[::-1]
    signal = np.random.default_rng(0).normal(size=(4, 2))
    covariance = SD**2 * np.kron(memory, link)
    expected = signal.ravel() @ np.linalg.solve(covariance, signal.ravel())
    assert (whiten(noise, time, signal) ** 2).sum() == pytest.approx(expected)


def test_only_a_gappy_recording_misses_frames():
    rng = np.random.default_rng(1)
    missing = draw_missing(Noise("gappy", SD, INTERVAL), 1000, rng)
    assert 0.1 < missing.mean() < 0.25
    assert not draw_missing(Noise("white", SD, INTERVAL), 1000, rng).any()


def test_an_uneven_clock_never_runs_backwards():
    noise = Noise("uneven", SD, INTERVAL)
    time = draw_frame_times(noise, 40.0, np.random.default_rng(2))
    assert np.diff(time).min() > 0
    assert np.ptp(np.diff(time)) > INTERVAL
