import pytest

from softfinger.progress import QUIET, follow_progress, silence_progress, track_progress


@pytest.fixture
def terminal(monkeypatch):
    """Standard error as if it were a terminal, and no bar silenced, whatever the test does."""
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv(QUIET, "1")
    monkeypatch.delenv(QUIET)


def test_a_loop_shows_how_far_it_has_come(terminal, capsys):
    assert list(track_progress(range(3), "counting trials")) == [0, 1, 2]
    shown = capsys.readouterr().err
    assert "counting trials" in shown
    assert "3/3" in shown


def test_work_that_tells_itself_is_followed(terminal, capsys):
    with follow_progress("drawing", 70) as follow:
        follow(20)
        follow(41)
    shown = capsys.readouterr().err
    assert "drawing" in shown
    assert "41/70" in shown


def test_quiet_silences_every_bar(terminal, capsys):
    silence_progress()
    with follow_progress("drawing", 7) as follow:
        follow(list(track_progress([3, 5], "counting"))[1])
    assert capsys.readouterr().err == ""


def test_no_bar_is_written_to_a_file(terminal, monkeypatch, capsys):
    monkeypatch.delenv("FORCE_COLOR")
    assert list(track_progress(iter("ab"), "reading", total=2)) == ["a", "b"]
    assert capsys.readouterr().err == ""
