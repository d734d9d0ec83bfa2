"""Components of a measurement are chosen by evidence, and are never absurd."""

import numpy as np

from softfinger.measurement.components import choose_components


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


def test_the_best_alone_may_be_in_the_way_of_a_better_set():
    """The drift of a gain explains most alone; a drift of the picture and a noisy log more."""
    worth = {
        "gain_drift": 50.0, "drift": 45.0, "noisy_load": 0.0, "drift+noisy_load": 90.0,
        "drift+gain_drift": 51.0, "gain_drift+noisy_load": 51.0,
        "drift+gain_drift+noisy_load": 91.0,
    }  # fmt: skip
    sizes = {name: np.ones(1) for name in ("drift", "gain_drift", "noisy_load")}
    size, evidence = choose_components(lambda some: worth.get("+".join(sorted(some)), 0.0), sizes)
    assert set(size) == {"drift", "noisy_load"}
    assert evidence["noisy_load"] == 45.0
