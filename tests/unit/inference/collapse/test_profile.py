import numpy as np
import pytest

from softfinger.inference.collapse.profile import (
    build_joint_gram,
    profile_rates,
    solve_linear_array,
)
from softfinger.inference.collapse.table import collapse_angles
from softfinger.measurement.frames import select_frames
from softfinger.measurement.memory import Memory, whiten_array
from softfinger.mechanics.three_element import compute_joint_angle_array


def test_finds_the_parameters_of_a_motion_without_noise(make_campaign, rng):
    angles, parameters, _ = make_campaign(rng, sd=1e-9)
    collapse = collapse_angles(angles, select_frames(angles))
    for joint in range(3):
        profile = profile_rates(build_joint_gram(collapse, joint), collapse.table)
        own = parameters.isel(joint=joint)
        assert profile.linear[:, 0] == pytest.approx(1 / own["k_v"].values, rel=1e-4)
        assert profile.linear[:, 1] == pytest.approx(1 / own["c_p"].values, rel=1e-3)
        assert profile.linear[:, 2] == pytest.approx(own["q_ini"].values, abs=1e-6)
        rate = (own["k_v"] / own["c_v"]).values
        assert profile.log_rate == pytest.approx(np.log(rate), abs=1e-4)


def test_no_other_rate_is_better(campaign):
    angles, _, _ = campaign
    collapse = collapse_angles(angles, select_frames(angles))
    gram = build_joint_gram(collapse, 1)
    profile = profile_rates(gram, collapse.table)
    grid = np.tile(np.linspace(*collapse.table.nodes[[0, -1]], 4001), (5, 1))
    _, rss = solve_linear_array(gram, grid, collapse.table)
    assert (profile.rss <= rss.min(axis=1) + 1e-12).all()


def test_squares_left_over_are_those_of_the_frames(campaign):
    angles, _, _ = campaign
    collapse = collapse_angles(angles, select_frames(angles))
    profile = profile_rates(build_joint_gram(collapse, 2, 0.004, 0.6), collapse.table)
    compliance, flow, start = profile.linear[3]
    load = (angles["load_time"].values[3], angles["load_torque"].values[3])
    k_v = 1 / compliance
    motion = compute_joint_angle_array(
        k_v, k_v * np.exp(-profile.log_rate[3]), 1 / flow, start, angles["time"].values[3], *load
    )
    residual = (angles["joint_angle"].values[3, 2] - motion)[:, None]
    white, _ = whiten_array(residual, np.ones(90), Memory(0.6))
    assert profile.rss[3] == pytest.approx((white**2).sum() / 0.004**2, rel=1e-6)
