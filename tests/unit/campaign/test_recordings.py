import numpy as np
import pytest

from softfinger.campaign import (
    check_campaign,
    marker_names,
    read_angle_table,
    read_campaign,
    read_marker_table,
)
from softfinger.faults import TrialFault


def test_angles_keep_their_order_and_their_gaps(folder):
    campaign = read_campaign(folder)
    read = read_angle_table(campaign, campaign.trials[0])
    np.testing.assert_array_equal(read.time, [0.0, 0.1, 0.2, 0.3])
    np.testing.assert_array_equal(
        read.joint_angle, [[0.01, 0.11, np.nan, 0.31], [0.02, np.nan, 0.22, 0.32]]
    )
    assert read.attrs["repeated_times"] == 0


def test_rows_with_one_time_stamp_become_their_mean(folder, damage):
    damage("angles/first.csv", "0.2,,0.22", "0.1,0.13,0.22")
    campaign = read_campaign(folder)
    read = read_angle_table(campaign, campaign.trials[0])
    np.testing.assert_allclose(read.time, [0.0, 0.1, 0.3])
    np.testing.assert_allclose(read.joint_angle[:, 1], [0.12, 0.22])
    assert read.attrs["repeated_times"] == 1


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("0.2,,0.22", "0.05,,0.22", "row 4, column 'time_s': time runs backwards, 0.05 s after"),
        ("0.2,,0.22", "0.2,x,0.22", "row 4, column 'q1_rad': is 'x'"),
        ("0.2,,0.22", "0.2,inf,0.22", "row 4, column 'q1_rad': is 'inf'"),
        ("q2_rad", "q2_deg", "column 'q2_rad' is missing and column 'q2_deg' is unknown"),
        ("0.31,", "31.0,", "is it in degrees?"),
        ("0.2,,0.22", "0.2,,0.22,7", "it is not a CSV table"),
    ],
)
def test_a_wrong_angle_table_names_file_row_and_column(folder, damage, old, new, said):
    damage("angles/first.csv", old, new)
    reasons = check_campaign(folder)
    assert set(reasons) == {"first", "third"}
    assert said in reasons["first"]
    assert "first.csv" in reasons["first"]


@pytest.mark.parametrize("rows", [1, 2, 3])
def test_a_table_read_in_pieces_is_the_same_and_names_the_same_row(folder, monkeypatch, rows):
    campaign = read_campaign(folder)
    whole = read_angle_table(campaign, campaign.trials[0])
    monkeypatch.setattr("softfinger.campaign.tables.PIECE_ROWS", rows)
    assert read_angle_table(campaign, campaign.trials[0]).identical(whole)
    path = folder / "angles/first.csv"
    path.write_text(path.read_text().replace("0.31,", "x,"))
    with pytest.raises(TrialFault, match=r"first.csv, row 5, column 'q1_rad': is 'x'"):
        read_angle_table(campaign, campaign.trials[0])


def test_markers_are_ordered_from_base_to_tip(folder):
    campaign = read_campaign(folder)
    read = read_marker_table(campaign, campaign.trials[1])
    assert read.marker.to_numpy().tolist() == marker_names(campaign.camera)
    # link_1_2 stands first in the file, so its x is 0, 0.5, 1 and its y 0.
    np.testing.assert_array_equal(
        read.marker_position.sel(marker="link_1_2"), [[0, 0], [0.5, 0], [1, 0]]
    )
    assert (read.marker_position_sd == 0.1).all()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("0.5,base_1", "0.5,thumb_1", "'thumb_1' is unknown"),
        ("0.5,base_1", "0.5,link_3_1", "'link_3_1' is unknown"),
        ("0.5,base_1", "0.5,base_2", "marker 'base_2' appears twice at 0.5 s"),
        ("base_1", "base_2", "base has 1 marker; its direction needs at least two"),
        (",0.1\n", ",0.0\n", "expected > 0"),
    ],
)
def test_a_wrong_marker_table_says_what_is_wrong(folder, damage, old, new, said):
    damage("markers/second.csv", old, new)
    assert said in check_campaign(folder)["second"]
