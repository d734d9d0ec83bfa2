"""Whatever goes wrong at the command line ends in one sentence and exit status 1."""

import os
import shutil
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[3] / "data/example"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["check", "x" * 5000], "cannot be read: File name too long"),
        (["check", EXAMPLE / "trials.csv"], "it is not a folder"),
        (["angles", EXAMPLE, "--out", "o", "--config", "x" * 5000], "File name too long"),
        (["angles", EXAMPLE, "--out", "file"], "file: File exists; a file is where a folder"),
        (["angles", EXAMPLE, "--out", "y" * 300], "File name too long; choose a shorter name"),
        (["angles", EXAMPLE, "--out", "taken"], "angles.nc: is a folder"),
        (["calibrate", "none", "--columns=5", "--rows=4", "--square-m=0.01"], "not a folder"),
        (["virtual-rig", "--example", "--out", EXAMPLE], "contains a campaign already"),
    ],
)
def test_paths_that_cannot_be_used_are_one_sentence(call_here, tmp_path, arguments, said):
    (tmp_path / "file").write_text("")
    (tmp_path / "taken/angles.nc").mkdir(parents=True)
    status, _, error = call_here(*arguments)
    assert status == 1
    assert said in error
    assert "unexpected" not in error


def test_the_unexpected_is_one_sentence_that_names_a_file(call_here, tmp_path, monkeypatch):
    monkeypatch.setattr("softfinger.stages.check.find_doubts", lambda angles: 1 / 0)
    status, _, error = call_here("check", EXAMPLE)
    (file,) = tmp_path.glob("softfinger-error-*.txt")
    assert status == 1
    assert error.count("\n") == 1
    assert str(file) in error
    assert "ZeroDivisionError" in file.read_text()


def test_results_of_another_campaign_are_refused(call_here, tmp_path):
    assert call_here("angles", EXAMPLE, "--out", "out").status == 0
    other = shutil.copytree(EXAMPLE, tmp_path / "other")
    table = other / "angles/trial_001.csv"
    table.write_text(table.read_text().replace("0.270997", "0.270996"))
    status, _, error = call_here("fit", other, "--out", "out")
    assert status == 1
    assert "angles.nc: was made from other recordings than those of" in error


def test_a_warning_counts_where_it_is_asked_for(call_here, tmp_path):
    wrong = shutil.copytree(EXAMPLE, tmp_path / "wrong")
    shutil.copy(wrong / "angles/trial_001.csv", wrong / "angles/trial_002.csv")
    assert call_here("check", wrong).status == 0
    assert call_here("check", wrong, "--strict").status == 1
    assert call_here("check", EXAMPLE, "--strict").status == 0


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no /dev/full here")  # noqa: PTH110
def test_a_full_disk_is_one_sentence(call_here, monkeypatch, tmp_path):
    (tmp_path / "out").mkdir()
    target = tmp_path / f"out/.angles.{os.getpid()}.partial.nc"
    target.symlink_to("/dev/full")
    status, _, error = call_here("angles", EXAMPLE, "--out", "out")
    assert status == 1
    assert "No space left on device; make room" in error
    assert list((tmp_path / "out").iterdir()) == []
