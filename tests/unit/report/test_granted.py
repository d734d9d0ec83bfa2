import numpy as np
import pytest
import xarray as xr
from example_artifacts import gather

from softfinger.report.granted import show_independence, show_loo_pit, show_prior_sensitivity
from softfinger.report.page import render_report

OWN = ["log_k_v[1]", "log_c_v[1]", "q_ini[1]", "log_k_v[2]", "log_c_v[2]", "q_ini[2]", "q_ini[3]"]


@pytest.fixture
def asked(artifacts):
    p = np.ones((7, 7))
    p[4, 1] = p[1, 4] = 0.001
    independence = {
        "mean_product": (("own", "other_own"), np.full((7, 7), 0.25)),
        "p_value": (("own", "other_own"), p),
        "smallest_p": ((), 0.021),
    }
    prior = np.full((2, 4, 3), 0.01)
    likelihood = np.full((2, 4, 3), 0.4)
    prior[1, 2] = [0.3, 0.2, 0.06]
    likelihood[1, 2, :2] = 0.02
    dims = ("level", "parameter", "joint")
    coords = {
        "level": ["mu", "sigma"],
        "parameter": ["log_k_v", "log_c_v", "log_c_p", "q_ini"],
        "joint": [1, 2, 3],
    }
    tree = artifacts["posterior"].copy()
    tree["independence"] = xr.Dataset(independence, {"own": OWN, "other_own": OWN})
    sensitivity = {"prior": (dims, prior), "likelihood": (dims, likelihood)}
    sensitivity |= {
        "effect_prior": ("effect_parameter", [0.3]),
        "effect_likelihood": ("effect_parameter", [0.01]),
    }
    coords["effect_parameter"] = ["moment_arm.arm_scale"]
    tree["prior_sensitivity"] = xr.Dataset(sensitivity, coords)
    pit = {
        "pit": (("trial", "joint", "moment"), np.full((5, 3, 4), 0.3)),
        "pit_time": (("trial", "moment"), np.tile([0.1, 1.0, 10.0, 30.0], (5, 1))),
        "p_value": (("joint", "moment"), np.linspace(0.01, 1, 12).reshape(3, 4)),
        "smallest_p": ((), 0.12),
    }
    tree["loo_pit"] = xr.Dataset(pit, {"trial": list("abcde"), "joint": [1, 2, 3]})
    return gather(artifacts | {"posterior": tree})


def test_the_worst_pair_stands_first(asked):
    sentence, table = show_independence(asked)
    assert "recordings contradict this: the smallest p of the 21 pairs" in sentence.text
    assert sentence.tone == "note"
    assert len(table.rows) == 20
    assert [cell.text for cell in table.rows[0][:2]] == ["c_v, joint 1", "c_v, joint 2"]


def test_sensitive_spreads_are_counted_and_read(asked):
    sentence, table = show_prior_sensitivity(asked)
    assert "may disagree on 1, and 3 depend on their prior" in sentence.text
    readings = {tuple(cell.text for cell in row[:3]): row[-1].text for row in table.rows}
    assert readings["spread", "c_p", "1"] == "the recordings determine little"
    assert readings["spread", "c_p", "3"] == "prior and recordings may disagree"
    assert readings["centre", "c_p", "3"] == "–"
    assert readings["effect", "moment_arm.arm_scale", "–"] == "the recordings determine little"


def test_the_place_of_trials_among_the_others_predictions_is_told(asked):
    sentence, table = show_loo_pit(asked)
    assert "are spread as evenly as they should: the smallest p of 12 tests" in sentence.text
    assert [cell.text for cell in table.rows[5]] == ["2", "1", "0.3", "0.46"]


def test_a_fit_without_these_groups_shows_no_table(asked, page):
    shown = render_report(asked)
    for title in (
        "Whether parameters are correlated",
        "How far the parameters depend on their priors",
        "Where trials lie in what the others predict",
    ):
        assert title in shown
        assert title not in page


def test_fitted_correlations_take_the_place_of_the_question(asked):
    tree = asked.artifacts["posterior"].copy()
    posterior = tree["posterior"].dataset
    rng = np.random.default_rng(1)
    shape = (posterior.sizes["chain"], posterior.sizes["draw"])
    matrix = np.zeros((*shape, 7, 7)) + np.eye(7)
    for a, b, centre in ((0, 1, 0.1), (2, 1, -0.8)):
        matrix[..., a, b] = matrix[..., b, a] = centre + 0.1 * rng.standard_normal(shape)
    variable = (("chain", "draw", "own", "other_own"), matrix)
    tree["posterior"] = posterior.assign(parameter_correlation=variable).assign_coords(
        own=OWN, other_own=OWN
    )
    material = gather(asked.artifacts | {"posterior": tree})
    sentence, table = show_independence(material)
    assert "lets 2 pairs of a trial's parameters be correlated" in sentence.text
    assert ", 1 are shown" in sentence.text
    assert [cell.text for cell in table.rows[0][:2]] == ["c_v, joint 1", "q_ini, joint 1"]
    assert len(table.rows) == 2
