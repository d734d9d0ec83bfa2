"""What was read off files is kept, and never wrong."""

import json

import pytest

from softfinger.provenance import kept


@pytest.fixture
def begin(tmp_path, monkeypatch):
    """A process of its own, whose file is in a folder that is not there yet."""

    def start(content=None):
        monkeypatch.setattr(kept, "FILE", tmp_path / "cache" / "syntax.json")
        monkeypatch.setattr(kept, "_NEW", {})
        monkeypatch.setattr(kept.atexit, "register", lambda _: None)
        if content is not None:
            kept.FILE.parent.mkdir(exist_ok=True)
            kept.FILE.write_text(content)
        kept._open.cache_clear()
        return kept.FILE

    yield start
    kept._open.cache_clear()


def refuse():
    raise AssertionError("it was made again")


def test_an_entry_is_made_once(begin):
    file = begin()
    assert kept.look_up("a", lambda: [1, "two"]) == [1, "two"]
    kept.keep()
    assert json.loads(file.read_text()) == {"a": [1, "two"]}
    begin()
    assert kept.look_up("a", refuse) == [1, "two"]


def test_what_another_process_wrote_stays(begin):
    file = begin("{}")
    kept.look_up("a", lambda: [1])
    file.write_text('{"b": [2]}')
    kept.keep()
    assert json.loads(file.read_text()) == {"a": [1], "b": [2]}


@pytest.mark.parametrize("content", ["", "{", "[1]"])
def test_a_damaged_file_is_made_anew(begin, content):
    file = begin(content)
    assert kept.look_up("a", lambda: [1]) == [1]
    kept.keep()
    assert json.loads(file.read_text()) == {"a": [1]}


def test_a_folder_that_cannot_be_written_to_keeps_nothing(begin):
    file = begin()
    file.parent.write_text("a file in its place")
    assert kept.look_up("a", lambda: [1]) == [1]
    kept.keep()
    assert not file.exists()
