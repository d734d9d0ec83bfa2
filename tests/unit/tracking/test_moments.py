"""The start of a fit by grey moments."""

import numpy as np
import pytest
from benchmarks._discs import draw_disc, expose

from softfinger.tracking.moments import move_to_moments
from softfinger.tracking.normal import find_chord

SHAPE, NONE = (40, 53), np.empty((0, 3))


def move(light, place, rng, contrast=-120.0, level=180.0, slope=0.0, others=NONE, own=-1):
    p = np.array([*place, contrast, 6.0, 0.7, level, slope, 0.0])
    moved = move_to_moments(expose(light, 3.0, rng)[:, :, None], np.ones(1), p, 4.0, others, own)
    return moved, p[:2]


@pytest.mark.parametrize("off", [(0.0, 0.0), (2.5, -1.0), (-3.0, 2.0)])
def test_the_start_is_near_the_centre_wherever_the_disc_lies_in_the_window(off, rng):
    light = 180.0 - 120.0 * draw_disc(SHAPE, (25.3, 18.6), 6.0, 0.6)
    moved, place = move(light, np.add((25.3, 18.6), off), rng)
    assert moved
    np.testing.assert_allclose(place, (25.3, 18.6), atol=0.06)


def test_a_known_shade_does_not_move_the_start(rng):
    even = 180.0 - 120.0 * draw_disc(SHAPE, (25.3, 18.6), 6.0, 0.6)
    light = even * (1.0 + 0.01 * (np.arange(SHAPE[1]) - 25.3))
    moved, place = move(light, (25.3, 18.6), rng, slope=0.01)
    assert moved
    np.testing.assert_allclose(place, (25.3, 18.6), atol=0.2)


def test_another_amount_of_light_or_a_neighbour_is_no_start(rng):
    light = 180.0 - 120.0 * draw_disc(SHAPE, (25.3, 18.6), 6.0, 0.6)
    assert not move(180.0 + 0.0 * light, (25.3, 18.6), rng)[0]  # no disc
    assert not move(light, (25.3, 18.6), rng, level=205.0)[0]  # the light has changed
    assert not move(light, (17.3, 18.6), rng)[0]  # it is half out of the window
    two = np.array([[25.3, 18.6, 7.4], [38.0, 18.6, 7.4]])
    moved, place = move(light, (26.0, 18.0), rng, others=two, own=0)
    assert not moved
    np.testing.assert_array_equal(place, (26.0, 18.0))


def test_a_chord_is_where_a_row_crosses_a_circle():
    columns = np.arange(30)
    for dy in (-6.0, -4.9, 0.0, 3.3, 4.99, 7.0):
        for x in (-3.4, 2.1, 15.0, 28.8, 36.0):
            first, end = find_chord(x, dy, 5.0, 0, 30)
            within = columns[(columns - x) ** 2 + dy**2 <= 25.0]
            assert 0 <= first <= end <= 30
            np.testing.assert_array_equal(columns[first:end], within)
