"""Components of a measurement are chosen by evidence, and are never absurd."""

import numpy as np
import pytest

from softfinger.measurement.components import choose_components, is_at_bound


def test_a_component_is_at_most_twice_as_large_as_it_may_be():
    """Evidence that grows without end: what causes it is not this component."""

    def evaluate(size):
        return 100.0 * np.log(size["timing_jitter"] / 1e-4) if size else 0.0

    size, _ = choose_components(evaluate, {"timing_jitter": np.array([0.001, 0.008])})
    assert 0.012 < size["timing_jitter"] <= 0.016 * (1 + 1e-9)


def test_what_is_there_depends_on_the_evidence_that_is_asked_for():
    sizes = {"drift": np.ones(1)}
    assert choose_components(lambda size: 4.0 * len(size), sizes)[0] == {}
    assert set(choose_components(lambda size: 4.0 * len(size), sizes, 3.0)[0]) == {"drift"}


def test_beside_a_model_without_evidence_nothing_is_chosen():
    sizes = {"drift": np.ones(1)}
    assert choose_components(lambda size: 9.0 if size else -np.inf, sizes) == ({}, {})


def test_what_is_not_plausible_leaves_and_the_others_are_sought_again():
    """A wrong component took another's part; without it the other has its own size."""

    def evaluate(size):
        drift = size.get("drift", 0.0)
        jitter = size.get("jitter", 1e-9)
        own = -((np.log(jitter) - (0.0 if drift else np.log(2.0))) ** 2)
        return 100.0 * drift + (50.0 + own if "jitter" in size else 0.0)

    sizes = {"drift": np.array([0.5, 1.0]), "jitter": np.array([0.5, 1.0, 2.0])}
    asked = {}

    def is_plausible(name, size):
        asked.setdefault(name, size)
        return name != "drift" or not is_at_bound(size, sizes[name])

    size, evidence = choose_components(evaluate, sizes, 3.0, is_plausible)
    assert is_at_bound(asked["drift"], sizes["drift"])
    assert size == {"jitter": pytest.approx(2.0, rel=0.1)}
    assert set(evidence) == {"jitter"}
    assert set(choose_components(evaluate, sizes, 3.0)[0]) == {"drift", "jitter"}


def test_sizes_are_sought_along_slopes_where_they_are_known():
    """Every evaluation of a slope counts once, however many components there are."""
    names, asked = "abcd", []

    def evaluate(size):
        return sum(50.0 - np.log(sd / (2.0 + k)) ** 2 for k, sd in enumerate(size.values()))

    def climb(size):
        asked.append(size)
        slope = {name: -2.0 * np.log(sd / (2.0 + k)) for k, (name, sd) in enumerate(size.items())}
        return evaluate(size), slope

    size, _ = choose_components(
        evaluate, {name: np.array([2.0, 4.0]) for name in names}, climb=climb
    )
    assert [size[name] for name in names] == pytest.approx([2.0, 3.0, 4.0, 5.0], rel=0.03)
    assert len(asked) < 40
