"""Gram matrices under larger noise, against the whole covariance and against differences."""

import numpy as np
import pytest

from softfinger.inference.mixed_effects import Prior, fit_linear
from softfinger.inference.soften import Softening, admit, measure_excess, soften_gram


def pose(rng, trials=1, own=3, others=4):
    """Rows of a model with its residual, and directions of two disturbances."""
    rows = rng.normal(size=(trials, 20, own + 1))
    soft = rng.normal(size=(trials, 20, others + 2))
    whole = np.concatenate([rows, soft], axis=2)
    places = {"a": np.arange(own + 1, own + 3), "b": np.arange(own + 3, own + others + 3)}
    gram = whole.transpose(0, 2, 1) @ whole
    return rows, soft, Softening(gram, np.arange(own + 1), places)


def test_gram_matrices_are_those_of_the_whole_covariance():
    rows, soft, softening = pose(np.random.default_rng(2))
    gram, logdet = soften_gram(softening, {"b": 0.7, "a": 0.3})
    sd = np.array([0.3, 0.3, 0.7, 0.7, 0.7, 0.7])
    covariance = np.eye(20) + (sd * soft[0]) @ (sd * soft[0]).T
    np.testing.assert_allclose(gram[0], rows[0].T @ np.linalg.solve(covariance, rows[0]))
    assert logdet == pytest.approx(np.linalg.slogdet(covariance)[1])


def test_disturbances_may_be_integrated_one_after_the_other():
    _, _, softening = pose(np.random.default_rng(3), trials=2)
    gram, logdet = soften_gram(softening, {"a": 0.5, "b": 2.0})
    left, first = admit(softening, {"a": 0.5})
    assert list(left.places) == ["b"]
    again, second = soften_gram(left, {"b": 2.0})
    np.testing.assert_allclose(again, gram)
    assert first + second == pytest.approx(logdet)


def test_the_slope_by_a_size_is_that_of_differences():
    """Also where the model is linearised away from its best, and with a shared parameter."""
    rng = np.random.default_rng(4)
    _, _, softening = pose(rng, trials=5)
    prior = Prior(np.zeros(3), np.full(3, 0.1), np.ones(2), 4.0, 2)
    place = rng.normal(size=(5, 2)), rng.normal(size=1)

    def solve(size):
        gram, logdet = soften_gram(softening, size)
        moved = gram.copy()
        away = np.concatenate([place[0], np.broadcast_to(place[1], (5, 1))], axis=1)
        added = np.einsum("tab,tb->ta", gram[:, :, :3], away)
        moved[:, :, -1] += added
        moved[:, -1, :] += added
        moved[:, -1, -1] += np.einsum("ta,ta->t", added[:, :3], away)
        linear = fit_linear(moved, prior, np.eye(2), rounds=200, tolerance=1e-12)
        return linear.log_evidence - 0.5 * logdet, gram, linear

    size = {"a": 0.6, "b": 1.4}
    _, gram, linear = solve(size)
    slope = measure_excess(softening, size, gram, linear, place)
    for name in size:
        up, down = (solve(size | {name: size[name] * np.exp(e)})[0] for e in (1e-4, -1e-4))
        assert slope[name] == pytest.approx((up - down) / 2e-4, rel=1e-4)
