import re

import pytest

from softfinger.rig.camera import StampedPicture
from softfinger.rig.display import Display


def record(preview):
    with Display(n_trials=40, n_finished=1, fps=10.0, preview=preview) as display:
        display.begin_trial("trial_002", "climb")
        display.show_tension(7.984)
        display.show_frames([StampedPicture(0.1 * k, 0.0, b"jpeg") for k in (0, 1, 2, 5, 6)])
        display.end_trial("trial_002 is recorded")


def test_a_terminal_shows_trial_tension_rate_and_lost_frames(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "120")
    record(tmp_path / "preview.jpg")
    shown = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", capsys.readouterr().err)
    for part in ("trial_002 (2 of 40, climb)", "7.98 N", "6.7 frames/s", "2 frames lost"):
        assert part in shown
    assert "trial_002 is recorded" in shown
    assert (tmp_path / "preview.jpg").read_bytes() == b"jpeg"


@pytest.mark.parametrize("folder", ["there", "gone"])
def test_off_a_terminal_only_finished_trials_are_told(tmp_path, capsys, folder):
    if folder == "there":
        (tmp_path / "there").mkdir()
    record(tmp_path / folder / "preview.jpg")  # a preview that cannot be written stops nothing
    assert capsys.readouterr().err == "trial_002 is recorded\n"
