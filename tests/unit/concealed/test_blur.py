"""What the oracle knows of a trial's errors, beside the dense covariance."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal, multivariate_t

from softfinger.concealed.blur import build_blur, keep_frames
from softfinger.concealed.noise import Noise, whiten
from softfinger.concealed.nuisances import Mark

FRAMES, JOINTS = 7, 3
TIME = np.array([0.0, 0.05, 0.1, 0.15, 0.3, 0.35, 0.4])


@pytest.fixture
def marks():
    rng = np.random.default_rng(1)
    return [
        Mark(scale=np.exp(0.3 * rng.normal(size=(FRAMES, JOINTS))), nats=-2.5),
        Mark(columns=0.01 * rng.normal(size=(FRAMES, JOINTS, 2))),
        Mark(columns=0.003 * rng.normal(size=(FRAMES, JOINTS, 1)), scale=1.7),
    ]


def _compute_covariance(noise, marks):
    memory = noise.autocorrelation ** (np.abs(TIME[:, None] - TIME) / noise.frame_interval)
    factor = np.prod([np.ones((FRAMES, JOINTS)) * m.scale for m in marks], axis=0).ravel()
    covariance = noise.sd**2 * np.kron(memory, noise.link(JOINTS)) * factor[:, None] * factor
    for mark in marks:
        if mark.columns is not None:
            columns = mark.columns.reshape(FRAMES * JOINTS, -1)
            covariance += columns @ columns.T
    return covariance


@pytest.mark.parametrize("kind", ["ar_0.3", "ar_0.9"])
def test_the_likelihood_is_that_of_the_dense_covariance(kind, marks):
    noise = Noise(kind, 0.004, 0.05)
    blur = build_blur(noise, TIME, JOINTS, marks)
    signal = 0.01 * np.random.default_rng(2).normal(size=(FRAMES, JOINTS))
    white = blur.whiten(signal)
    covariance = _compute_covariance(noise, marks)
    exact = multivariate_normal(np.zeros(FRAMES * JOINTS), covariance).logpdf(signal.ravel())
    assert -0.5 * (white**2).sum() + blur.add_nats(white) == pytest.approx(exact - 2.5)


def test_whitening_is_linear_over_further_axes(marks):
    blur = build_blur(Noise("ar_0.9", 0.004, 0.05), TIME, JOINTS, marks)
    signals = np.random.default_rng(3).normal(size=(FRAMES, JOINTS, 4))
    each = np.stack([blur.whiten(signals[..., k]) for k in range(4)], axis=-1)
    np.testing.assert_allclose(blur.whiten(signals), each, rtol=1e-9)


def test_without_marks_only_the_noise_is_left():
    noise = Noise("ar_0.9", 0.004, 0.05)
    signal = np.random.default_rng(3).normal(size=(FRAMES, JOINTS))
    blur = build_blur(noise, TIME, JOINTS, [])
    np.testing.assert_array_equal(blur.whiten(signal), whiten(noise, TIME, signal))


def test_frames_that_are_left_out_take_their_rows_with_them(marks):
    kept = np.array([True, True, False, True, False, True, True])
    blur = keep_frames(build_blur(Noise("ar_0.9", 0.004, 0.05), TIME, JOINTS, marks), kept)
    rows = np.flatnonzero(np.repeat(kept, JOINTS))
    covariance = _compute_covariance(blur.noise, marks)[np.ix_(rows, rows)]
    signal = np.random.default_rng(4).normal(size=(kept.sum(), JOINTS))
    square = signal.ravel() @ np.linalg.solve(covariance, signal.ravel())
    assert (blur.whiten(signal) ** 2).sum() == pytest.approx(square)


def test_innovations_of_known_size_are_weighed_as_students():
    freedom, noise = 3.0, Noise("white", 0.004, 0.05)
    shock = np.random.default_rng(5).uniform(0.3, 3.0, FRAMES)
    blur = build_blur(noise, TIME, JOINTS, [Mark(shock=shock, tails=freedom)])
    signal = 0.01 * np.random.default_rng(6).normal(size=(FRAMES, JOINTS))
    white = blur.whiten(signal)
    shape = (freedom - 2.0) / freedom * noise.sd**2 * noise.link(JOINTS)
    exact = multivariate_t(np.zeros(JOINTS), shape, freedom).logpdf(signal).sum()
    assert -0.5 * (white**2).sum() + blur.add_nats(white) == pytest.approx(exact)
