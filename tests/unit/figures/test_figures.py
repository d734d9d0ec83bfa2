"""Each figure: the right panels, units on the axes, and the artifact's own numbers in the lines."""

import numpy as np
import pytest
import xarray as xr
from example_artifacts import make_angles, make_bands, make_densities, make_shapley, make_sobol

from softfinger.figures.bands import MOST_PROTOCOLS, choose_protocols, draw_bands
from softfinger.figures.hyperparameters import draw_hyperparameters
from softfinger.figures.population import draw_initial_angles, draw_parameter_histograms
from softfinger.figures.prior import draw_prior_predictive
from softfinger.figures.propagation import draw_densities, draw_shapley, draw_sobol
from softfinger.figures.recordings import draw_recordings
from softfinger.figures.residuals import draw_residuals
from softfinger.figures.sampling import draw_sampling
from softfinger.figures.sketches import draw_finger_sketch, draw_joint_model_sketch
from softfinger.figures.style import render_figure
from softfinger.figures.tracking import draw_tracking
from softfinger.summary.histograms import compute_histograms

JOINTS = [1, 2, 5]
SOURCE = {"source": "measured"}


def titles(figure):
    return [ax.get_title(loc="left") for ax in figure.axes if ax.get_title(loc="left")]


def find_line(ax, label):
    return next(line for line in ax.get_lines() if line.get_label() == label)


@pytest.mark.parametrize("n_joint", JOINTS)
def test_recordings_hold_every_trial_at_every_joint(n_joint):
    angles = make_angles(n_trial=4, n_joint=n_joint)
    figure = draw_recordings(angles)
    assert titles(figure) == [f"joint {j}" for j in angles["joint"].values]
    top = figure.axes[0]
    lines = top.collections[0]
    assert top.get_ylabel() == "joint angle [rad]"
    assert len(lines.get_segments()) == 4
    assert lines.get_rasterized()
    assert figure.axes[n_joint].get_ylabel() == "load [N m]"


def test_recordings_of_several_commands_get_a_scale():
    figure = draw_recordings(make_angles(load_kind="command", load_scale=2500))
    assert figure.axes[-1].get_ylabel() == "largest load [command]"


def test_a_load_starts_from_rest_and_holds_to_the_end():
    angles = make_angles(n_trial=1, n_joint=1)
    angles["load_time"] = angles["load_time"] / 3 + 5.0
    path = draw_recordings(angles).axes[1].collections[0].get_segments()[0]
    assert path[0].tolist() == [0.0, 0.0]
    assert path[1].tolist() == [5.0, 0.0]
    assert path[-1].tolist() == [30.0, 0.04]


def draw_last(markers, place):
    return draw_tracking(markers.isel(trial=place), markers.sizes["frame"] - 1)


def test_tracking_marks_flagged_markers_and_points_y_downwards(artifacts):
    markers = artifacts["markers"].copy(deep=True)
    markers["marker_flag"][0, -1, 2] = 4
    ax = draw_last(markers, 0).axes[0]
    crosses = [line for line in ax.get_lines() if line.get_marker() == "x"]
    place = markers["marker_position"].values[0, -1, 2]
    assert [tuple(line.get_xydata()[0]) for line in crosses if len(line.get_xydata())] == [
        tuple(place)
    ]
    low, high = ax.get_ylim()
    assert low > high


def test_tracking_shows_the_picture_of_the_frame_it_is_of(artifacts):
    picture = xr.DataArray(np.arange(12.0).reshape(3, 4), dims=("row", "column"))
    ax = draw_tracking(artifacts["markers"].isel(trial=1), 7, picture).axes[0]
    assert ax.get_images()[0].get_array().shape == (3, 4)
    ring = next(line for line in ax.get_lines() if line.get_label() == "base")
    expected = artifacts["markers"]["marker_position"].values[1, 7, 0]
    assert ring.get_xydata()[0].tolist() == expected.tolist()


@pytest.fixture
def residuals():
    frequency = np.linspace(0.5, 15, 60)
    power = 1e-5 * np.exp(-(((frequency - 3.4) / 0.3) ** 2))
    dims = ("change", "joint")
    return xr.Dataset(
        {
            "mean_residual": ((*dims, "since_change"), np.full((2, 1, 40), 0.002)),
            "residual_se": ((*dims, "since_change"), np.full((2, 1, 40), 0.0005)),
            "residual_power": ((*dims, "frequency"), np.broadcast_to(power, (2, 1, 60))),
            "peak_frequency": (dims, [[3.41], [np.nan]]),
        },
        coords={
            "change": ["rise", "fall"],
            "joint": [1],
            "since_change": np.arange(40) * 0.03,
            "frequency": frequency,
        },
        attrs=SOURCE,
    )


def test_residuals_are_drawn_in_mrad_and_a_ring_is_named(residuals):
    left, early, right = draw_residuals(residuals).axes
    assert find_line(early, "after the load rose").get_xdata().max() <= 1.0
    assert left.get_ylabel() == "recording − model [mrad]"
    np.testing.assert_allclose(find_line(left, "after the load rose").get_ydata(), 2.0)
    assert [text.get_text() for text in right.texts] == ["3.4 Hz"]


def count_protocols(bands):
    return bands.assign(protocol_trials=("protocol", np.full(bands.sizes["protocol"], 5)))


@pytest.mark.parametrize("n_joint", JOINTS)
def test_bands_draw_the_posteriors_median(n_joint):
    bands = count_protocols(make_bands(make_angles(n_joint=n_joint)).assign_attrs(SOURCE))
    figure = draw_bands(bands)
    assert len(titles(figure)) == n_joint
    drawn = find_line(figure.axes[0], "posterior")
    expected = bands["predicted_quantile"].sel(estimate="posterior", quantile=0.5)[0, 0]
    np.testing.assert_allclose(drawn.get_ydata(), expected)


def test_bands_of_the_first_second_end_there(artifacts):
    figure = draw_bands(count_protocols(artifacts["bands"]), 1.0)
    drawn = find_line(figure.axes[0], "recorded").get_xdata()
    assert drawn.size > 3
    assert drawn.max() <= 1.0


def test_the_protocols_of_most_trials_are_shown():
    count = 3 + 2 * MOST_PROTOCOLS
    bands = xr.Dataset(
        {"protocol_trials": ("protocol", np.arange(count))},
        coords={"protocol": [f"p{i}" for i in range(count)]},
    )
    shown = choose_protocols(bands)
    assert shown.tolist() == [f"p{i}" for i in range(count - MOST_PROTOCOLS, count)]


def test_histograms_are_densities_of_the_kept_trials(find):
    figure = draw_parameter_histograms(find("histograms"), "N m")
    assert [ax.get_xlabel() for ax in figure.axes[::3]] == [
        "$k_v$ [N m/rad]",
        "$c_v$ [N m s/rad]",
        "$c_p$ [N m s/rad]",
    ]
    for ax in figure.axes:
        bars = next(c for c in ax.containers if c.get_label() == "trials kept")
        left = np.array([bar.get_x() for bar in bars])
        right = left + np.array([bar.get_width() for bar in bars])
        area = (np.array([bar.get_height() for bar in bars]) * np.log(right / left)).sum()
        assert area == pytest.approx(1.0, abs=0.21)  # a trial beyond the axis may be missing


def test_dropped_estimates_are_drawn_apart_and_negative_ones_survive(artifacts):
    population = artifacts["least_squares"].copy(deep=True)
    population["estimate"][2, 0, 1] = -1.0
    population["kept"][2, 0, 1] = False
    drawn = compute_histograms(population, None).assign_attrs(SOURCE)
    figure = draw_parameter_histograms(drawn, "command")
    labels = [c.get_label() for c in figure.axes[6].containers]  # c_p at joint 1
    assert labels == ["trials kept", "dropped"]
    assert render_figure(figure).startswith(b"<?xml")


def test_initial_angles_are_on_a_straight_axis(find):
    figure = draw_initial_angles(find("histograms"))
    assert {ax.get_xscale() for ax in figure.axes} == {"linear"}
    assert figure.axes[0].get_xlabel().endswith("[rad]")


def test_hyperparameters_stand_where_the_summary_says():
    values = np.arange(5 * 2 * 4 * 3, dtype=float).reshape(5, 2, 4, 3)
    summary = xr.Dataset(
        {
            "quantile_value": (("quantile", "statistic", "parameter", "joint"), values),
            "rival_value": (("rival", "statistic", "parameter", "joint"), values[2:3] + 1),
        },
        coords={
            "rival": ["two_stage"],
            "quantile": [0.05, 0.25, 0.5, 0.75, 0.95],
            "statistic": ["mu", "sigma"],
            "parameter": ["k_v", "c_v", "c_p", "q_ini"],
            "joint": [1, 2, 3],
        },
        attrs=SOURCE,
    )
    figure = draw_hyperparameters(summary)
    spread_of_c_p = figure.axes[6]
    assert spread_of_c_p.get_xlabel() == "spread of ln $c_p$"
    drawn = find_line(spread_of_c_p, "posterior").get_xdata()
    np.testing.assert_allclose(drawn, summary["quantile_value"].values[2, 1, 2])
    rival = find_line(spread_of_c_p, "two-stage").get_xdata()
    np.testing.assert_allclose(rival, drawn + 1)


@pytest.mark.parametrize("n_joint", JOINTS)
def test_prior_predictive_has_a_band_per_pair_of_quantiles(n_joint):
    time = np.linspace(0, 30, 6)
    quantile = [0.05, 0.25, 0.5, 0.75, 0.95]
    values = np.broadcast_to(np.array([-2, -1, 0, 1, 2.0])[:, None, None], (5, n_joint, 6))
    prior = xr.Dataset(
        {
            "joint_angle_quantile": (("quantile", "joint", "time"), values),
            "recorded_low": (("joint", "time"), np.full((n_joint, 6), 0.1)),
            "recorded_high": (("joint", "time"), np.full((n_joint, 6), 0.3)),
        },
        coords={"quantile": quantile, "joint": np.arange(1, n_joint + 1), "time": time},
        attrs=SOURCE,
    )
    figure = draw_prior_predictive(prior)
    labels = [band.get_label() for band in figure.axes[0].collections]
    assert labels == ["prior, 90 %", "prior, 50 %", "recorded"]
    assert len(figure.axes) == n_joint


@pytest.mark.parametrize("n_joint", JOINTS)
def test_sobol_draws_shares_of_all_time_and_of_the_first_second(n_joint):
    joints = make_angles(n_joint=n_joint)["joint"]
    sobol = make_sobol(joints).sel(estimate="posterior").assign_attrs(SOURCE)
    sobol = sobol.assign(first_order=sobol["first_order_quantile"])
    figure = draw_sobol(sobol)
    whole = find_line(figure.axes[0], "$k_v$")
    expected = sobol["first_order_quantile"].sel(joint=1, parameter="k_v", quantile=0.5)
    np.testing.assert_allclose(whole.get_ydata(), expected)
    ends = {find_line(ax, "$k_v$").get_xdata().max() for ax in figure.axes}
    assert ends == {30.0, 1.0}


@pytest.mark.parametrize("n_joint", JOINTS)
def test_shapley_effects_are_lines_within_their_bands(n_joint):
    shapley = make_shapley(make_angles(n_joint=n_joint)["joint"]).assign_attrs(SOURCE)
    figure = draw_shapley(shapley)
    assert len(figure.axes) == n_joint
    line = find_line(figure.axes[-1], "$c_p$")
    expected = shapley["shapley_quantile"].sel(joint=n_joint, parameter="c_p", quantile=0.5)
    np.testing.assert_allclose(line.get_ydata(), expected)


def test_densities_are_ridges_at_their_own_angles_scaled_to_their_peaks(artifacts):
    densities = make_densities(artifacts["angles"]["joint"]).sel(estimate="posterior")
    first, ax, _ = draw_densities(densities.assign_attrs(SOURCE)).axes
    labels = [label.get_text() for label in first.get_yticklabels()]
    assert labels == ["0.1 s", "1 s", "10 s", "30 s"]
    place = labels.index("10 s")
    line = ax.get_lines()[place]
    here = densities.sel(joint=2, time=10.0)
    np.testing.assert_allclose(line.get_xdata(), here["joint_angle"])
    height = line.get_ydata() + place
    np.testing.assert_allclose(height / height.max(), here["density"] / here["density"].max())


def test_sampling_draws_sorted_values_and_both_limits():
    sampling = xr.Dataset(
        {
            "r_hat": ("quantity", [1.02, 1.0, 1.005]),
            "ess_bulk": ("quantity", [300.0, 900.0, 700.0]),
            "ess_tail": ("quantity", [350.0, 800.0, 600.0]),
        },
        attrs={**SOURCE, "r_hat_max": 1.01, "ess_min": 400.0},
    )
    draws = (("chain", "draw"), np.random.default_rng(0).normal(size=(2, 30)))
    worst = xr.Dataset({"worst_draws": draws, "running_mean": draws})
    left, middle, right = draw_sampling(sampling, worst).axes
    np.testing.assert_array_equal(right.get_lines()[0].get_ydata(), draws[1][0])
    assert left.get_lines()[0].get_ydata().tolist() == [1.0, 1.005, 1.02]
    assert left.get_lines()[1].get_ydata() == [1.01, 1.01]
    assert middle.get_lines()[2].get_ydata() == [400.0, 400.0]


@pytest.mark.parametrize("n_joint", JOINTS)
def test_the_sketch_names_every_joint(n_joint):
    words = [text.get_text() for text in draw_finger_sketch(n_joint).axes[0].texts]
    assert [f"$q_{{{joint}}}$" for joint in range(1, n_joint + 1)] == [
        word for word in words if word.startswith("$q_")
    ]


def test_a_finger_without_wires_has_none_in_its_sketch():
    words = {text.get_text() for text in draw_finger_sketch(2, wires=False).axes[0].texts}
    assert "slack wire" not in words
    assert "slack wire" in {text.get_text() for text in draw_finger_sketch(2).axes[0].texts}


def test_masked_jumps_leave_gaps_in_the_recordings():
    angles = make_angles(n_trial=2, n_joint=1)
    angles["joint_angle"][0, 0, 9] = -1.1
    angles["angle_flag"][0, 0, 9] = 4
    assert draw_recordings(angles).axes[0].get_ylim()[0] > -0.5


def test_the_joint_sketch_names_spring_and_dashpots():
    words = {text.get_text() for text in draw_joint_model_sketch().axes[0].texts}
    assert {"$k_v$", "$c_v$", "$c_p$", "τ"} <= words
