"""The campaign folder that an import writes, and the verb."""

import subprocess
import sys

import numpy as np
import pytest

from softfinger.campaign import check_campaign, read_angle_table, read_campaign, read_load
from softfinger.importing import read_import_description, read_recordings, write_campaign
from softfinger.importing.faults import ImportFault


def softfinger(*arguments):
    code = "from softfinger.cli import main; main()"
    return subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=False
    )


HEAD = "time (s),deflection (mm),force (N),temperature (°C)\n"
TABLE = HEAD + "".join(f"{t},{1 + t * t},{2 * (t > 0)},21\n" for t in range(12))


def test_a_specimen_is_written_and_read_back(write, read, tmp_path):
    found = read(write("a b/c.csv", TABLE))
    write_campaign(tmp_path / "out", found.description, found.trials, found.guessed)
    assert check_campaign(tmp_path / "out") == {}
    campaign = read_campaign(tmp_path / "out")
    assert campaign.specimen.motion.unit == "mm"
    (trial,) = campaign.trials
    motion = read_angle_table(campaign, trial)["joint_angle"].values[0]
    np.testing.assert_allclose(motion, 1 + np.arange(12.0) ** 2)
    assert read_load(campaign, trial, 1.0, 0.0)[1].max() == 2.0


def test_what_was_guessed_can_be_repeated_from_its_file(write, read, tmp_path):
    source = write("c.csv", TABLE)
    found = read(source)
    write_campaign(tmp_path / "out", found.description, found.trials, found.guessed)
    again = read_recordings(source, read_import_description(tmp_path / "out/import.yaml"))
    assert again.description == found.description
    assert again.guessed == []
    np.testing.assert_array_equal(again.trials[0].motion, found.trials[0].motion)


def test_nothing_is_overwritten(write, read, tmp_path):
    found = read(write("c.csv", TABLE))
    write_campaign(tmp_path / "out", found.description, found.trials, found.guessed)
    with pytest.raises(ImportFault, match="nothing is overwritten"):
        write_campaign(tmp_path / "out", found.description, found.trials, found.guessed)


def test_angles_become_joints_and_a_torque_stays_one(write, read, tmp_path):
    rows = "".join(f"{t},{t},{2 * t},{5 * (t > 0)}\n" for t in range(12))
    found = read(write("c.csv", "time,q1_deg,q2_deg,torque_Nmm\n" + rows))
    write_campaign(tmp_path / "out", found.description, found.trials, found.guessed)
    campaign = read_campaign(tmp_path / "out")
    assert (campaign.finger.joints, campaign.specimen) == (2, None)
    _, load, kind = read_load(campaign, campaign.trials[0], 1.0, 0.0)
    assert (kind, load.max()) == ("torque_nm", 0.005)


def test_a_chain_of_points_becomes_links_that_share_them(write, read, tmp_path):
    head = "time,a_x,a_y,b_x,b_y,c_x,c_y,pwm\n"
    rows = "".join(f"{t},0,50,10,50,20,{50 + t},{100 * (t > 0)}\n" for t in range(12))
    found = read(write("c.csv", head + rows))
    write_campaign(tmp_path / "out", found.description, found.trials, found.guessed)
    assert check_campaign(tmp_path / "out") == {}
    campaign = read_campaign(tmp_path / "out")
    # y counts downwards: the chain bends clockwise under the load.
    assert (campaign.finger.joints, campaign.finger.bends) == (1, "clockwise")


def test_the_verb_shows_first_and_writes_then(write, tmp_path):
    source, out = str(write("c.csv", TABLE)), tmp_path / "out"
    shown = softfinger("import", source, "--out", str(out), "--dry-run")
    assert shown.returncode == 0, shown.stderr
    assert "deflection" in shown.stdout
    assert "▁" in shown.stdout
    assert (out / "preview.png").is_file()
    assert not (out / "campaign.yaml").exists()
    text = (out / "import.yaml").read_text()
    (out / "import.yaml").write_text(text.replace("name: c\n", "name: mine\n"))
    done = softfinger("import", source, "--out", str(out))
    assert done.returncode == 0, done.stderr
    assert read_campaign(out).name == "mine"
    again = softfinger("import", source, "--out", str(out))
    assert again.returncode == 1
    assert "nothing is overwritten" in again.stderr


def test_overruling_by_keys(write, tmp_path):
    source, out = str(write("c.csv", TABLE)), tmp_path / "out"
    keys = ["--set", "clock.unit=ms", "--set", "motion.unit=um"]
    done = softfinger("import", source, "--out", str(out), *keys)
    assert done.returncode == 0, done.stderr
    campaign = read_campaign(out)
    assert campaign.specimen.motion.unit == "um"
    assert read_angle_table(campaign, campaign.trials[0])["time"].values[-1] == 0.011
