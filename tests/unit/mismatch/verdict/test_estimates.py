"""An effect's figures as a verdict gives them."""

import numpy as np
import pytest

from softfinger.mechanics.effects.effect import Parameter
from softfinger.mechanics.effects.model import Entry
from softfinger.mismatch.verdict.estimates import estimate_entry
from softfinger.mismatch.verdict.refine import estimate_draws


def _tilt(report):
    return Entry(0, Parameter("tilt_across_rad", sd=0.2, low=-1.6, report=report), ())


TILT = {"tilt_rad": lambda x, _: abs(x), "tilt_across_rad": lambda x, _: x}


def test_a_number_is_given_under_every_name_that_reports_it():
    found = estimate_entry(_tilt(TILT), -0.15, 0.01)
    assert set(found) == {"tilt_rad", "tilt_across_rad"}
    assert found["tilt_rad"].mean == pytest.approx(0.15)
    assert found["tilt_rad"].q05 == pytest.approx(0.15 - 1.645 * 0.01, abs=1e-4)
    assert found["tilt_across_rad"].q05 == pytest.approx(-0.15 - 1.645 * 0.01, abs=1e-4)
    assert found["tilt_across_rad"].sd == pytest.approx(0.01, rel=0.01)


def test_the_interval_of_a_size_whose_sign_is_open_begins_near_nothing():
    found = estimate_entry(_tilt(TILT), 0.0, 0.1)["tilt_rad"]
    assert found.q05 == pytest.approx(0.1 * 0.0627, rel=0.05)  # of |x|: the quantile 0.525 of x
    assert found.q95 == pytest.approx(0.1 * 1.96, rel=0.01)


def test_draws_are_given_under_the_same_names():
    draws = np.random.default_rng(0).normal(-0.15, 0.01, 4000)
    found = estimate_draws(_tilt(TILT), draws)
    expected = estimate_entry(_tilt(TILT), -0.15, 0.01)
    assert set(found) == set(expected)
    for name, estimate in found.items():
        assert estimate.q05 == pytest.approx(expected[name].q05, abs=1e-3)


def test_what_is_not_reported_otherwise_goes_by_its_own_name():
    entry = Entry(0, Parameter("lag_s", log=True), (1,))
    ((name, estimate),) = estimate_entry(entry, np.log(2.0), 0.1).items()
    assert name == "lag_s_2"
    assert estimate.q95 == pytest.approx(2.0 * np.exp(1.645 * 0.1), rel=1e-3)
    assert set(estimate_draws(entry, np.log([2.0, 3.0]))) == {"lag_s_2"}
