import csv
import io
import re
import shutil
import subprocess

import pytest
from example_artifacts import make_angles, sum_up
from matplotlib.figure import Figure

from softfinger.faults import Fault
from softfinger.figures.data import write_data
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


@pytest.fixture(scope="module", params=list(PICTURES))
def picture(diagnosed, request):
    found = build_picture(request.param, diagnosed)
    assert found.name == request.param
    return found


def is_sketch(picture):
    return "sketch" in picture.caption.lower()


def test_every_figure_has_its_stamp(picture):
    if not is_sketch(picture):
        assert picture.figure.get_suptitle() == "synthetic"


def test_every_figure_has_the_width_of_a_column_and_type_of_seven_points(picture):
    assert round(25.4 * picture.figure.get_size_inches()[0], 6) in {85.0, 170.0}
    texts = picture.figure.findobj(lambda part: hasattr(part, "get_fontsize"))
    sizes = {text.get_fontsize() for text in texts if text.get_text().strip()}
    assert min(sizes) >= 7.0
    if not is_sketch(picture):
        assert re.search(r"n = \d|of \d+ |Frame \d+|R-hat", picture.caption)


def test_every_figure_has_its_numbers_as_a_table(picture):
    rows = list(csv.DictReader(io.StringIO(write_data(picture.figure))))
    assert bool(rows) != is_sketch(picture)
    for row in rows:
        assert re.match(r"[^_]", row["series"])
        assert not re.match(r"child\d|container\d", row["series"])
        assert row["x"] or row["y"]


def test_a_table_has_the_numbers_of_the_artifact(diagnosed, tmp_path):
    write_figure("ranking", diagnosed, [tmp_path / "a.csv", tmp_path / "a.txt"])
    rows = csv.DictReader(io.StringIO((tmp_path / "a.csv").read_text(encoding="utf-8")))
    gain = {r["y"]: float(r["x"]) for r in rows if "needed" in r["series"]}
    ranking = diagnosed["ranking"]
    assert gain == pytest.approx(
        {str(name).replace("_", " "): float(ranking["best_gain"].sel(effect=name))
         for name in ranking["effect"].values}
    )  # fmt: skip
    words = (tmp_path / "a.txt").read_text(encoding="utf-8")
    assert words.startswith("The evidence of every effect that was fitted. Log evidence")


def test_a_band_is_written_from_its_lower_to_its_upper_edge():
    figure = Figure()
    ax = figure.subplots()
    ax.fill_between([1.0, 2.0], [0.0, 1.0], [3.0, 5.0], label="band")
    ax.axvline(0.0, label="_")
    ax.axvline(7.0, label="_limit")
    rows = list(csv.DictReader(io.StringIO(write_data(figure))))
    assert [(r["x"], r["y"], r["y_low"], r["y_high"]) for r in rows] == [
        ("7", "", "", ""),
        ("1", "", "0", "3"),
        ("2", "", "1", "5"),
    ]


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
