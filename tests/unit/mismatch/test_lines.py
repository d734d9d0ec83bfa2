from types import SimpleNamespace

import numpy as np
import xarray as xr

from softfinger.mismatch.lines import find_line, transform_series

TRIALS, JOINTS, FRAMES = 5, 2, 331


def build(rng, amplitude):
    interval = 0.04
    time = np.cumsum(rng.uniform(0.5, 1.5, (TRIALS, FRAMES)), axis=1) * interval
    residual = rng.normal(0.0, 0.003, (TRIALS, JOINTS, FRAMES))
    phase = rng.uniform(0, 2 * np.pi, TRIALS)
    residual[:, 1] += amplitude * np.sin(2 * np.pi * 3.3 * time + phase[:, None])
    residual[:, :, 40:44] = np.nan
    problem = SimpleNamespace(
        trials=SimpleNamespace(interval=interval),
        setting=SimpleNamespace(duration=float(np.ptp(time, axis=1).max())),
        noise=xr.Dataset({"noise_autocorrelation": ("joint", np.zeros(JOINTS))}),
    )
    return problem, residual, time


def test_a_line_is_found_whatever_its_phases():
    line = find_line(*build(np.random.default_rng(1), 0.001))
    assert abs(line.frequency_hz - 3.3) < 0.1
    assert line.joint == 2
    assert line.p_value < 1e-6
    assert line.gain > 10.0


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
