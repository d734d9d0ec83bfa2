import numpy as np
import pytest

from softfinger.campaign import check_campaign, read_angle_table, read_campaign, read_load
from softfinger.faults import CampaignFault

DESCRIPTION = """\
version: 1
name: a beam in bending
source: measured
specimen:
  motion: {quantity: displacement, unit: mm}
  load: {quantity: force, unit: N}
"""


@pytest.fixture
def beam(tmp_path):
    (tmp_path / "campaign.yaml").write_text(DESCRIPTION)
    (tmp_path / "trials.csv").write_text("trial,angles,load\none,one.csv,load.csv\n")
    (tmp_path / "one.csv").write_text("time_s,motion\n0,0\n0.5,40\n1.0,45\n")
    (tmp_path / "load.csv").write_text("time_s,load\n0,0\n0.1,900\n2,900\n")
    return tmp_path


def test_motion_and_load_are_read_in_their_own_units(beam):
    campaign = read_campaign(beam)
    assert campaign.finger.joints == 1
    assert campaign.specimen.motion.unit == "mm"
    motion = read_angle_table(campaign, campaign.trials[0])["joint_angle"]
    np.testing.assert_array_equal(motion, [[0.0, 40.0, 45.0]])
    _, load, kind = read_load(campaign, campaign.trials[0], 0.5, 0.0)
    assert (load.max(), kind) == (900.0, "command")
    assert check_campaign(beam) == {}


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("unit: mm", "unit: furlongz", "unit 'furlongz' is not known; write it as pint does"),
        ("unit: N", "units: N", "unknown key 'units'; did you mean 'unit'?"),
        ("specimen:", "finger: {joints: 1}\nspecimen:", "give either finger or specimen"),
        ("source:", "noise_sd_rad: 0.1\nsource:", "give specimen.motion.noise_sd"),
        ("load: {quantity: force, unit: N}", "", "specimen.load: this key is missing"),
    ],
)
def test_a_wrong_description_of_a_specimen_is_one_sentence(beam, old, new, said):
    text = (beam / "campaign.yaml").read_text()
    assert old in text
    (beam / "campaign.yaml").write_text(text.replace(old, new))
    with pytest.raises(CampaignFault) as caught:
        read_campaign(beam)
    assert said in str(caught.value)


def test_a_table_of_joint_angles_is_no_motion(beam):
    (beam / "one.csv").write_text("time_s,q1_rad\n0,0\n1,1\n")
    assert "column 'motion' is missing" in check_campaign(beam)["one"]


def test_markers_of_a_specimen_are_set_aside(beam):
    (beam / "trials.csv").write_text(
        "trial,angles,markers,load\none,one.csv,,load.csv\ntwo,,one.csv,load.csv\n"
    )
    assert "a specimen's recordings are tables" in read_campaign(beam).set_aside["two"]
