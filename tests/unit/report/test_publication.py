import re

import pytest
from example_artifacts import CONFIG, make_angles

from softfinger.faults import Fault
from softfinger.report.publication import (
    PICTURES,
    build_picture,
    escape_tex,
    render_parameter_table,
    write_document,
    write_figure,
    write_parameter_table,
)


def test_a_figure_is_written_in_every_form_asked_for(artifacts, tmp_path):
    paths = [tmp_path / "finger.pdf", tmp_path / "finger.png"]
    write_figure("finger", artifacts, CONFIG, paths)
    assert paths[0].read_bytes().startswith(b"%PDF")
    assert paths[1].read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("name", list(PICTURES))
def test_every_figure_has_its_name_and_its_stamp(artifacts, name):
    picture = build_picture(name, artifacts, CONFIG)
    assert picture.name == name
    if "sketch" not in picture.caption.lower():
        assert picture.figure.get_suptitle() == "synthetic"


def test_an_unknown_figure_and_a_missing_artifact_are_faults():
    angles = {"angles": make_angles()}
    with pytest.raises(Fault, match="there is no figure 'sobl'"):
        build_picture("sobl", angles, CONFIG)
    with pytest.raises(Fault, match="'sobol'"):
        build_picture("sobol", angles, CONFIG)


def test_the_document_names_files_that_lie_beside_it_and_is_balanced(artifacts, tmp_path):
    names = ["finger", "sobol"]
    write_document(names, artifacts, CONFIG, tmp_path / "figures.tex")
    text = (tmp_path / "figures.tex").read_text()
    assert re.findall(r"\{(\w+)\.pdf\}", text) == names
    begun, ended = (re.findall(rf"\\{word}\{{([^}}]+)\}}", text) for word in ("begin", "end"))
    assert sorted(begun) == sorted(ended)
    assert text.isascii()


def test_the_table_has_a_row_per_parameter_and_joint(artifacts, material, tmp_path):
    write_parameter_table(artifacts, CONFIG, tmp_path / "parameters.tex")
    text = (tmp_path / "parameters.tex").read_text()
    assert text == render_parameter_table(material)
    rows = [line for line in text.splitlines() if line.endswith(r"\\")]
    assert len(rows) == 1 + 12
    assert len({row.count("&") for row in rows}) == 1
    assert "-2.444" in rows[1].replace("$-$", "-")


def test_words_survive_latex():
    assert escape_tex("100 % of a_b & {c}") == r"100 \% of a\_b \& \{c\}"
