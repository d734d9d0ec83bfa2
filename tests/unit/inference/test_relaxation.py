"""Changes that overshoot, each about the last one back: the part that comes to rest."""

import numpy as np
import pytest

from softfinger.inference.relaxation import Relaxation


def iterate(answer, start, count):
    """Go towards what `answer` asks for, as a fit does; the places that were reached."""
    place, taken, places = np.array([start]), Relaxation(), []
    for _ in range(count):
        wanted = np.array([answer(place[0])]) - place
        part = taken.limit(wanted)
        taken = taken.take(part, wanted, part)
        place = place + part * wanted
        places.append(place[0])
    return np.array(places)


@pytest.mark.parametrize("slope", [-0.95, -1.0, -6.0])
def test_an_answer_that_overshoots_comes_to_rest(slope):
    places = iterate(lambda x: 1.0 + slope * (x - 1.0), 2.0, 12)
    assert abs(places[-1] - 1.0) < 1e-3


def test_an_answer_that_does_not_overshoot_is_taken_whole():
    places = iterate(lambda x: 1.0 + 0.5 * (x - 1.0), 2.0, 8)
    np.testing.assert_allclose(places, 1.0 + 0.5 ** np.arange(1, 9))


def test_an_answer_that_bends_does_not_go_round_for_ever():
    # Far out flat, near its rest steep: whole steps go round for ever, and so do parts that grow
    # as freely as they shrink.
    places = iterate(lambda x: -6.0 * np.tanh(x), 1.0, 120)
    assert np.abs(places[-5:]).max() < 0.05
