import numpy as np
import pytest

from softfinger.artifacts import list_faults
from softfinger.artifacts.specs.angles import SPEC
from softfinger.campaign import read_campaign
from softfinger.faults import CampaignFault
from softfinger.measurement.flags import JUMP, MISSING, STALE
from softfinger.tracking import assemble_angles, track_trials

DESCRIPTION = """\
version: 1
name: two joints on every level
source: measured
finger:
  joints: 2
  link_length_m: [0.030, 0.028]
  link_mass_kg: [0.005, 0.004]
  wire_offset_m: 0.005
camera:
  fps: 30.0
  metres_per_pixel: 0.0005
  markers:
    base: [-0.022, -0.009]
    link_1: [0.007, 0.022]
    link_2: [0.006, 0.014, 0.023]
  marker_diameter_m: 0.004
  marker_colour: dark
noise_sd_rad: 0.003
"""
TABLE = """\
trial,started_at,video,markers,angles,load,temperature_c
filmed,2026-03-01T10:00:00,video/filmed.avi,,,load.csv,22.5
pixels,2026-03-01T10:02:00,,markers.csv,,load.csv,23
angles,,,,angles.csv,load.csv,
cut,2026-03-01T10:06:00,video/cut.avi,,,load.csv,24
nowhere,2026-03-01T10:08:00,,,none.csv,load.csv,24
"""
FRAMES = 40
TIME = np.arange(FRAMES) / 30.0
BEND = 0.6 * (1.0 - np.exp(-TIME / 0.3))
NAMES = ["base_1", "base_2", "link_1_1", "link_1_2", "link_2_1", "link_2_2", "link_2_3"]


def write_table(path, heading, rows):
    path.write_text("\n".join([heading, *(",".join(map(str, row)) for row in rows)]) + "\n")


@pytest.fixture
def folder(rig):
    """A campaign with a trial of each level, a film that is cut off, a file that is not there."""
    folder = rig.folder
    (folder / "video").mkdir()
    (folder / "campaign.yaml").write_text(DESCRIPTION)
    (folder / "trials.csv").write_text(TABLE)
    write_table(folder / "load.csv", "time_s,tension_n", [(0, 8), (2, 8)])
    truth = [rig.place((b, 0.7 * b)) for b in BEND]
    rig.film([rig.draw(places) for places in truth[:30]], "video/filmed.avi")
    cut = rig.film([rig.draw(places) for places in truth[:9]], "video/cut.avi")
    cut.write_bytes(cut.read_bytes()[: cut.stat().st_size // 2])
    rows = [
        (t, name, *place + 0.02 * rig.rng.standard_normal(2), 0.02)
        for t, places in zip(TIME, truth, strict=True)
        for name, place in zip(NAMES, places, strict=True)
    ]
    write_table(folder / "markers.csv", "time_s,marker,x_px,y_px,sd_px", rows)
    noisy = np.stack([BEND, 0.7 * BEND]) + 0.002 * rig.rng.standard_normal((2, FRAMES))
    noisy[:, 20] = noisy[:, 19]
    noisy[0, 30] = -2.0
    write_table(folder / "angles.csv", "time_s,q1_rad,q2_rad", zip(TIME, *noisy, strict=True))
    return folder


def assemble(folder, **limits):
    campaign = read_campaign(folder)
    filmed = [t.name for t in campaign.trials if t.level == "video"]
    markers = [track_trials(campaign, filmed)] if filmed else []
    return assemble_angles(campaign, markers, **limits)


def test_all_levels_become_one_artifact(folder):
    angles = assemble(folder)
    assert list_faults(SPEC, angles) == []
    assert angles["trial"].to_numpy().tolist() == ["filmed", "pixels", "angles"]
    truth = np.stack([BEND, 0.7 * BEND])
    for name, frames, off in (("filmed", 30, 5e-3), ("pixels", 40, 5e-3), ("angles", 40, 1e-2)):
        one = angles.sel(trial=name)
        good = (one["angle_flag"].to_numpy()[:, :frames] & (JUMP | MISSING)) == 0
        error = np.abs(one["joint_angle"].to_numpy()[:, :frames] - truth[:, :frames])
        assert error[good].max() < off
        assert good.mean() > 0.97
    assert np.isnan(angles["joint_angle"].sel(trial="filmed")[:, 30:]).all()
    assert (angles["angle_flag"].sel(trial="filmed")[:, 30:] == MISSING).all()


def test_covariance_is_claimed_where_positions_claim_it(folder):
    claimed = np.isfinite(assemble(folder)["joint_angle_covariance"]).to_numpy()
    assert claimed[0, :30].all()
    assert claimed[1].all()
    assert not claimed[2].any()


def test_trials_that_fail_are_set_aside_with_their_reasons(folder):
    angles = assemble(folder)
    reasons = dict(
        zip(angles["set_aside_trial"].values, angles["set_aside_reason"].values, strict=True)
    )
    assert sorted(reasons) == ["cut", "nowhere"]
    assert "cut.avi: is cut off" in reasons["cut"]
    assert "none.csv" in reasons["nowhere"]


def test_loads_starts_covariates_and_geometry_are_carried(folder):
    angles = assemble(folder)
    np.testing.assert_array_equal(angles["load_kind"], ["tension_n", "tension_n", "tension_n"])
    np.testing.assert_allclose(angles["load_torque"], [[0, 0.04, 0.04]] * 3)
    np.testing.assert_allclose(angles["load_time"], [[0, 0, 2]] * 3)
    np.testing.assert_array_equal(angles["started_at"], [0.0, 120.0, np.nan])
    np.testing.assert_array_equal(angles["covariate_value"], [[22.5], [23.0], [np.nan]])
    np.testing.assert_allclose(angles["link_inertia"], [0.005 * 9e-4 / 12, 0.004 * 7.84e-4 / 12])
    np.testing.assert_allclose(angles["link_centre"], [0.015, 0.014])
    assert np.isnan(angles["joint_length"])
    assert angles.attrs["noise_sd_rad"] == 0.003
    assert (angles.attrs["campaign"], angles.attrs["source"]) == (
        "two joints on every level",
        "measured",
    )


def test_flags_say_what_happened(folder):
    angles = assemble(folder)
    flag = angles["angle_flag"].sel(trial="angles").to_numpy()
    assert (flag[:, 20] == STALE).all()
    assert flag[0, 30] == JUMP
    assert np.count_nonzero(flag) == 3


def test_limits_of_the_configuration_set_poor_trials_aside(folder):
    limits = {"smallest_share_seen": 0.5, "largest_rigid_residual_px": 0.03, "largest_sd_px": 0.019}
    angles = assemble(folder, limits=limits)
    assert "pixels" in angles["set_aside_trial"].values
    reasons = " ".join(angles["set_aside_reason"].values)
    assert "largest_sd_px requires at most 0.019" in reasons


def test_a_finger_said_to_bend_the_wrong_way_stops_the_campaign(folder):
    path = folder / "campaign.yaml"
    path.write_text(path.read_text().replace("wire_offset_m", "bends: clockwise\n  wire_offset_m"))
    with pytest.raises(CampaignFault, match="2 of 3 trials move against the load"):
        assemble(folder)


def test_a_film_that_was_not_tracked_is_said(folder):
    angles = assemble_angles(read_campaign(folder), [])
    reasons = dict(
        zip(angles["set_aside_trial"].values, angles["set_aside_reason"].values, strict=True)
    )
    assert "run `track` first" in reasons["filmed"]


def test_no_usable_trial_stops_the_campaign_and_lists_why(folder):
    (folder / "load.csv").write_text("time_s,weight\n0,1\n")
    (folder / "angles.csv").write_text("time_s,q1_rad,q2_rad\n0,nan,nan\n")
    with pytest.raises(CampaignFault) as caught:
        assemble(folder)
    assert "no trial can be used" in str(caught.value)
    assert all(name in str(caught.value) for name in ("filmed", "pixels", "angles", "cut"))


def test_different_kinds_of_load_stop_the_campaign(folder):
    write_table(folder / "command.csv", "time_s,command", [(0, 8), (2, 8)])
    path = folder / "trials.csv"
    path.write_text(path.read_text().replace("angles.csv,load.csv", "angles.csv,command.csv"))
    with pytest.raises(CampaignFault, match="tension_n in filmed, pixels; command in angles"):
        assemble(folder)
    write_table(folder / "angles.csv", "time_s,q1_rad,q2_rad", [(0, "nan", "nan")])
    assert "angles" in assemble(folder)["set_aside_trial"].values


def test_without_any_log_a_command_is_assumed(folder):
    path = folder / "trials.csv"
    path.write_text(path.read_text().replace(",load.csv", ","))
    angles = assemble(folder)
    np.testing.assert_array_equal(angles["load_kind"], ["assumed"] * 3)
