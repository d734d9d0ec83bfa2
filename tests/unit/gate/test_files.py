import os

import pytest

from softfinger.faults import Fault
from softfinger.gate import find_obstacle, read_text


def test_an_ordinary_file_has_no_obstacle(tmp_path):
    (tmp_path / "a").write_bytes(b"\xef\xbb\xbfone\r\ntwo\rthree\n")
    assert find_obstacle(tmp_path / "a") is None
    assert read_text(tmp_path / "a", 100) == "one\ntwo\nthree\n"


def test_each_obstacle_has_its_words(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "circle").symlink_to("circle")
    assert find_obstacle(tmp_path / "none") == "does not exist"
    assert find_obstacle(tmp_path / "pipe") == "is not an ordinary file"
    assert find_obstacle(tmp_path) == "is not an ordinary file"
    assert find_obstacle(tmp_path / ("x" * 5000)) == "cannot be read: File name too long"
    assert find_obstacle(tmp_path / "a\0b") is not None
    assert find_obstacle(tmp_path / "circle") is not None


def test_large_files_and_nul_are_refused(tmp_path):
    (tmp_path / "a").write_bytes(b"one\n\0")
    with pytest.raises(Fault, match="it has 5 bytes; expected at most 4"):
        read_text(tmp_path / "a", 4)
    with pytest.raises(Fault, match="line 2: contains a NUL"):
        read_text(tmp_path / "a", 5)
