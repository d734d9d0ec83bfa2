"""Campaigns of one finger become one, a session each; others are refused in a sentence."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from ruamel.yaml import YAML

from softfinger.campaign import check_campaign, read_campaign
from softfinger.campaign.join import join_campaigns, refuse_unlike
from softfinger.faults import Fault


def write_folder(folder: Path, trials=2, fps=20.0, **finger) -> Path:
    (folder / "angles").mkdir(parents=True)
    (folder / "load").mkdir()
    declared = {"joints": 2, "wire_offset_m": 0.005, "bends": "counter-clockwise"} | finger
    content = {"version": 1, "name": folder.name, "source": "synthetic", "finger": declared}
    YAML().dump(content, folder / "campaign.yaml")
    time, rows = np.arange(0.0, 5.0, 1.0 / fps), []
    for k in range(trials):
        bent = 0.3 * (1.0 - np.exp(-time)) + 0.01 * np.sin(37.0 * time + k)
        table = pd.DataFrame({"time_s": time, "q1_rad": bent, "q2_rad": 0.8 * bent})
        table.to_csv(folder / f"angles/t{k}.csv", index=False)
        load = pd.DataFrame({"time_s": [0.0], "tension_n": [4.0 + k]})
        load.to_csv(folder / f"load/t{k}.csv", index=False)
        paths = {"angles": f"angles/t{k}.csv", "load": f"load/t{k}.csv"}
        rows.append({"trial": f"t{k}", **paths, f"{folder.name}_c": 20.0 + k})
    pd.DataFrame(rows).to_csv(folder / "trials.csv", index=False)
    return folder


def test_trials_of_all_sessions_are_one_campaign(tmp_path):
    folders = [write_folder(tmp_path / "mon"), write_folder(tmp_path / "tue", trials=3, fps=30.0)]
    campaigns = [read_campaign(folder) for folder in folders]
    join_campaigns(campaigns, [{}, {}], tmp_path / "both")
    joined = read_campaign(tmp_path / "both")
    assert [t.name for t in joined.trials] == ["s1_t0", "s1_t1", "s2_t0", "s2_t1", "s2_t2"]
    assert [t.covariates["session"] for t in joined.trials] == [1, 1, 2, 2, 2]
    assert not joined.set_aside
    same = (tmp_path / "tue/angles/t2.csv").read_bytes()
    assert joined.trials[4].recording.read_bytes() == same
    assert check_campaign(tmp_path / "both") is not None


def test_a_tracked_table_takes_the_place_of_a_video(tmp_path):
    campaigns = [read_campaign(write_folder(tmp_path / name)) for name in ("a", "b")]
    table = pd.DataFrame({"time_s": [0.0, 0.1], "q1_rad": [0.0, 0.25], "q2_rad": [0.0, np.nan]})
    join_campaigns(campaigns, [{"t1": table}, {}], tmp_path / "both")
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "both/angles/s1_t1.csv"), table)


@pytest.mark.parametrize(
    ("change", "words"),
    [({"joints": 3}, "joints"), ({"wire_offset_m": 0.006}, "wire_offset_m is 0.006")],
)
def test_another_finger_is_refused(tmp_path, change, words):
    one = read_campaign(write_folder(tmp_path / "a"))
    other = read_campaign(write_folder(tmp_path / "b", **change))
    with pytest.raises(Fault, match=words):
        refuse_unlike([one, other])
