"""What moves from row to row of a log moves on straight lines."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from softfinger.campaign.load_log import build_load_array
from softfinger.measurement.open_gaps import find_open_gaps_array
from softfinger.measurement.ramps import straighten_ramps_array, turn_between_rows_array
from softfinger.measurement.steady import steady_load_array

WITHIN = 0.05


def read(rows, begin, span, interval=0.02):
    """Knots that the reader makes of a ramp from 0 to 1."""
    time = interval * np.arange(rows)
    load = np.interp(time, [begin, begin + span], [0.0, 1.0])
    return build_load_array(time, load, step_within=WITHIN)


@pytest.mark.parametrize("span", [0.07, 0.1, 0.15])
@pytest.mark.parametrize("begin", [0.2, 0.207, 0.213])
def test_a_ramp_begins_and_ends_where_it_did(begin, span):
    time, torque = straighten_ramps_array(*read(40, begin, span), WITHIN)
    dense = np.linspace(0.0, 0.75, 3001)
    truth = np.interp(dense, [begin, begin + span], [0.0, 1.0])
    np.testing.assert_allclose(np.interp(dense, time, torque), truth, atol=1e-6)


def test_a_ramp_of_one_row_is_as_steep_as_it_must_be():
    time, torque = straighten_ramps_array(*read(40, 0.21, 0.02), WITHIN)
    dense = np.linspace(0.0, 0.75, 3001)
    truth = np.interp(dense, [0.21, 0.23], [0.0, 1.0])
    assert abs(np.trapezoid(np.interp(dense, time, torque) - truth, dense)) < 0.001


def test_a_step_stays_a_step():
    stair = read(40, 0.205, 0.01)
    for found, known in zip(straighten_ramps_array(*stair, WITHIN), stair, strict=True):
        np.testing.assert_array_equal(found, known)


def test_a_wave_is_no_stair():
    time = 0.02 * np.arange(200)
    wave = np.where(time < 0.5, 0.0, 1.0 - np.cos(time - 0.5))
    knots, load = straighten_ramps_array(*build_load_array(time, wave, WITHIN), WITHIN)
    dense = np.linspace(0.0, 3.9, 4001)
    truth = np.where(dense < 0.5, 0.0, 1.0 - np.cos(dense - 0.5))
    np.testing.assert_allclose(np.interp(dense, knots, load), truth, atol=2e-4)


def test_steps_between_levels_stay():
    stair = build_load_array(0.02 * np.arange(12), np.repeat([0.0, 1.0, 0.5, 0.6], 3), WITHIN)
    for found, known in zip(straighten_ramps_array(*stair, WITHIN), stair, strict=True):
        np.testing.assert_array_equal(found, known)


@given(st.lists(st.tuples(st.floats(0.2, 9.0), st.floats(-9.0, 9.0)), min_size=1, max_size=8))
def test_steps_that_a_log_states_at_one_time_stay(levels):
    """From level to level: no stair of rows, however many follow each other."""
    ends = np.cumsum([duration for duration, _ in levels])
    time = np.stack([np.append(0.0, ends[:-1]), ends], axis=1).ravel()
    knots = build_load_array(time, np.repeat([level for _, level in levels], 2), WITHIN)
    for found, known in zip(straighten_ramps_array(*knots, WITHIN), knots, strict=True):
        np.testing.assert_array_equal(found, known)


def test_the_last_knot_may_be_repeated():
    stair = build_load_array(0.02 * np.arange(5), np.array([0.0, 0.0, 1.0, 2.0, 3.0]), WITHIN)
    padded = [np.append(part, np.repeat(part[-1], 3)) for part in stair]
    straight = straighten_ramps_array(*stair, WITHIN)
    for found, known in zip(straighten_ramps_array(*padded, WITHIN), straight, strict=True):
        np.testing.assert_array_equal(found[: len(known)], known)
        np.testing.assert_array_equal(found[len(known) :], known[-1])


@given(st.lists(st.floats(-1.0, 1.0), min_size=2, max_size=12))
def test_rows_stay_and_time_runs_forward(load):
    time = 0.02 * np.arange(len(load))
    stair = build_load_array(time, np.array(load), WITHIN)
    straight = straighten_ramps_array(*stair, WITHIN)
    assert np.all(np.diff(straight[0]) >= 0.0)
    rows = np.flatnonzero(np.append(np.diff(stair[0]) > 0.0, True))
    for found, known in zip(straight, stair, strict=True):
        np.testing.assert_array_equal(found[rows], known[rows])


@pytest.mark.parametrize("phase", [0.0, 0.3, 0.77])
@pytest.mark.parametrize("span", [0.21, 0.4])
def test_a_ramp_turns_between_the_rows_of_a_slow_log(phase, span):
    """Between its first and last row alone it seems to begin sooner, and to end later."""
    rows = 0.08 * (phase + np.arange(40))
    log = build_load_array(rows, np.interp(rows, [1.03, 1.03 + span], [2.0, 9.0]), WITHIN)
    gaps = find_open_gaps_array(*log, WITHIN / 1.5)
    time, torque = turn_between_rows_array(*log, gaps)
    dense = np.linspace(rows[0], rows[-1], 3001)
    truth = np.interp(dense, [1.03, 1.03 + span], [2.0, 9.0])
    np.testing.assert_allclose(np.interp(dense, time, torque), truth, atol=1e-6)
    again = turn_between_rows_array(time, torque, find_open_gaps_array(time, torque, WITHIN / 1.5))
    np.testing.assert_allclose(np.interp(dense, *again), truth, atol=1e-6)


def test_a_slow_log_of_a_decay_becomes_no_worse():
    def decay(time):
        return np.where(time < 1.0, 0.0, -np.expm1((1.0 - time) / 0.15))

    rows, dense = 0.08 * np.arange(40), np.linspace(0.0, 3.1, 3001)
    log = build_load_array(rows, decay(rows), WITHIN)
    gaps = find_open_gaps_array(*log, WITHIN / 1.5)
    assert gaps.size > 2
    turned = turn_between_rows_array(*log, gaps)
    before, after = (np.interp(dense, *knots) - decay(dense) for knots in (log, turned))
    assert np.abs(after).sum() < np.abs(before).sum()
    late = dense > 1.1
    np.testing.assert_array_equal(after[late], before[late])


@pytest.mark.parametrize("phase", [0.1, 0.5, 0.85])
def test_a_slow_log_cuts_no_crest(phase):
    knots, loads = [1.53, 2.53, 3.61, 4.6, 6.0], [0.0, 8.0, 1.0, 9.0, 0.0]
    rows = np.append(0.0, 0.1 * (phase + np.arange(80)))
    log = build_load_array(rows, np.interp(rows, knots, loads), WITHIN)
    gaps = find_open_gaps_array(*log, WITHIN / 1.5)
    dense = np.linspace(0.0, 8.0, 4001)
    truth = np.interp(dense, knots, loads)
    away = [
        np.abs(np.interp(dense, *load) - truth).max()
        for load in (log, turn_between_rows_array(*log, gaps))
    ]
    assert away[0] > 0.2
    assert away[1] < 1e-6


@pytest.mark.parametrize(("begin", "span"), [(0.2, 0.1), (0.207, 0.4), (0.21, 0.02)])
def test_a_row_that_is_held_moves_as_its_stair_does(begin, span):
    stair = read(40, begin, span)
    time, torque = straighten_ramps_array(*stair, WITHIN, held=True)
    assert np.all(np.diff(time) >= 0.0)
    dense = np.linspace(0.0, 0.75, 7501)
    loads = (stair, straighten_ramps_array(*stair, WITHIN), (time, torque))
    area, early, held = (np.trapezoid(step_through(*load, dense), dense) for load in loads)
    assert held == pytest.approx(area, abs=0.003)
    assert early - area == pytest.approx(0.01, abs=0.003)


def step_through(time, load, at):
    """Load at some times; of two knots at one time the later one counts."""
    return np.interp(at, time + 1e-9 * np.arange(len(time)), load)


@pytest.mark.parametrize("rise", [3.0, 0.05])
def test_a_step_between_levels_that_drift_stays_a_step(rise):
    """It became the steep part of a ramp, and came half a row too soon."""
    time = 0.02 * np.arange(200)
    load = np.where(time < 2.0, 1.0, 1.0 + rise) + 0.001 * time
    log = build_load_array(time, load, WITHIN)
    steadied = log[0], steady_load_array(*log)
    for held in (False, True):
        knots, torque = straighten_ramps_array(*steadied, WITHIN, held=held)
        early, late = np.interp(
            [2.0 - 1e-6, 2.0 + 1e-6], knots + 1e-9 * np.arange(400)[: len(knots)], torque
        )
        assert late - early == pytest.approx(rise, rel=0.05)
