import numpy as np
import pytest

from softfinger.campaign import check_campaign, read_campaign
from softfinger.faults import CampaignFault


def test_a_whole_campaign_is_read(folder):
    campaign = read_campaign(folder)
    assert [t.name for t in campaign.trials] == ["first", "second", "third"]
    assert [t.level for t in campaign.trials] == ["angles", "markers", "angles"]
    assert campaign.finger.wire_offset_m == 0.005
    assert campaign.trials[0].covariates == {"temperature_c": 21.5}
    assert np.isnan(campaign.trials[1].covariates["temperature_c"])
    assert (campaign.trials[1].started_at - campaign.trials[0].started_at).seconds == 120
    assert check_campaign(folder) == {}


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("wire_offset_m", "wire_ofset_m", "did you mean 'wire_offset_m'"),
        ("version: 1", "version: 2", "version: is 2"),
        ("joints: 2", "joints: 3", "link_length_m has 2 values, but the finger has 3 joints"),
        ("[0.025, 0.03]", "[25, 30]", "finger.link_length_m.1: is 25"),
        ("source: measured", "source: guessed", "source: is 'guessed'"),
        ("link_2: [0.006, 0.019]", "link_2: [0.006]", "camera.markers.link_2 is [0.006]"),
        ("link_2: [0.006", "link_3: [0.006", "needs exactly base, link_1, link_2"),
        ("metres_per_pixel: 0.0002", "marker_colour: dark", "either metres_per_pixel or"),
        ("name: two", "name: &a two\nother: *a #", "alias"),
        ("finger:", "finger: [", "it is not YAML"),
    ],
)
def test_a_wrong_description_stops_with_key_and_line(folder, damage, old, new, said):
    damage("campaign.yaml", old, new)
    with pytest.raises(CampaignFault) as fault:
        read_campaign(folder)
    assert said in str(fault.value)
    assert "campaign.yaml" in str(fault.value)


def test_the_unit_is_asked_about_where_a_number_is_wrong_and_nowhere_else(folder, damage):
    damage("campaign.yaml", "source: measured", "source: guessed")
    damage("campaign.yaml", "[0.025, 0.03]", "[25, 30]")
    with pytest.raises(CampaignFault) as fault:
        read_campaign(folder)
    word, *numbers = fault.value.faults
    assert str(word).endswith("is 'guessed'; input should be 'measured' or 'synthetic'")
    assert all(str(number).endswith("check the unit in the key's name") for number in numbers)


def test_the_line_of_an_unknown_key_is_named(folder, damage):
    damage("campaign.yaml", "wire_offset_m", "wire_ofset_m")
    with pytest.raises(CampaignFault, match=r"line 7, finger.wire_ofset_m"):
        read_campaign(folder)


def test_all_faults_are_listed_at_once(folder, damage):
    damage("campaign.yaml", "version: 1", "version: 9")
    damage("campaign.yaml", "fps: 30.0", "fps: -3")
    with pytest.raises(CampaignFault) as fault:
        read_campaign(folder)
    assert len(fault.value.faults) == 2


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("trial,started_at", "name,started_at", "column 'trial' is missing"),
        ("second,", "first,", "the name 'first' appears more than once"),
        ("second,", "First,", "the names 'first', 'First' differ in capitals only"),
        ("21.5", "warm", "row 2, column 'temperature_c': is 'warm'"),
    ],
)
def test_a_wrong_table_of_trials_stops(folder, damage, old, new, said):
    damage("trials.csv", old, new)
    with pytest.raises(CampaignFault) as fault:
        read_campaign(folder)
    assert said in str(fault.value)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("markers/second.csv", "../secret.csv", "leads out of the campaign folder"),
        ("markers/second.csv", "/etc/passwd", "leads out of the campaign folder"),
        ("markers/second.csv", "markers/none.csv", "the file 'markers/none.csv' does not exist"),
        (",,markers/second.csv", ",a.csv,markers/second.csv", "found markers and angles"),
        ("T10:02:00", "T25:02:00", "expected ISO 8601"),
    ],
)
def test_a_wrong_row_sets_its_trial_aside_and_the_others_go_on(folder, damage, old, new, said):
    damage("trials.csv", old, new)
    campaign = read_campaign(folder)
    assert [t.name for t in campaign.trials] == ["first", "third"]
    assert said in campaign.set_aside["second"]
    assert "row 3" in campaign.set_aside["second"]


def test_an_empty_recording_is_set_aside(folder):
    (folder / "markers/second.csv").write_text("")
    assert "is empty" in read_campaign(folder).set_aside["second"]


def test_a_campaign_without_any_usable_trial_stops(folder):
    (folder / "trials.csv").write_text("trial,angles\na,none.csv\n")
    with pytest.raises(CampaignFault, match="no trial can be used"):
        read_campaign(folder)


def test_videos_need_a_camera(folder, damage):
    text = (folder / "campaign.yaml").read_text()
    (folder / "campaign.yaml").write_text(text[: text.index("camera:")])
    (folder / "a.avi").write_bytes(b"x")
    (folder / "trials.csv").write_text("trial,video\na,a.avi\n")
    with pytest.raises(CampaignFault, match="'camera' is missing"):
        read_campaign(folder)


@pytest.mark.parametrize("text", [b"version: 1\nname: \xff\xfe", b"- a\n- b\n", b""])
def test_what_is_no_mapping_of_text_is_refused(folder, text):
    (folder / "campaign.yaml").write_bytes(text)
    with pytest.raises(CampaignFault):
        read_campaign(folder)


def test_a_missing_folder_is_named(tmp_path):
    with pytest.raises(CampaignFault, match="does not exist"):
        read_campaign(tmp_path / "nowhere")


def test_lists_within_lists_without_end_are_refused_at_once(folder):
    with (folder / "campaign.yaml").open("a") as stream:
        stream.write("deep: " + "[" * 100_000 + "]" * 100_000 + "\n")
    with pytest.raises(CampaignFault, match="nests keys or lists deeper than 20 times"):
        read_campaign(folder)


def test_a_heading_without_end_is_refused_at_once(folder):
    (folder / "trials.csv").write_text("trial,angles" + ",0" * 600_000 + "\n")
    with pytest.raises(CampaignFault, match="its first line has more than 20000 bytes"):
        read_campaign(folder)


def test_a_trial_without_a_log_is_set_aside_where_others_have_one(folder, damage):
    damage("trials.csv", "load/first.csv,22.0", ",22.0")
    campaign = read_campaign(folder)
    assert [t.name for t in campaign.trials] == ["first", "second"]
    assert "row 4 (trial third): its load is not logged" in campaign.set_aside["third"]


def test_different_kinds_of_load_are_refused_with_their_trials(folder, damage):
    (folder / "load/third.csv").write_text("time_s,torque_nm\n0.0,0\n0.1,0.04\n")
    damage("trials.csv", "load/first.csv,22.0", "load/third.csv,22.0")
    with pytest.raises(CampaignFault) as fault:
        check_campaign(folder)
    assert "tension_n in first, second; torque_nm in third" in str(fault.value)


@pytest.mark.parametrize(
    ("camera", "said"),
    [
        ("metres_per_pixel: 0.0000001", "would have 4e+04 px"),
        ("intrinsics: {matrix: [[0, 0, 0], [0, 0, 0], [0, 0, 0]]}", "matrix must be"),
        (
            "intrinsics: {matrix: [[900, 0, 3], [0, 900, 2], [0, 0, 1]], distortion: [1, 0, 0]}",
            "distortion has 3 coefficients; OpenCV knows 0, 4, 5",
        ),
    ],
)
def test_a_camera_that_cannot_be_is_refused(folder, damage, camera, said):
    damage("campaign.yaml", "metres_per_pixel: 0.0002", camera)
    with pytest.raises(CampaignFault) as fault:
        read_campaign(folder)
    assert said in str(fault.value)
