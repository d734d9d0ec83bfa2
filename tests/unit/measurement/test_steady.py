"""Plateaus become steady, ramps straight; all else stays."""

import numpy as np
import pytest

from softfinger.inference.simulate import build_recording
from softfinger.measurement.steady import steady_load_array, steady_log
from softfinger.mechanics.load import drop_idle_knots

RNG = np.random.default_rng


def steady_rows(torque, held=False):
    """Steady readings every 10 ms, `held` up to the next or not."""
    time = 0.01 * np.arange(len(torque))
    if not held:
        return steady_load_array(time, torque)
    time, torque = np.repeat(time, 2)[1:], np.repeat(torque, 2)[:-1]
    return steady_load_array(time, torque)[::2]


def count_knots(torque):
    time = 0.01 * np.arange(len(torque))
    return drop_idle_knots(time[None], steady_load_array(time, torque)[None])[0].shape[1]


def test_a_ramp_ends_in_a_plateau_that_is_steadied():
    ramp, noise = np.array([0.0, 0.3, 0.6, 0.93, 0.965]), 0.003 * np.sin(np.arange(200.0))
    steady = steady_rows(np.concatenate([ramp, 1.0 + noise]))
    assert np.ptp(steady[5:]) == 0.0
    np.testing.assert_array_equal(steady[:4], ramp[:4])
    drifts = np.concatenate([ramp, np.linspace(1.0, 1.2, 200)])
    np.testing.assert_allclose(steady_rows(drifts), drifts)


@pytest.mark.parametrize("held", [False, True])
def test_plateaus_that_no_row_separates_are_steadied_alone(held):
    noise = 0.004 * RNG(1).normal(size=(3, 300))
    rise, fall = np.linspace(0.6, 0.76, 6)[1:-1], np.linspace(0.76, 0.68, 4)[1:-1]
    parts = [0.6 + noise[0], rise, 0.76 + noise[1], fall, 0.68 + noise[2]]
    steady = steady_rows(np.concatenate(parts), held)
    for start, level in ((0, 0.6), (304, 0.76), (606, 0.68)):
        inside = steady[start : start + 300]
        assert np.mean(inside == inside[150]) > 0.97
        np.testing.assert_allclose(inside[150], level, atol=0.001)


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("scatter", [0.0, 0.003])
def test_a_ramp_is_straight_and_no_stair(scatter, held):
    triangle = np.interp(np.arange(1000), [0, 499, 999], [0.0, 1.0, 0.0])
    read = triangle + scatter * RNG(2).normal(size=1000)
    steady = steady_rows(read, held)
    np.testing.assert_allclose(steady, triangle, atol=0.5 * scatter + 1e-9)
    assert np.mean(np.diff(steady) == 0.0) < 0.02


def test_ramps_turn_where_the_load_does():
    turns = np.array([0, 280, 590, 900, 1210])
    wave = np.interp(np.arange(1210), turns, [0.0, 1.0, 0.0, 1.0, 0.0])
    steady = steady_rows(wave + 0.003 * RNG(6).normal(size=1210))
    np.testing.assert_allclose(steady, wave, atol=0.01)


def test_a_noisy_ramp_has_a_few_knots():
    triangle = np.interp(np.arange(1000), [0, 499, 999], [0.0, 1.0, 0.0])
    assert count_knots(triangle + 0.003 * RNG(2).normal(size=1000)) < 30


def test_a_ramp_that_a_long_plateau_follows_is_straight_as_well():
    """Its last half, a few percent of the plateau's rows, kept the noise of every reading."""
    rows = np.arange(6000)
    truth = np.interp(rows, [500, 650, 3800, 3950], [0.0, 1.0, 1.0, 0.4])
    read = truth + 0.004 * RNG(7).normal(size=6000)
    np.testing.assert_allclose(steady_rows(read), truth, atol=0.03)
    assert count_knots(read) < 25


def test_a_small_ramp_between_levels_is_straight():
    """It lay within what counts as a level, and so half of it was taken for either level."""
    rows = np.arange(6000)
    truth = np.interp(rows, [500, 650, 3000, 3150], [0.0, 1.0, 1.0, 1.05])
    steady = steady_rows(truth + 0.003 * RNG(8).normal(size=6000))
    late = 0.01 * np.sum((steady - truth)[2900:3300]) / 0.05
    assert abs(late) < 0.1
    np.testing.assert_allclose(steady, truth, atol=0.015)


def test_readings_are_steady_up_to_a_jump():
    time = np.repeat(0.01 * np.arange(200), 2)[1:]
    levels = np.repeat([0.0, 1.0], 100) + 0.004 * RNG(5).normal(size=200)
    steady = steady_load_array(time, np.repeat(levels, 2)[:-1])
    assert np.count_nonzero(np.diff(steady)) == 1
    np.testing.assert_allclose(np.unique(steady), [0.0, 1.0], atol=0.002)


def test_a_ramp_of_few_rows_stays_as_it_is():
    rows = np.concatenate([np.zeros(50), [0.04, 0.07, 0.12, 0.15, 0.18], np.full(50, 0.2)])
    assert np.all(np.diff(steady_rows(rows)[49:56]) > 0.0)


def test_a_curve_is_followed():
    wave = np.sin(np.linspace(0.0, 6.0, 600))
    np.testing.assert_allclose(steady_rows(wave), wave, atol=1e-9)
    read = wave + 0.003 * RNG(4).normal(size=600)
    assert np.sqrt(np.mean((steady_rows(read) - wave) ** 2)) < 0.003


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("low", [0.97, 0.988])
def test_small_steps_are_kept_and_a_drift_is_not(held, low):
    noise = 0.004 * RNG(3).normal(size=(3, 300))
    levels = np.concatenate([1.0 + noise[0], low + noise[1], 1.0 + noise[2]])
    for part, level in zip(np.split(steady_rows(levels, held), 3), (1.0, low, 1.0), strict=True):
        np.testing.assert_allclose(part[5:-5], level, atol=0.001)
    drift = np.linspace(1.0, 1.03, 900) + noise.ravel()
    assert np.ptp(steady_rows(drift, held)) == 0.0


@pytest.mark.parametrize(("frame", "steps"), [(0.025, 2), (0.1, 0)])
def test_a_log_that_reads_seldom_has_steps_between_its_rests(frame, steps):
    time = 0.05 * np.arange(80.0)
    torque = np.repeat([0.02, 0.08, 0.03], [25, 30, 25]) + 1e-4 * RNG(2).normal(size=80)
    angles = build_recording(frame * np.arange(0.0, 3.9 / frame), time, torque, 1, ["a"])
    steady, _ = steady_log(angles)
    knots, load = (steady[name].values[0] for name in ("load_time", "load_torque"))
    at = np.flatnonzero((np.diff(knots) == 0.0) & (np.diff(load) != 0.0))
    np.testing.assert_allclose(knots[at], [1.25, 2.75][:steps])
    np.testing.assert_allclose(np.unique(load), [0.02, 0.03, 0.08], atol=1e-4)


def test_a_cell_of_one_scatter_has_it_over_the_rms_of_its_loads():
    levels = np.repeat([0.02, 0.1], 400)
    torque = levels + 1e-4 * RNG(3).normal(size=800)
    angles = build_recording(0.1 * np.arange(80.0), 0.01 * np.arange(800.0), torque, 1, ["a"])
    rms = np.sqrt(np.mean(levels**2))
    assert steady_log(angles)[1] == pytest.approx(1e-4 / rms, rel=0.1)
