from types import SimpleNamespace

import numpy as np
import xarray as xr

from softfinger.mismatch.checks.lines import find_line, transform_series

TRIALS, JOINTS, FRAMES = 5, 2, 331


def build(rng, amplitude, *, everywhere=False):
    """A wave in the second joint, or in both; what a link's direction errs, both joints show."""
    interval = 0.04
    time = np.cumsum(rng.uniform(0.5, 1.5, (TRIALS, FRAMES)), axis=1) * interval
    link = rng.normal(0.0, 0.003 / np.sqrt(2), (TRIALS, JOINTS + 1, FRAMES))
    residual = np.diff(link, axis=1)
    phase = rng.uniform(0, 2 * np.pi, TRIALS)
    wave = amplitude * np.sin(2 * np.pi * 3.3 * time + phase[:, None])
    residual[:, 1] += wave
    residual[:, 0] += wave * everywhere
    residual[:, :, 40:44] = np.nan
    problem = SimpleNamespace(
        trials=SimpleNamespace(interval=interval),
        setting=SimpleNamespace(
            duration=float(np.ptp(time, axis=1).max()), stiffness=np.full(JOINTS, 0.1)
        ),
        noise=xr.Dataset(
            {
                "noise_autocorrelation": ("joint", np.zeros(JOINTS)),
                "noise_white": ("joint", np.zeros(JOINTS)),
                "noise_correlation": (("joint", "other_joint"), [[1.0, -0.5], [-0.5, 1.0]]),
            }
        ),
    )
    return problem, residual, time


def test_a_line_is_found_whatever_its_phases():
    line = find_line(*build(np.random.default_rng(1), 0.001))
    assert abs(line.frequency_hz - 3.3) < 0.1
    assert line.joint == 2
    assert line.p_value < 1e-6
    assert line.gain > 10.0


def test_a_line_in_all_joints_is_found_where_no_joint_shows_it_alone():
    problem, residual, time = build(np.random.default_rng(1), 0.0006, everywhere=True)
    line = find_line(problem, residual, time)
    assert abs(line.frequency_hz - 3.3) < 0.1
    assert line.joint == 0
    assert line.p_value < 1e-6
    assert line.gain > 10.0
    residual[:, 0] = np.nan
    assert find_line(problem, residual, time).gain < 4.6


def test_noise_holds_no_line():
    lines = [find_line(*build(np.random.default_rng(seed), 0.0)) for seed in range(12)]
    assert max(line.gain for line in lines) < 4.6
    p_values = [line.p_value for line in lines]
    assert min(p_values) > 1e-3
    assert max(p_values) > 0.3


def test_few_exponentials_make_all_waves():
    rng = np.random.default_rng(3)
    values, time = rng.normal(size=(2, 57))
    for count in (1, 7, 30):
        frequency = np.linspace(0.3, 4.0, count)
        expected = np.exp(-2j * np.pi * np.outer(frequency, time)) @ values
        np.testing.assert_allclose(transform_series(values, time, frequency), expected, atol=1e-9)
