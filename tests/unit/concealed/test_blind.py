"""A blind diagnosis: what the process gets, what becomes of a crash, and that answers stand."""

import json
import sys

import pytest

from softfinger.concealed.blind import diagnose_blind, read_answer, write_answer

# Writes down what it was given and where it stands, as a verdict.
TELLTALE = """
import json, os, pathlib, sys
here = pathlib.Path.cwd()
found = sorted(str(p.relative_to(here)) for p in here.rglob("*") if p.is_file())
answer = {"decision": "adequate", "given": sys.argv[1:], "place": str(here), "found": found}
answer["threads"] = os.environ["NUMBA_NUM_THREADS"]
pathlib.Path("out/verdict.json").write_text(json.dumps(answer))
"""


@pytest.fixture
def campaign(tmp_path):
    folder = tmp_path / "suite/campaign/0123456789"
    folder.mkdir(parents=True)
    (folder / "campaign.yaml").write_text("version: 1\n")
    (tmp_path / "suite/truth").mkdir()
    (tmp_path / "suite/truth/0123456789.json").write_text('{"effects": ["gravity"]}')
    return folder


def _answer(campaign, code, patience=60.0):
    diagnosis = campaign.parents[1] / "diagnosis/0123456789"
    return diagnose_blind(campaign, diagnosis, patience, (sys.executable, "-c", code)), diagnosis


def test_the_process_gets_a_copy_of_the_campaign_and_nothing_else(campaign):
    answer, diagnosis = _answer(campaign, TELLTALE)
    verdict = answer["verdict"]
    assert answer["reason"] is None
    assert verdict["given"] == ["campaign", "--out", "out", "--no-mcmc", "--no-report"]
    assert verdict["found"] == ["campaign/campaign.yaml"]
    assert not verdict["place"].startswith(str(campaign.parents[1]))
    assert json.loads((diagnosis / "verdict.json").read_text()) == verdict
    assert verdict["threads"] == "1"  # others run beside it
    assert answer["seconds"] > 0.0


@pytest.mark.parametrize(
    ("code", "reason"),
    [
        ("raise ValueError('no such thing')", "ValueError: no such thing"),
        ("import sys; sys.exit(3)", "it ended with status 3"),
        ("pass", "it ended without a verdict"),
    ],
)
def test_a_crash_is_an_answer_with_a_reason(campaign, code, reason):
    answer, _ = _answer(campaign, code)
    assert answer["verdict"]["decision"] == "crashed"
    assert answer["reason"] == reason


def test_patience_ends(campaign):
    answer, _ = _answer(campaign, "import time; time.sleep(60)", patience=0.5)
    assert answer["reason"] == "it took more than 0.5 s"


def test_an_answer_that_was_changed_is_refused(tmp_path):
    path, digest_path = tmp_path / "answer.json", tmp_path / "digest.txt"
    digest = write_answer({"verdict": {"decision": "adequate"}}, path, digest_path)
    assert digest_path.read_text().strip() == digest
    assert read_answer(path, digest) == {"verdict": {"decision": "adequate"}}
    path.write_text(path.read_text().replace("adequate", "unlisted"))
    with pytest.raises(ValueError, match="the answer was changed"):
        read_answer(path, digest)
