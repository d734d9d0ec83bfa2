"""`softfinger new`: a folder to fill in, and `check` names what is still empty."""

import itertools
import re

import pytest
from typer.testing import CliRunner

from softfinger.campaign.description import Description
from softfinger.campaign.template import format_template, write_template
from softfinger.cli import app
from softfinger.faults import Fault
from softfinger.gate import read_document

KINDS = [dict(zip(("specimen", "video"), values, strict=True))
         for values in itertools.product([False, True], repeat=2)]  # fmt: skip
ANSWERS = {
    "name": "my finger",
    "source": "measured",
    "joints": "1",
    "markers": "{base: [-0.018, -0.006], link_1: [0.006, 0.019]}",
    "dots": "{tip: {diameter_px: 9.0, at_px: [3.0, 4.0]}}",
}


def run(*arguments):
    return CliRunner().invoke(app, [str(word) for word in arguments])


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_check_names_every_empty_key_and_the_empty_table(tmp_path, kind):
    write_template(tmp_path / "new", **kind)
    text = (tmp_path / "new/campaign.yaml").read_text()
    empty = [line.split(":")[0].strip() for line in text.splitlines()
             if re.match(r" *\w+: #", line) and "what moves" not in line]  # fmt: skip
    done = run("check", tmp_path / "new", "--json")
    assert done.exit_code == 1
    for key in empty:
        assert re.search(rf"line \d+, [\w.]*{key}: is still empty; fill in", done.stdout), key
    assert done.stdout.count("is still empty") == len(empty) >= 3
    assert "trials.csv, it has no rows; fill in one for each recording" in done.stdout


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_a_template_whose_every_line_is_filled_in_is_a_description(tmp_path, kind):
    lines = []
    for line in format_template(**kind).splitlines()[2:]:
        found = re.fullmatch(r"( *)(?:# )?(\w+): ?(.*?)(?: ?# (.*))?", line)
        if found and "what moves" not in line and found[2] not in {"finger", "specimen", "camera"}:
            example = re.search("as in (.*)", found[4] or "")
            value = ANSWERS.get(found[2]) or found[3] or (example and example[1])
            line = f"{found[1]}{found[2]}: {re.sub(r', [0-9.e-]+, [0-9.e-]+]', ']', value)}"
        lines.append(line)
    (tmp_path / "campaign.yaml").write_text("\n".join(lines))
    Description.model_validate(read_document(tmp_path / "campaign.yaml").content)


def test_what_is_there_is_not_overwritten(tmp_path):
    (tmp_path / "mine").write_text("mine")
    with pytest.raises(Fault, match="exists already; choose a folder that is new or empty"):
        write_template(tmp_path)
    assert [file.name for file in tmp_path.iterdir()] == ["mine"]


def test_an_empty_optional_key_is_named_too(tmp_path):
    (tmp_path / "campaign.yaml").write_text(
        "version: 1\nname: a\nsource: measured\nfinger:\n  joints: 1\n  wire_offset_m:\n"
    )
    (tmp_path / "trials.csv").write_text("trial,angles\na,a.csv\n")
    done = run("check", tmp_path, "--json")
    assert "line 6, finger.wire_offset_m: is still empty; fill in the distance" in done.stdout
