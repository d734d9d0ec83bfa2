import numpy as np
import pytest

from softfinger.campaign import read_campaign
from softfinger.tracking import assemble_angles


@pytest.fixture
def campaign(tmp_path):
    """Two joints; a trial of five frames beside one of three, whose load log has fewer knots."""
    (tmp_path / "campaign.yaml").write_text(
        "version: 1\nname: short and long\nsource: measured\nfinger: {joints: 2}\n"
    )
    (tmp_path / "trials.csv").write_text(
        "trial,angles,load,payload_kg\nlong,long.csv,long_load.csv,0.1\nshort,short.csv,,\n"
        "gone,gone.csv,,\n"
    )
    rows = [f"{0.1 * k:.1f},{0.01 * k:.3f},{0.02 * k:.3f}" for k in range(5)]
    head = "time_s,q1_rad,q2_rad"
    (tmp_path / "long.csv").write_text("\n".join([head, *rows]) + "\n")
    (tmp_path / "short.csv").write_text("\n".join([head, *rows[:3]]) + "\n")
    (tmp_path / "long_load.csv").write_text("time_s,torque_nm\n0,0\n0.1,1\n0.4,1\n0.9,2\n")
    return read_campaign(tmp_path)


def test_a_shorter_trial_ends_in_missing_frames(campaign):
    angles = assemble_angles(campaign, [])
    np.testing.assert_allclose(angles["time"][1], [0.0, 0.1, 0.2, np.nan, np.nan])
    np.testing.assert_allclose(angles["joint_angle"][1, 1], [0.0, 0.02, 0.04, np.nan, np.nan])
    assert (angles["angle_flag"][1, :, 3:] & 1 == 1).all()
    assert (angles["angle_flag"][1, :, :3] == 0).all()
    assert np.isnan(angles["joint_angle_covariance"]).all()


def test_a_shorter_load_repeats_its_last_knot(campaign):
    angles = assemble_angles(campaign, [])
    np.testing.assert_allclose(angles["load_time"][0], [0.0, 0.1, 0.1, 0.4, 0.9])
    np.testing.assert_allclose(angles["load_torque"][0], [0.0, 0.0, 1.0, 1.0, 2.0])
    np.testing.assert_allclose(angles["load_time"][1], 0.0)
    np.testing.assert_allclose(angles["load_torque"][1], [0.0, 1.0, 1.0, 1.0, 1.0])
    assert angles["load_kind"].to_numpy().tolist() == ["torque_nm", "assumed"]


def test_covariates_and_reasons_are_kept(campaign):
    angles = assemble_angles(campaign, [])
    np.testing.assert_allclose(angles["covariate_value"].sel(covariate="payload_kg"), [0.1, np.nan])
    assert angles["set_aside_trial"].to_numpy().tolist() == ["gone"]
    assert "does not exist" in str(angles["set_aside_reason"].to_numpy()[0])
