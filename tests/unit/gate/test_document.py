import pytest

from softfinger.faults import Fault
from softfinger.gate import read_document
from softfinger.gate.document import LARGEST_BYTES, MOST_VALUES


@pytest.fixture
def read(tmp_path):
    def read(text):
        path = tmp_path / "a.yaml"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_document(path)

    return read


def test_plain_values_are_read(read):
    text = "a: 1\nb: [1.5, -2e-3, {c: x}]\nd:\ne: true\nf: yes\ng: '1'\nh: 2020-13-45\ni: 0x1f\n"
    assert read(text).content == {
        "a": 1,
        "b": [1.5, -0.002, {"c": "x"}],
        "d": None,
        "e": True,
        "f": "yes",
        "g": "1",
        "h": "2020-13-45",
        "i": "0x1f",
    }


def test_a_mark_and_foreign_line_ends_change_nothing(read):
    plain = read("a: 1\nb:\n  - 2\n")
    assert read(b"\xef\xbb\xbfa: 1\r\nb:\r\n  - 2\r\n") == plain
    assert plain.lines == {(): 1, ("a",): 1, ("b",): 2, ("b", 0): 3}
    assert plain.find_line(("b", 7, "x")) == 2


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a: 1\na: 2\n", "line 2: the key 'a' appears twice"),
        ("a: &a [1]\nb: *a\n", "line 2: it contains a YAML alias"),
        ("a: &a [*a]\n", "line 1: it contains a YAML alias"),
        ('a: !!int "abc"\n', "it contains the YAML tag"),
        ("a: !!omap 3\n", "it contains the YAML tag"),
        ("a: !!python/object:os.system x\n", "it contains the YAML tag"),
        ("? [a, b]\n: 1\n", "a key is a list"),
        ("%YAML 1.3\n---\na: 1\n", "it is not YAML"),
        (f"%YAML 1.{'9' * 5000}\n---\na: 1\n", "it is not YAML"),
        ("%TAG ! tag:x,2000:\n---\na: 1\n", "it begins with a directive"),
        ("a: 1\n---\nb: 1\n", "line 2: a second document begins"),
        ('a: "\\U00ffffffb"\n', "it is not YAML"),
        ('a: "x\\x00y"\n', r"'x\x00y' contains a character that cannot be printed"),
        ('a: "\\ud800"\n', r"'\ud800' contains a character that cannot be printed"),
        (b"a: \0\n", "line 1: contains a NUL"),
        (b"a: \xff\n", "byte 3 is not UTF-8"),
        ("a: " + "9" * 5000, "a text has 5000 characters"),
        ("a: " + "9" * 40, "expected at most 9.0072e+15"),
        ("a: 1e999", "the number is '1e999'; expected a finite one"),
        ("a: .nan", "expected a finite one"),
        ("- 1\n", "expected keys and values"),
        ("", "expected keys and values"),
        ("a: [}", "it is not YAML"),
        ("a: " + "[" * 1000, "nests keys or lists deeper than 20 times"),
        ("- " * 100_000, "nests keys or lists deeper than 20 times"),
        ("a: [" + "1," * MOST_VALUES + "1]", "it has more than 20000 values"),
        ("# " + "x" * LARGEST_BYTES, "expected at most 250000"),
    ],
)
def test_what_is_no_plain_document_is_one_sentence(read, text, said):
    with pytest.raises(Fault) as fault:
        read(text)
    assert said in str(fault.value)
    assert str(fault.value).isprintable()
