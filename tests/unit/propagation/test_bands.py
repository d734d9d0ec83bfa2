import numpy as np
import pytest
import xarray as xr

from softfinger.inference.motion import move_paper_joint
from softfinger.propagation.bands import compute_bands


@pytest.fixture
def bands(angles, least_squares, posterior, config):
    return compute_bands(angles, least_squares, posterior, config, np.random.default_rng(3))


def test_protocols_are_the_load_levels(bands):
    assert bands["protocol_of_trial"].values.tolist() == ["protocol_1"] * 5 + ["protocol_2"] * 2


def test_sizes_and_labels(bands):
    assert dict(bands.sizes) == {
        "estimate": 2, "protocol": 2, "window": 2, "joint": 2, "time": 61, "quantile": 5,
        "ci_prob": 2, "bound": 2, "trial": 7,
    }  # fmt: skip
    assert bands["joint"].values.tolist() == [1, 2]
    assert bands["coverage_bound"].dims == (
        "estimate", "protocol", "window", "joint", "ci_prob", "bound"
    )  # fmt: skip


def test_quantiles_rise_and_noise_widens(bands):
    quantile = bands["joint_angle_quantile"]
    assert (quantile.diff("quantile") > 0).all()
    width = [
        band.sel(quantile=0.95) - band.sel(quantile=0.05)
        for band in (quantile.sel(time=0.0), bands["predicted_quantile"].sel(time=0.0))
    ]
    # at rest only q_ini (0.01, 0.02 rad) and the noise (0.003 rad) spread
    expected = np.sqrt(1 + (0.003 / np.array([0.01, 0.02])) ** 2)
    np.testing.assert_allclose(
        (width[1] / width[0]).mean(["estimate", "protocol"]), expected, rtol=0.02
    )


def test_half_the_load_gives_half_the_mean_deflection(bands):
    mean = bands["joint_angle_mean"].sel(estimate="two_stage").isel(time=slice(1, None))
    start = xr.DataArray([0.02, 0.03], coords={"joint": [1, 2]})
    ratio = (mean.sel(protocol="protocol_2") - start) / (mean.sel(protocol="protocol_1") - start)
    np.testing.assert_allclose(ratio, 0.5, rtol=1e-12)


def test_recorded_summary_counts_only_good_frames(bands, angles):
    one = bands.sel(protocol="protocol_1")
    assert one["recorded_n"].sel(joint=1).values.tolist() == [5] * 61
    # frames 40 to 42 of one trial are missing: 2.67 s to 2.8 s, a gap of 4 intervals
    gap = one["recorded_n"].sel(joint=2)
    assert gap.sel(time=2.7, method="nearest") == 4
    assert gap.sel(time=2.5, method="nearest") == 5
    first = angles["joint_angle"].isel(frame=0, trial=slice(0, 5)).mean("trial")
    np.testing.assert_allclose(one["recorded_mean"].isel(time=0), first)
    last = bands.sel(protocol="protocol_2").isel(time=-1)
    assert last["recorded_n"].values.tolist() == [1, 1]
    assert np.isnan(last["recorded_sd"]).all()


def test_unknown_population_gives_nan_and_not_a_guess(angles, least_squares, posterior, config):
    least_squares["population_sd"].loc[{"joint": 2, "parameter": "c_p"}] = np.nan
    bands = compute_bands(angles, least_squares, posterior, config, np.random.default_rng(3))
    unknown = bands.sel(estimate="two_stage", joint=2)
    for name in ("joint_angle_mean", "joint_angle_quantile", "coverage", "coverage_bound", "crps"):
        assert np.isnan(unknown[name]).all()
        assert np.isfinite(bands[name].sel(estimate="posterior", joint=2)).any()


def test_a_trial_order_changes_no_score(angles, least_squares, posterior, config, bands):
    order = [2, 0, 4, 1, 3, 6, 5]
    other = compute_bands(
        angles.isel(trial=order), least_squares, posterior, config, np.random.default_rng(3)
    )
    np.testing.assert_allclose(other["crps"], bands["crps"], rtol=1e-12)


def test_same_generator_gives_the_same_bands(angles, least_squares, posterior, config, bands):
    again = compute_bands(angles, least_squares, posterior, config, np.random.default_rng(3))
    xr.testing.assert_identical(again, bands)


def test_correlated_parameters_make_the_bands_of_brute_force(
    angles, least_squares, posterior, config
):
    """Stiff joints flow less, so that the angle spreads more; every draw is the same."""
    group = posterior["posterior"].to_dataset()
    names = ("log_k_v", "log_c_v", "log_c_p", "q_ini")
    for name in names:
        group[f"mu_{name}"][:] = group[f"mu_{name}"][0, 0]
        group[f"sigma_{name}"][:] = group[f"sigma_{name}"][0, 0]
    config |= {"band_samples": 4096, "c_p_truncation_sd": None}
    alone = compute_bands(angles, least_squares, posterior, config, np.random.default_rng(3))
    block = np.eye(4)
    block[0, 2] = block[2, 0] = 0.9  # log k_v with log c_p
    block[1, 3] = block[3, 1] = 0.4  # log c_v with q_ini
    matrix = np.broadcast_to(np.kron(np.eye(2), block), (3, 17, 8, 8))
    group["parameter_correlation"] = (("chain", "draw", "own", "other_own"), matrix)
    posterior["posterior"] = group
    found = compute_bands(angles, least_squares, posterior, config, np.random.default_rng(3))

    mu, sigma = (
        np.stack([group[f"{kind}_{name}"].values[0, 0] for name in names], axis=-1)
        for kind in ("mu", "sigma")
    )
    z = np.random.default_rng(8).multivariate_normal(np.zeros(4), block, (50000, 2))
    time = found["time"].values[1::20]
    moved = move_paper_joint(mu + sigma * z, None, None, time, np.array([0.0]), np.array([0.04]))
    noise = 0.003 * np.random.default_rng(9).standard_normal(moved.shape)
    chosen = {"estimate": "posterior", "protocol": "protocol_1", "time": time}
    ours, independent = (bands.sel(chosen) for bands in (found, alone))
    np.testing.assert_allclose(ours["joint_angle_mean"], moved.mean(axis=0), rtol=0.01)
    np.testing.assert_allclose(ours["joint_angle_sd"], moved.std(axis=0), rtol=0.02)
    quantile = np.moveaxis(np.quantile(moved, ours["quantile"], axis=0), 0, -1)
    np.testing.assert_allclose(ours["joint_angle_quantile"], quantile, rtol=0.02, atol=1e-3)
    quantile = np.moveaxis(np.quantile(moved + noise, ours["quantile"], axis=0), 0, -1)
    np.testing.assert_allclose(ours["predicted_quantile"], quantile, rtol=0.02, atol=1e-3)
    ratio = (ours["joint_angle_sd"] / independent["joint_angle_sd"]).sel(joint=1).values
    assert ratio[0] < 0.95
    assert ratio[-1] > 1.05
