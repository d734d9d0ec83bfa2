"""What to record next: a protocol within the rig's limits that shows what is open."""

import numpy as np
import pytest
import xarray as xr

from softfinger.mismatch.experiment.proposal import list_open_questions, propose_experiment
from softfinger.mismatch.experiment.protocols import choose_protocol


def make_table(**gains):
    names = list(gains)
    return xr.Dataset(
        {
            "expected_gain": ("effect", list(gains.values())),
            "likeness": (("effect", "other_effect"), np.eye(len(names))),
        },
        coords={"effect": names, "other_effect": names},
    )


def test_the_protocol_that_shows_most_effects_wins_and_then_the_faintest_counts():
    tables = {
        "step": make_table(gravity=5000.0),
        "stairs": make_table(gravity=40.0, wire_friction=30.0),
        "triangle": make_table(gravity=60.0, wire_friction=50.0),
    }
    name, gain = choose_protocol(tables, ["gravity", "wire_friction"], 15.0)
    assert name == "triangle"
    assert (gain.values > 40.0).all()


def test_nothing_is_proposed_where_nothing_would_show():
    assert choose_protocol({"step": make_table(gravity=3.0)}, ["gravity"], 15.0) is None
    assert choose_protocol({"step": make_table(gravity=99.0)}, ["wire_friction"], 15.0) is None


@pytest.fixture(scope="module")
def told(draw_campaign):
    """The campaign of `clean`, its loads logged as torques."""
    return draw_campaign(2, 0.0).assign(load_kind=("trial", np.full(7, "torque_nm")))


def test_a_proposal_keeps_within_what_was_recorded(clean, told):
    hidden = ["gravity", "yield_threshold"]  # gravity: link masses are not declared, so never
    unsure = clean._replace(verdict=clean.verdict.model_copy(update={"not_testable": hidden}))
    wanted = list_open_questions(unsure)
    assert wanted == hidden
    found = propose_experiment(unsure, told)
    assert found["load_column"] == "torque_nm"
    assert "yield_threshold" in found["tells_apart"]
    assert set(found["tells_apart"]) <= set(wanted)
    for load in found["loads"]:
        assert 0 < max(load["load"]) <= 0.04 + 1e-12
        assert 0 < load["time_s"][-1] <= float(told["time"].max()) + 1e-9
        assert (np.diff(load["time_s"]) >= 0).all()


def test_where_nothing_is_open_nothing_is_proposed(clean, told):
    settled = clean.verdict.model_copy(update={"not_testable": []})
    assert propose_experiment(clean._replace(verdict=settled), told) is None
