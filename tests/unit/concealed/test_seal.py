import hashlib

import pytest

from softfinger.concealed.seal import make_salt, open_seal, seal, seal_file


@pytest.fixture
def sealed(tmp_path):
    truth, salt = tmp_path / "truth.json", tmp_path / "truth.salt"
    truth.write_text('{"effects": []}')
    return truth, salt, seal_file(truth, salt)


def test_a_seal_is_the_sha256_of_truth_and_salt(sealed):
    truth, salt, digest = sealed
    expected = hashlib.sha256(truth.read_bytes() + salt.read_text().strip().encode())
    assert digest == expected.hexdigest()
    assert open_seal(truth, salt, digest) == {"effects": []}


@pytest.mark.parametrize("changed", ["truth", "salt", "digest"])
def test_a_changed_answer_breaks_the_seal(sealed, changed):
    truth, salt, digest = sealed
    if changed == "truth":
        truth.write_text('{"effects": [1]}')
    elif changed == "salt":
        salt.write_text("0" * 64)
    else:
        digest = "0" * 64
    with pytest.raises(ValueError, match="seal is broken"):
        open_seal(truth, salt, digest)


def test_salts_differ_and_hide_equal_truths():
    first, second = make_salt(), make_salt()
    assert len(first) == 64
    assert seal(b"x", first) != seal(b"x", second)
