"""The rivals' arithmetic, beside the long way round."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

PATH = Path(__file__).parents[3] / "benchmarks/rivals/naive_search.py"


@pytest.fixture(scope="module")
def rivals():
    spec = importlib.util.spec_from_file_location("rivals", PATH)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def campaign():
    """Four trials of 9 to 12 values, two numbers of each trial's own and one that all share."""
    rng = np.random.default_rng(2)
    sizes = (9, 12, 10, 11)
    slopes = [rng.normal(size=(n, 3)) for n in sizes]
    residual = [rng.normal(size=n) for n in sizes]
    design = np.zeros((sum(sizes), 9))
    row = 0
    for k, slope in enumerate(slopes):
        design[row : row + len(slope), 2 * k : 2 * k + 2] = slope[:, :2]
        design[row : row + len(slope), 8] = slope[:, 2]
        row += len(slope)
    return residual, slopes, design


def test_a_step_is_the_step_of_the_whole_least_squares(rivals, campaign):
    residual, slopes, design = campaign
    whole = np.linalg.lstsq(design, np.concatenate(residual), rcond=None)[0]
    own, shared = rivals._solve(residual, slopes, 2, 0.0)
    assert own.ravel() == pytest.approx(whole[:8], abs=1e-9)
    assert shared == pytest.approx(whole[8:], abs=1e-9)


def test_a_value_left_out_is_predicted_by_all_the_others(rivals, campaign):
    residual, slopes, design = campaign
    y = np.concatenate(residual)
    fitted = design @ np.linalg.lstsq(design, y, rcond=None)[0]
    fit = rivals.LeastSquares(y - fitted, rivals._leverage(residual, slopes, 2), 9)
    n, place = y.size, 13
    others = np.delete(np.arange(n), place)
    without = np.linalg.lstsq(design[others], y[others], rcond=None)[0]
    variance = np.sum((y - fitted) ** 2) / (n - 9)
    inner = np.linalg.inv(design[others].T @ design[others])
    variance *= 1.0 + design[place] @ inner @ design[place]
    error = y[place] - design[place] @ without
    expected = -0.5 * (np.log(2.0 * np.pi * variance) + error**2 / variance)
    assert fit.left_out[place] == pytest.approx(expected, abs=1e-9)


def test_bic_charges_log_n_for_every_number(rivals):
    residual = np.full(100, 2.0)
    few, many = (rivals.LeastSquares(residual, np.zeros(100), size) for size in (3, 4))
    assert many.bic - few.bic == pytest.approx(np.log(100.0))
    assert few.bic == pytest.approx(100.0 * np.log(4.0) + 3.0 * np.log(100.0))
