import numpy as np
import pytest

from softfinger.faults import Fault, ListedFault
from softfinger.propagation.sobol import compute_sobol


@pytest.fixture
def sobol(angles, least_squares, posterior, config):
    return compute_sobol(angles, least_squares, posterior, config, np.random.default_rng(3))


def test_sizes(sobol):
    assert dict(sobol.sizes) == {
        "estimate": 2, "joint": 2, "time": 13, "parameter": 4, "pair": 6, "quantile": 3,
        "running_time": 3, "change": 2,
    }  # fmt: skip


def test_indices_are_shares_and_sum_to_one(sobol):
    for name in ("first_order", "second_order", "total", "first_order_quantile"):
        assert (sobol[name] >= -1e-15).all()
        assert (sobol[name] <= 1 + 1e-15).all()
    whole = sobol["first_order"].sum("parameter") + sobol["second_order"].sum("pair")
    np.testing.assert_allclose(whole, 1.0, rtol=1e-13)


def test_total_adds_the_only_interaction(sobol):
    rest = (sobol["total"] - sobol["first_order"]).transpose("parameter", ...)
    interaction = sobol["second_order"].sel(pair="k_v:c_v").values
    np.testing.assert_allclose(rest.sel(parameter="k_v"), interaction, atol=1e-14)
    np.testing.assert_allclose(rest.sel(parameter="c_v"), interaction, atol=1e-14)
    np.testing.assert_allclose(rest.sel(parameter=["c_p", "q_ini"]), 0.0, atol=1e-14)


def test_only_the_initial_angle_matters_at_the_start(sobol):
    start = sobol["first_order"].sel(time=0.0)
    assert (start.sel(parameter="q_ini") == 1).all()


def test_bounds_hold_the_draws_median(sobol):
    quantile = sobol["first_order_quantile"]
    assert (quantile.diff("quantile") >= 0).all()
    # the posterior was drawn about the two-stage estimate
    point = sobol["first_order"].sel(estimate="two_stage")
    inside = (point >= quantile.sel(quantile=0.05)) & (point <= quantile.sel(quantile=0.95))
    assert inside.mean() > 0.9


def test_design_says_what_the_paper_says(sobol):
    gain = sobol["spread_shrinkage"].sel(estimate="two_stage", change="halved", joint=1)
    early, late = (gain.sel(running_time=t) for t in (1.0, 30.0))
    assert late.sel(parameter="c_p") > 10 * early.sel(parameter="c_p")
    assert early.sel(parameter="k_v") > late.sel(parameter="k_v")


def test_design_agrees_with_the_indices(sobol):
    # with q_ini held, exactly its share of the variance is gone
    share = sobol["first_order"].sel(estimate="two_stage", parameter="q_ini", time=5.0)
    gain = sobol["spread_shrinkage"].sel(
        estimate="two_stage", change="removed", running_time=5.0, parameter="q_ini"
    )
    np.testing.assert_allclose(1 - (1 - gain) ** 2, share, rtol=1e-6)


def test_a_posterior_without_a_hyperparameter_is_refused(angles, least_squares, posterior, config):
    group = posterior["posterior"].to_dataset().drop_vars("sigma_log_c_p")
    posterior["posterior"] = group
    with pytest.raises(Fault, match="sigma_log_c_p"):
        compute_sobol(angles, least_squares, posterior, config, np.random.default_rng(3))


def test_a_wrong_knob_is_named(angles, least_squares, posterior, config):
    config["drawz"] = config.pop("draws")
    with pytest.raises(ListedFault, match=r"draws: .*\n.*drawz: .*got 11"):
        compute_sobol(angles, least_squares, posterior, config, np.random.default_rng(3))
