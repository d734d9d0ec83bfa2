import json
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[3] / "data/example"


def test_a_whole_campaign_is_said_to_be_whole(call):
    done = call("check", EXAMPLE)
    assert done.status == 0
    assert "4 of 4 trials can be used" in done.stdout


def test_a_fault_is_one_sentence_and_no_traceback(call, tmp_path):
    (tmp_path / "campaign.yaml").write_text("version: 1\nnmae: x\n")
    (tmp_path / "trials.csv").write_text("trial,angles\n")
    done = call("check", tmp_path)
    assert done.status == 1
    assert "did you mean 'name'" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_missing_trial_is_listed(call, tmp_path):
    for file in EXAMPLE.rglob("*"):
        if file.is_file():
            target = tmp_path / file.relative_to(EXAMPLE)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(file.read_bytes())
    (tmp_path / "angles/trial_002.csv").unlink()
    done = call("check", tmp_path)
    assert done.status == 1
    assert "set aside trial_002: trials.csv, row 3, column 'angles'" in done.stdout
    assert "3 of 4 trials can be used" in done.stdout


@pytest.mark.parametrize("verb", ["fit", "propagate", "sobol", "summarise", "report"])
def test_a_verb_without_its_predecessor_says_what_is_missing(call, verb, tmp_path):
    done = call(verb, EXAMPLE, "--out", tmp_path)
    assert done.status == 1
    assert "angles.nc cannot be used" in done.stderr
    assert "the file does not exist; run the rule that makes it" in done.stderr
    assert "Traceback" not in done.stderr


def test_check_speaks_to_programs(call):
    done = call("check", EXAMPLE, "--json")
    assert json.loads(done.stdout)["set_aside"] == {}


def test_a_board_that_no_picture_shows_is_one_sentence(call, tmp_path):
    (tmp_path / "one.png").write_bytes(b"no picture")
    board = ["--columns", "7", "--rows", "5", "--square-m", "0.01"]
    done = call("calibrate", tmp_path, *board)
    assert done.status == 1
    assert "0 of 1 pictures show the 7 × 5 chessboard; expected at least 5" in done.stderr
    assert "Traceback" not in done.stderr
