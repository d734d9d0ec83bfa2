"""The protocol document says what the code does."""

import re
from pathlib import Path

import numpy as np
import pytest

from softfinger.rig.device import Device, DeviceSettings
from softfinger.rig.messages import compute_checksum, parse_line
from softfinger.rig.rehearsal import NAMES

DOCS = Path(__file__).parents[3] / "docs/rig"
PROTOCOL = (DOCS / "protocol.md").read_text(encoding="utf-8")
FIRMWARE = (DOCS / "firmware/softfinger_rig/softfinger_rig.ino").read_text(encoding="utf-8")


def test_every_request_is_documented_and_every_documented_one_is_known():
    rows = re.findall(r"^\| `(\w+)` \|.*\| (always|idle|armed|running) \|", PROTOCOL, re.M)
    device = Device(DeviceSettings(), np.random.default_rng(1))
    assert {verb for verb, _ in rows} == set(device.verbs)
    for verb, _ in rows:
        assert f'"{verb}"' in FIRMWARE


def test_every_rehearsed_fault_is_documented():
    listed = PROTOCOL.partition("NAME happens:")[2]
    assert set(re.findall(r"`(\w+)`", listed)) - {"hello"} == set(NAMES)


@pytest.mark.parametrize("line", re.findall(r"^    [→←] (.*)$", PROTOCOL, re.M))
def test_the_examples_can_be_read(line):
    assert parse_line(line.encode()).number in (0, 4)


def test_the_check_value_is_right():
    assert compute_checksum(b"123456789") == int(
        re.search(r"`123456789` it is `(\w+)`", PROTOCOL)[1], 16
    )
