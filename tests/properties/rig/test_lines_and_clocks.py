import string

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter

from softfinger.rig.clocks import compute_flash_duration, estimate_clock_offset
from softfinger.rig.messages import LineAssembler, LineFault, Message, format_message, parse_line
from softfinger.rig.profiles import Profile

WORD = st.text(string.ascii_lowercase + "_", min_size=1, max_size=8)
VALUE = st.text(string.ascii_letters + string.digits + ".-_", max_size=10)
MESSAGE = st.builds(Message, st.integers(0, 10**6), WORD, st.dictionaries(WORD, VALUE, max_size=5))


@given(MESSAGE)
@settings(deadline=None)
def test_a_message_survives_the_line(message):
    line = format_message(message)
    assert line.endswith(b"\n")
    assert parse_line(line[:-1]) == message


@given(MESSAGE, st.data())
@settings(deadline=None)
def test_no_single_wrong_byte_goes_unnoticed(message, data):
    line = bytearray(format_message(message)[:-1])
    place = data.draw(st.integers(0, len(line) - 1))
    line[place] ^= data.draw(st.integers(1, 255))
    with pytest.raises(LineFault):
        parse_line(bytes(line))


@given(MESSAGE, st.integers(1, 10))
@settings(deadline=None)
def test_no_cut_line_is_believed(message, cut):
    with pytest.raises(LineFault):
        parse_line(format_message(message)[: -1 - cut])


@given(st.lists(MESSAGE, max_size=5), st.lists(st.integers(1, 30), min_size=1))
@settings(deadline=None)
def test_lines_are_the_same_however_the_bytes_are_dealt_out(messages, portions):
    stream, lines, assembler = b"".join(map(format_message, messages)), [], LineAssembler()
    while stream:
        for portion in portions:
            lines += assembler.feed(stream[:portion])
            stream = stream[portion:]
    assert [parse_line(line) for line in lines] == messages


@given(
    fps=st.floats(5.0, 200.0),
    ahead=st.floats(-1e4, 1e4),
    phase=st.floats(0.0, 1.0),
    begin=st.floats(0.0, 100.0),
)
@settings(deadline=None)
def test_the_clock_offset_is_within_its_uncertainty_of_the_truth(fps, ahead, phase, begin):
    half = compute_flash_duration(fps)
    edges = begin + half * np.arange(1, 9)
    frame = begin + (phase + np.arange(40)) / fps
    lit = np.searchsorted(edges, frame, side="right") % 2 == 1
    offset, uncertainty = estimate_clock_offset(frame + ahead, 40.0 + 100.0 * lit, list(edges))
    assert abs(offset - ahead) <= uncertainty + 1e-9
    assert uncertainty <= 1 / 16 / fps + 1e-9


LEVEL = st.floats(0.0, 20.0)
TIME = st.floats(0.01, 100.0)
LEVELS = st.lists(LEVEL, min_size=1, max_size=6)
COUNT = st.integers(1, 6)
PEAK = st.floats(0.1, 20.0)
SHAPES = st.one_of(
    st.fixed_dictionaries({"shape": st.just("steps"), "levels_n": LEVELS, "hold_s": TIME}),
    st.fixed_dictionaries(
        {"shape": st.just("ramps"), "levels_n": LEVELS, "ramp_s": TIME, "hold_s": TIME}
    ),
    st.fixed_dictionaries(
        {"shape": st.just("triangle"), "peak_n": PEAK, "rise_s": TIME, "cycles": COUNT}
    ),
    st.fixed_dictionaries(
        {"shape": st.just("staircase"), "peak_n": PEAK, "stairs": COUNT, "hold_s": TIME}
    ),
    PEAK.flatmap(
        lambda mean: st.fixed_dictionaries(
            {
                "shape": st.just("sine"),
                "mean_n": st.just(mean),
                "amplitude_n": st.floats(0.01, mean),
                "period_s": TIME,
                "cycles": COUNT,
            }
        )
    ),
)


@given(SHAPES)
@settings(deadline=None)
def test_every_profile_begins_at_zero_goes_forward_and_never_pushes(shape):
    time, tension = TypeAdapter(Profile).validate_python({"name": "a", **shape}).build_knots()
    assert time[0] == 0.0
    assert time.size == tension.size >= 2
    assert np.all(np.diff(time) >= 0)
    assert np.all(tension >= 0)
    said = [shape.get("peak_n", 0.0), *shape.get("levels_n", [])]
    said.append(shape.get("mean_n", 0.0) + shape.get("amplitude_n", 0.0))
    assert tension.max() == pytest.approx(max(said))
