import errno

import pytest

from softfinger.failure import describe_failure
from softfinger.faults import Fault


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (Fault("a\0b"), r"a\x00b"),
        (
            OSError(errno.ENOSPC, "No space left on device", "a.nc"),
            "a.nc: No space left on device; make room, or choose another folder",
        ),
        (
            OSError(errno.EIO, "Input/output error"),
            "output: Input/output error; choose another place",
        ),
        (
            MemoryError("738 GiB"),
            "not enough memory (738 GiB); use fewer trials or frames, or more memory",
        ),
    ],
)
def test_faults_of_input_and_machine_are_sentences(error, said):
    assert describe_failure(error) == said


def test_the_unexpected_goes_into_a_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    try:
        {}["no such key"]
    except KeyError as error:
        said = describe_failure(error)
    (file,) = tmp_path.glob("softfinger-error-*.txt")
    assert said == f"an unexpected error, KeyError: 'no such key'; please send {file}"
    text = file.read_text()
    assert "Traceback" in text
    assert "numpy: " in text


def test_an_arithmetic_error_hints_at_the_recordings(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert "the recordings may be degenerate" in describe_failure(ZeroDivisionError("x"))


def test_where_nothing_can_be_written_the_sentence_is_all(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "none"))
    monkeypatch.setattr("softfinger.failure.Path.cwd", lambda: tmp_path / "none")
    assert describe_failure(KeyError("x")).endswith("no report of it could be written")
