import pytest

from softfinger.rig.messages import (
    LONGEST_LINE,
    LineAssembler,
    LineFault,
    Message,
    compute_checksum,
    parse_line,
)


def seal(body: bytes) -> bytes:
    return b"%b*%04X" % (body, compute_checksum(body))


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (b"7 start", "no checksum"),
        (b"7 start*0000", "its text gives"),
        (seal(b"seven start"), "is not 'NUMBER VERB"),
        (seal(b"7"), "is not 'NUMBER VERB"),
        (seal(b"7 knot i"), "is not 'NUMBER VERB"),
        (seal("7 knot i=\u00e9".encode()), "is not 'NUMBER VERB"),
    ],
)
def test_a_line_that_cannot_be_trusted_says_why(line, said):
    with pytest.raises(LineFault, match=said):
        parse_line(line)


@pytest.mark.parametrize("fields", [{}, {"i": "1.5"}, {"i": ""}])
def test_a_field_that_is_no_integer_says_so(fields):
    with pytest.raises(LineFault, match=r"'knot': i is .*; expected an integer"):
        Message(1, "knot", fields).get_integer("i")


def test_an_endless_line_is_handed_out_and_refused():
    lines = LineAssembler().feed(b"x" * (LONGEST_LINE + 1))
    assert len(lines) == 1
    with pytest.raises(LineFault):
        parse_line(lines[0])
