import re

from hypothesis import given, settings
from hypothesis import strategies as st

from softfinger.report.formatting import SUPERSCRIPTS, format_interval, format_measure
from softfinger.report.page import set_symbols
from softfinger.report.publication import escape_tex

BACK = {place: chr(letter) for letter, place in SUPERSCRIPTS.items()}
values = st.floats(1e-7, 1e7) | st.floats(-1e7, -1e-7)


def read_numbers(text):
    """Numbers of a text as they would be read back, its common power of ten taken in."""
    body, _, power = text.partition("× 10")
    scale = 10.0 ** int(power.translate(BACK)) if power else 1.0
    numbers = re.findall(r"−?\d+(?:\.\d+)?", body)
    return [float(number.replace("−", "-")) * scale for number in numbers]


@settings(deadline=None)
@given(value=values, relative=st.floats(1e-4, 3.0))
def test_what_is_read_differs_from_what_was_meant_by_little_of_the_error(value, relative):
    sd = abs(value) * relative
    shown, shown_sd = read_numbers(format_measure(value, sd))
    assert abs(shown - value) <= 0.15 * sd + 1e-12 * abs(value)
    assert 0.85 <= shown_sd / sd <= 1.15


@settings(deadline=None)
@given(low=values, width=st.floats(1e-3, 10.0))
def test_intervals_are_read_back_within_a_tenth_of_their_width(low, width):
    high = low + abs(low) * width
    shown = read_numbers(format_interval(low, high))
    assert abs(shown[0] - low) <= 0.1 * (high - low)
    assert abs(shown[1] - high) <= 0.1 * (high - low)


@settings(deadline=None)
@given(st.text())
def test_no_word_from_outside_opens_a_tag(words):
    shown = str(set_symbols(words))
    assert not re.search(r"<(?!/?(?:i|sub)>)", shown)


@settings(deadline=None)
@given(st.text(alphabet="\\{}&%$#_~^ab k_v", max_size=30))
def test_no_word_from_outside_commands_latex(words):
    shown = escape_tex(words)
    for known in (r"\textbackslash{}", r"\textasciitilde{}", r"\textasciicircum{}", "$k_{v}$"):
        shown = shown.replace(known, "")
    assert not re.search(r"(?<!\\)[{}&%$#_~^]", shown)
