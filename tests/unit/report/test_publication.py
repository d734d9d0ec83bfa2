import re
import shutil
import subprocess

import pytest
from example_artifacts import make_angles, sum_up

from softfinger.faults import Fault
from softfinger.provenance import PROJECT
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
    write_figure("finger", artifacts, paths)
    assert paths[0].read_bytes().startswith(b"%PDF")
    assert paths[1].read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("name", list(PICTURES))
def test_every_figure_has_its_name_and_its_stamp(diagnosed, name):
    picture = build_picture(name, diagnosed)
    assert picture.name == name
    if "sketch" not in picture.caption.lower():
        assert picture.figure.get_suptitle() == "synthetic"


def test_an_unknown_figure_and_a_missing_artifact_are_faults():
    angles = sum_up({"angles": make_angles()})
    with pytest.raises(Fault, match="there is no figure 'sobl'"):
        build_picture("sobl", angles)
    with pytest.raises(Fault, match="'sobol'"):
        build_picture("sobol", angles)


OF_THE_PAPER = {
    "finger",
    "joint_model",
    "histograms",
    "initial_angles",
    "densities",
    "bands",
    "bands_early",
    "sobol",
}


@pytest.fixture(scope="module")
def document(diagnosed, tmp_path_factory):
    folder = tmp_path_factory.mktemp("figures")
    write_document(list(PICTURES), diagnosed, folder / "figures.tex")
    write_parameter_table(diagnosed, folder / "parameters.tex")
    return folder / "figures.tex"


def test_the_document_names_every_figure_and_is_balanced(document):
    text = document.read_text()
    assert re.findall(r"\{(\w+)\.pdf\}", text) == list(PICTURES)
    assert re.findall(r"\\input\{(\w+)\.tex\}", text) == ["parameters"]
    for part in (text, (document.parent / "parameters.tex").read_text()):
        assert find_unbalanced(part) == []
        assert part.isascii()


def find_unbalanced(text):
    """Environments that end where another began, and braces that do not close."""
    opened = []
    for word, name in re.findall(r"\\(begin|end)\{([^}]+)\}", text):
        if word == "begin":
            opened.append(name)
        elif not opened or opened.pop() != name:
            return [name]
    plain = text.replace(r"\{", "").replace(r"\}", "")
    return opened + ["{"] * (plain.count("{") - plain.count("}"))


def test_what_is_not_balanced_is_found():
    assert find_unbalanced(r"\begin{a}\begin{b}\end{a}\end{b}") == ["a"]
    assert find_unbalanced(r"\textbf{a") == ["{"]


def test_the_workflow_draws_every_figure_of_the_paper():
    rules = (PROJECT / "workflow/rules/report.smk").read_text(encoding="utf-8")
    drawn = set(re.findall(r'"(\w+)"', "".join(re.findall(r"FIGURES \+?= (\[.*?\])", rules, re.S))))
    assert drawn <= set(PICTURES)
    assert drawn >= OF_THE_PAPER


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="no pdflatex is installed")
def test_the_document_compiles(diagnosed, document):
    for name in PICTURES:
        write_figure(name, diagnosed, [document.parent / f"{name}.pdf"])
    command = ["pdflatex", "-halt-on-error", "-interaction=nonstopmode", document.name]
    done = subprocess.run(command, cwd=document.parent, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-3000:]
    assert document.with_suffix(".pdf").read_bytes().startswith(b"%PDF")


def test_the_table_has_a_row_per_parameter_and_joint(artifacts, material, tmp_path):
    write_parameter_table(artifacts, tmp_path / "parameters.tex")
    text = (tmp_path / "parameters.tex").read_text()
    assert text == render_parameter_table(material)
    rows = [line for line in text.splitlines() if line.endswith(r"\\")]
    assert len(rows) == 1 + 12
    assert len({row.count("&") for row in rows}) == 1
    assert "-2.444" in rows[1].replace("$-$", "-")


def test_words_survive_latex():
    assert escape_tex("100 % of a_b & {c}") == r"100 \% of a\_b \& \{c\}"
