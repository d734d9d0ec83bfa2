import re

import matplotlib as mpl
import pytest
from matplotlib.figure import Figure

from softfinger.figures.recordings import draw_recordings
from softfinger.figures.style import name_clips, new_figure, render_figure, save_figure, styled


@pytest.mark.parametrize("form", ["svg", "pdf", "png"])
def test_same_dataset_same_bytes(artifacts, form):
    first, second = (render_figure(draw_recordings(artifacts["angles"]), form) for _ in range(2))
    assert first == second


def test_no_clock_and_no_version_in_the_file(artifacts):
    svg = render_figure(draw_recordings(artifacts["angles"]), "svg")
    assert b"dc:date" not in svg
    assert mpl.__version__.encode() not in svg.partition(b"<defs>")[0]


@pytest.mark.parametrize("source", ["synthetic", "measured"])
def test_every_figure_says_what_it_shows(artifacts, source):
    figure = draw_recordings(artifacts["angles"].assign_attrs(source=source))
    assert figure.get_suptitle() == source


def test_a_figure_of_unknown_source_is_refused(artifacts):
    angles = artifacts["angles"].copy()
    del angles.attrs["source"]
    with pytest.raises(ValueError, match="synthetic"):
        draw_recordings(angles)


def test_the_callers_settings_do_not_leak_in_or_out():
    @styled
    def draw() -> Figure:
        figure = new_figure("measured", height=1.0)
        figure.subplots().plot([0, 1], [0, 1])
        return figure

    plain = render_figure(draw())
    with mpl.rc_context({"font.size": 30, "axes.linewidth": 9, "svg.hashsalt": "other"}):
        assert render_figure(draw()) == plain
        assert mpl.rcParams["font.size"] == 30


def test_the_suffix_names_the_form(tmp_path):
    figure = new_figure("measured", height=1.0)
    save_figure(figure, tmp_path / "a.pdf")
    assert (tmp_path / "a.pdf").read_bytes().startswith(b"%PDF")


def test_clips_that_differ_by_rounding_alone_have_one_name():
    svg = (
        '<svg><defs><clipPath id="{0}"><rect x="1.5"/></clipPath><clipPath id="{1}">'
        '<rect x="2.5"/></clipPath></defs><path clip-path="url(#{1})"/><use href="#{0}"/>'
        '<path clip-path="url(#{0})"/></svg>'
    )
    one, two = (name_clips(svg.format(*ids).encode()) for ids in (("pa", "pb"), ("pc", "pd")))
    assert one.replace(b"#pa", b"#pc") == two
    assert len(set(re.findall(rb"url\(#(\w+)\)", one))) == 2
