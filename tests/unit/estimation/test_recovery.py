"""What the fits do to a known truth: by hand, on the model's own campaign, and as an artifact."""

import numpy as np
import pytest
import xarray as xr

from softfinger.artifacts import open_artifact, save_artifact
from softfinger.artifacts.specs import recovery as recovery_spec
from softfinger.estimation import fit_least_squares
from softfinger.estimation.recovery import measure_recovery, tabulate_recovery
from softfinger.provenance import Provenance

RULE = {"outlier_rule": "scaled_mad", "outlier_cutoff": 3.0}
NATURAL = ["k_v", "c_v", "c_p", "q_ini"]
MEAN = np.array([[-2.4, -3.6, 2.8, 0.02], [-2.3, -3.5, 3.1, 0.03]])  # of conftest's campaign
SD = np.array([[0.2, 0.4, 0.5, 0.01], [0.3, 0.5, 0.6, 0.02]])
LOGS = ["log_k_v", "log_c_v", "log_c_p", "q_ini"]


def build_exact(trials: int = 9):
    """Truth, estimates that err by 1 %, and a posterior of two draws, at −0.1 and 0.2 of it."""
    joint = {"joint": [1, 2]}
    z = np.linspace(-1, 1, trials)
    eta = np.stack([np.outer(z, [0.5, 1.0]) + mu for mu in (1.0, 2.0, 3.0, 4.0)], -1)
    own = np.concatenate([np.exp(eta[..., :3]), eta[..., 3:]], axis=-1)
    population = (("joint", "parameter"), np.full((2, 4), 2.0))
    coords = joint | {"trial": [f"t{i}" for i in range(trials)], "parameter": NATURAL}
    truth = xr.Dataset({"population_mean": population, "population_sd": population}, coords)
    for k, name in enumerate(NATURAL):
        truth[name] = (("trial", "joint"), own[..., k])
    dims = ("trial", "joint", "parameter")
    least_squares = xr.Dataset(
        {
            "estimate": (dims, 1.01 * own),
            "estimate_sd": (dims, 0.01 * own),
            "kept": (dims, np.arange(trials)[:, None, None] > np.zeros((2, 4))),
            "population_mean": (population[0], np.full((2, 4), 2.5)),
            "population_sd": (population[0], np.full((2, 4), 1.0)),
        },
        coords,
    )
    shift = np.array([-0.1, 0.2])[None, :, None]
    posterior = xr.Dataset(coords=joint | {"trial": coords["trial"]})
    for k, name in enumerate(LOGS):
        known = np.broadcast_to(eta[..., k], (1, 2, *eta.shape[:2]))
        posterior[name] = (("chain", "draw", "trial", "joint"), known)
        for level in ("mu", "sigma"):
            posterior[f"{level}_{name}"] = (("chain", "draw", "joint"), 2.0 + shift + np.zeros(2))
    return truth, least_squares, posterior


def test_errors_and_coverage_by_hand():
    found = measure_recovery(*build_exact())
    two_stage, posterior = (found.sel(estimate=name) for name in ("two_stage", "posterior"))
    np.testing.assert_allclose(two_stage["trial_n"], 8)  # the first trial was dropped
    np.testing.assert_allclose(two_stage["trial_error"], 0.01)
    # off by one sd: within ±1.64 sd and not within ±0.67 sd
    np.testing.assert_array_equal(two_stage["trial_coverage"].sel(ci_prob=0.9), 1)
    np.testing.assert_array_equal(two_stage["trial_coverage"].sel(ci_prob=0.5), 0)
    np.testing.assert_array_equal(posterior["trial_error"], 0)
    mu, sigma = (two_stage.sel(statistic=name) for name in ("mu", "sigma"))
    np.testing.assert_allclose(mu["error_in_sd"], 0.5 * np.sqrt(8))
    np.testing.assert_allclose(sigma["error_in_sd"], -np.sqrt(14))
    np.testing.assert_allclose(posterior["error_in_sd"], 0.05 / 0.15)
    relative = two_stage["relative_error"].sel(reference="population")
    np.testing.assert_allclose(relative.sel(statistic="mu", parameter="c_p"), np.expm1(0.5))
    np.testing.assert_allclose(relative.sel(statistic="mu", parameter="q_ini"), 0.25)
    np.testing.assert_allclose(relative.sel(statistic="sigma"), -0.5)
    drawn = found["true_value"].sel(reference="trials", parameter="c_v")
    np.testing.assert_allclose(drawn.sel(statistic="mu"), 2.0)
    spread = np.linspace(-1, 1, 9).std(ddof=1)
    np.testing.assert_allclose(drawn.sel(statistic="sigma"), [0.5 * spread, spread])


def test_intervals_of_the_population_by_hand():
    truth, least_squares, posterior = build_exact()
    inside = measure_recovery(truth, least_squares, posterior)["inside"]
    # ± 0.7111/√8 and ± 1.8946/√8 of Student's t with 7 degrees around 2.5; χ² up to 1.8 of 1.0
    two_stage = inside.sel(estimate="two_stage", statistic="mu")
    np.testing.assert_array_equal(two_stage.sel(ci_prob=0.9), 1)
    np.testing.assert_array_equal(two_stage.sel(ci_prob=0.5), 0)
    assert not inside.sel(estimate="two_stage", statistic="sigma").any()
    assert inside.sel(estimate="posterior").all()


def test_nothing_kept_is_no_estimate_rather_than_a_failure():
    truth, least_squares, posterior = build_exact()
    none = least_squares.assign(kept=least_squares["kept"] & False)
    none[["population_mean", "population_sd"]] *= np.nan
    found = measure_recovery(truth, none, posterior).sel(estimate="two_stage")
    for name in ("value", "error_in_sd", "relative_error", "inside", "trial_coverage"):
        assert np.isnan(found[name]).all()
    assert not found["trial_n"].any()


def test_trials_set_aside_and_the_order_of_trials_do_not_matter():
    truth, least_squares, posterior = build_exact()
    some = [f"t{i}" for i in (6, 2, 4, 5, 1)]
    one = measure_recovery(truth, least_squares.sel(trial=some), posterior.sel(trial=some))
    two = measure_recovery(
        truth.sel(trial=sorted(some)), least_squares, posterior.sel(trial=sorted(some))
    )
    xr.testing.assert_allclose(one, two)


@pytest.fixture(scope="module")
def recovered(known_campaign, tree):
    angles, own = known_campaign
    dims = ("joint", "parameter")
    population = {"population_mean": (dims, MEAN), "population_sd": (dims, SD)}
    truth = own.assign(population).assign_coords(parameter=NATURAL)
    posterior = tree["posterior"].to_dataset()
    return measure_recovery(truth, fit_least_squares(angles, RULE), posterior)


def test_the_model_s_own_campaign_is_recovered(recovered):
    covered = recovered["trial_coverage"].sel(estimate="posterior").mean(("joint", "parameter"))
    assert covered.sel(ci_prob=0.9) > 0.7  # of 56 trials' parameters
    error = recovered["error_in_sd"].sel(estimate="posterior", statistic="mu")
    assert np.sqrt((error**2).mean()) < 2


def test_the_artifact_is_declared_and_tabulated(recovered, tmp_path):
    path = tmp_path / "recovery.nc"
    origin = Provenance("recovery", {}, "cd", "ef", "01", 3)
    save_artifact(recovered, recovery_spec.SPEC, path, origin)
    table = tabulate_recovery(open_artifact(path, recovery_spec.SPEC))
    assert len(table) == 2 * 4 * 2
    row = table.query("joint == 2 and parameter == 'c_p' and estimate == 'posterior'")
    at = {"joint": 2, "parameter": "c_p", "estimate": "posterior"}
    here = recovered.sel(at | {"statistic": "sigma"})
    assert row["sigma_error_in_sd"].item() == pytest.approx(float(here["error_in_sd"]))
    assert row["trials_in_90%"].item() == pytest.approx(
        float(here["trial_coverage"].sel(ci_prob=0.9))
    )
