"""Ranks of the truth are uniform if, and only if, the model and its sampling are right."""

import pytest

CHANCE = 0.001  # of a false alarm in a run, shared among the quantities
WRONG_LOAD = 1.3
VERY_WRONG_LOAD = 1.6


@pytest.mark.slow
def test_ranks_of_a_small_sample_are_uniform_and_a_wrong_load_is_found(find_p_values):
    right = find_p_values(4, 1)
    assert min(right.values()) > CHANCE / len(right)
    wrong = find_p_values(6, 2, VERY_WRONG_LOAD)
    assert wrong["log_k_v"] < CHANCE


@pytest.mark.slow
def test_ranks_are_uniform(find_p_values):
    p = find_p_values(200, 3)
    print(p)
    assert min(p.values()) > CHANCE / len(p)


@pytest.mark.slow
def test_a_wrong_load_is_found(find_p_values):
    assert find_p_values(60, 4, WRONG_LOAD)["log_k_v"] < 1e-6
