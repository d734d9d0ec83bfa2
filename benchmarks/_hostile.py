"""What may happen to the bytes of a text file, by accident or on purpose."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Spoil = Callable[[bytes, np.random.Generator], bytes]

WORDS = [
    b"nan",
    b"inf",
    b"-1",
    b"0",
    b"1e300",
    b"1e-300",
    b"1e999",
    b"9" * 5000,
    b"0x1f",
    b"-0.0",
    b"2020-13-45",
    b"true",
    b"null",
    b"~",
    b".nan",
    b"",
    b"   ",
    b"\0",
    b"\xff\xfe",
    b"\xed\xa0\x80",
    b'"\\ud800"',
    b'"\\U00ffffffb"',
    b'"a\\x00b"',
    b"\xe2\x80\xae",
    b"\x07",
    b"'",
    b'"',
    b"&a",
    b"*a",
    b"!!int x",
    b"!!python/object:os.system x",
    b"<<",
    b"[[[[",
    b"{" * 40,
    b"../../x",
    b"/dev/zero",
    b"x" * 5000,
    b"1,5",
    b"=1+1",
    b"<script>alert(1)</script>",
    b"q1_rad",
    b"time_s",
    b"command",
]
LINES = [
    b"%YAML 1.3",
    b"---",
    b"...",
    b"? [a, b]",
    b"- - - -",
    b"a: &a [*a]",
    b"b: *a",
    b"\t",
    b",,,,,,",
    b"finger: 3",
    b"version: 2",
    b"trial_001,,,,",
    b"deep: " + b"[" * 300,
    b"#" * 3000,
]


def spoil_text(content: bytes, rng: np.random.Generator) -> bytes:
    """Spoil a file in one drawn way."""
    return SPOILS[int(rng.integers(len(SPOILS)))](content, rng)


def flip_bits(content: bytes, rng: np.random.Generator) -> bytes:
    """Flip a few bits."""
    data = bytearray(content)
    for place in rng.integers(0, max(len(data), 1), int(rng.integers(1, 6))):
        if data:
            data[place] ^= 1 << int(rng.integers(8))
    return bytes(data)


def cut(content: bytes, rng: np.random.Generator) -> bytes:
    """Cut the file short."""
    return content[: int(rng.integers(0, len(content) + 1))]


def replace_word(content: bytes, rng: np.random.Generator) -> bytes:
    """Replace a word or cell by something odd."""
    return _at_word(content, rng, lambda word: _pick(WORDS, rng))


def extend_word(content: bytes, rng: np.random.Generator) -> bytes:
    """Append something odd to a word or cell."""
    return _at_word(content, rng, lambda word: word + _pick(WORDS, rng))


def scale_column(content: bytes, rng: np.random.Generator) -> bytes:
    """Multiply a column by a power of ten, from 1e-300 to 1e300."""
    exponent = int(rng.choice([-300, -30, -9, -3, 3, 9, 30, 300]))
    rows = [line.split(b",") for line in content.split(b"\n")]
    column = int(rng.integers(max(len(rows[0]), 1)))
    for row in rows[1:]:
        if column < len(row) and row[column].strip():
            row[column] += b"e%d" % exponent
    return b"\n".join(b",".join(row) for row in rows)


def set_column(content: bytes, rng: np.random.Generator) -> bytes:
    """Give a column one value throughout."""
    rows = [line.split(b",") for line in content.split(b"\n")]
    column = int(rng.integers(max(len(rows[0]), 1)))
    value = rows[1][column] if len(rows) > 1 and column < len(rows[1]) else b"0"
    for row in rows[1:]:
        if column < len(row):
            row[column] = value
    return b"\n".join(b",".join(row) for row in rows)


def copy_column(content: bytes, rng: np.random.Generator) -> bytes:
    """Write one column over another, heading or not."""
    rows = [line.split(b",") for line in content.split(b"\n")]
    one, other = rng.integers(0, max(len(rows[0]), 1), 2)
    for row in rows[int(rng.integers(2)) :]:
        if max(one, other) < len(row):
            row[one] = row[other]
    return b"\n".join(b",".join(row) for row in rows)


def insert_line(content: bytes, rng: np.random.Generator) -> bytes:
    """Insert an odd line."""
    lines = content.split(b"\n")
    lines.insert(int(rng.integers(len(lines) + 1)), _pick(LINES, rng))
    return b"\n".join(lines)


def move_lines(content: bytes, rng: np.random.Generator) -> bytes:
    """Repeat, remove or exchange lines."""
    lines = content.split(b"\n")
    one, other = sorted(rng.integers(0, len(lines), 2).tolist())
    kind = int(rng.integers(3))
    if kind == 0:
        lines[one:one] = lines[one : other + 1]
    elif kind == 1:
        del lines[one : other + 1]
    else:
        lines[one], lines[other] = lines[other], lines[one]
    return b"\n".join(lines)


def change_ends(content: bytes, rng: np.random.Generator) -> bytes:
    """Change line ends or the encoding."""
    kind = int(rng.integers(5))
    if kind < 3:
        return content.replace(b"\n", (b"\r\n", b"\r", b"\n\n")[kind])
    return content.decode("latin-1").encode(("utf-16", "utf-8-sig")[kind - 3])


def repeat(content: bytes, rng: np.random.Generator) -> bytes:
    """Repeat the content many times."""
    return content * int(rng.choice([2, 30, 300]))


SPOILS: tuple[Spoil, ...] = (
    flip_bits, cut, replace_word, replace_word, extend_word, scale_column, set_column, copy_column,
    insert_line, move_lines, change_ends, repeat,
)  # fmt: skip


def _at_word(content: bytes, rng: np.random.Generator, change: Callable[[bytes], bytes]) -> bytes:
    places = [0]
    for place, byte in enumerate(content):
        if byte in b",: \n[]":
            places += [place, place + 1]
    places.append(len(content))
    k = int(rng.integers(len(places) - 1))
    start, end = places[k], places[k + 1]
    return content[:start] + change(content[start:end]) + content[end:]


def _pick(options: list[bytes], rng: np.random.Generator) -> bytes:
    return options[int(rng.integers(len(options)))]
