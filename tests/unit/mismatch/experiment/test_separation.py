"""What recordings would tell apart, against dense normal densities."""

import numpy as np
import pytest

from softfinger.mismatch.experiment.outlook import Foreseen
from softfinger.mismatch.experiment.separation import (
    TrialsDensity,
    bound_gain,
    expect_log_ratio,
    expect_sure,
)

TRIALS, SIZE, OWN, EFFECTS = 3, 5, 2, 1


def draw_foreseen(seed, away=0.0):
    rng = np.random.default_rng(seed)
    own = rng.normal(size=(TRIALS, SIZE, OWN))
    moved = np.concatenate([own, rng.normal(size=(TRIALS, SIZE, EFFECTS))], axis=2)
    root = rng.normal(size=(OWN + EFFECTS, OWN + EFFECTS))
    return Foreseen(
        away + rng.normal(size=(TRIALS, SIZE)),
        own,
        moved,
        np.array([[0.5, 0.1], [0.1, 0.3]]),
        0.2 * np.eye(OWN + EFFECTS) + 0.1 * root @ root.T,
    )


def build_covariance(part):
    stacked = part.moved.reshape(-1, part.moved.shape[2])
    total = stacked @ part.covariance @ stacked.T + np.eye(len(stacked))
    for i in range(TRIALS):
        rows = slice(SIZE * i, SIZE * (i + 1))
        total[rows, rows] += part.own[i] @ part.omega @ part.own[i].T
    return total


def diverge(one, other):
    """Kullback and Leibler's divergence of dense normals [nats]."""
    mine, its = build_covariance(one), build_covariance(other)
    away = (one.centre - other.centre).ravel()
    inverse = np.linalg.inv(its)
    volume = np.linalg.slogdet(its)[1] - np.linalg.slogdet(mine)[1]
    return 0.5 * (np.trace(inverse @ mine) + away @ inverse @ away - len(away) + volume)


def test_the_expected_evidence_is_the_divergence_of_the_dense_densities():
    parts = [draw_foreseen(seed, away) for seed, away in ((1, 0.0), (2, 1.0), (3, -2.0))]
    found = expect_log_ratio(parts)
    wanted = [[diverge(a, b) for b in parts] for a in parts]
    np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-9)


def test_a_density_is_the_dense_one():
    part = draw_foreseen(4)
    values = np.random.default_rng(5).normal(size=(2, TRIALS, SIZE))
    covariance = build_covariance(part)
    away = (values - part.centre).reshape(2, -1)
    square = np.einsum("na,ab,nb->n", away, np.linalg.inv(covariance), away)
    wanted = -0.5 * (square + np.linalg.slogdet(covariance)[1])
    np.testing.assert_allclose(TrialsDensity(part).score(values), wanted, rtol=1e-10)


def test_survivors_far_apart_give_a_sure_answer_and_equal_ones_none():
    near = draw_foreseen(1)
    even, rng = np.array([0.5, 0.5]), np.random.default_rng(6)
    far = near._replace(centre=near.centre + 60.0)
    assert expect_sure([near, far], even, rng, 100) == (1.0, 1.0)
    assert expect_sure([near, near], even, rng, 100) == (0.0, 0.0)


def test_a_stated_probability_is_right_as_often_as_it_says():
    """Where the recordings come from the survivors, what is sure is right 95 times in 100."""
    one, other = draw_foreseen(1), draw_foreseen(2, 0.3)
    sure, right = expect_sure([one, other], np.array([0.5, 0.5]), np.random.default_rng(7), 4000)
    assert sure > 0.2
    assert right >= 0.95 * sure


@pytest.mark.parametrize("hopeless", [0.0, 2.0])
def test_a_pair_that_nothing_shows_does_not_hide_another(hopeless):
    weight = 1.0 - np.eye(3)
    low, high = np.full((3, 3), hopeless), np.full((3, 3), hopeless)
    low[0, 1], high[0, 1] = 5.0, 9.0
    assert bound_gain(high, weight, 10.0) > bound_gain(low, weight, 10.0)
