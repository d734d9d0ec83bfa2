import os
import select
import threading
import time
import tty
from contextlib import contextmanager

import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.rig.controller import connect_controller
from softfinger.rig.device import Device, DeviceSettings
from softfinger.rig.messages import LineAssembler, format_message
from softfinger.rig.plan import Plan
from softfinger.settings import read_settings


@contextmanager
def serve(answer):
    """A port at whose other end `answer(bytes)` is asked again and again for what to say."""
    master, slave = os.openpty()
    tty.setraw(slave)
    ended = threading.Event()

    def loop():
        while not ended.is_set():
            readable = select.select([master], [], [], 0.01)[0]
            os.write(master, answer(os.read(master, 4096) if readable else b""))

    thread = threading.Thread(target=loop)
    thread.start()
    try:
        yield os.ttyname(slave)
    finally:
        ended.set()
        thread.join()
        os.close(master)
        os.close(slave)


class Bench:
    """A device in real time that says `noise` before its first answer."""

    def __init__(self, noise=b"", **settings):
        self.device = Device(DeviceSettings(**settings), np.random.default_rng(2))
        self.noise = noise
        self._lines = LineAssembler()
        self._began = time.monotonic()

    def __call__(self, received):
        now = time.monotonic() - self._began
        said = self.device.advance(now, now)
        for line in self._lines.feed(received):
            said += self.device.receive(line, now, now)
        text = b"".join(map(format_message, said))
        if text:
            text, self.noise = self.noise + text, b""
        return text


@pytest.fixture
def plan(plan_values) -> Plan:
    """For a device in a thread of a busy test."""
    plan_values["safety"] |= {"answer_timeout_s": 20.0, "stream_timeout_s": 20.0}
    return read_settings(Plan, plan_values, "plan")


@pytest.fixture
def quick_plan(plan_values) -> Plan:
    plan_values["safety"] |= {"connect_timeout_s": 0.2}
    return read_settings(Plan, plan_values, "plan")


def connect(port, plan):
    with connect_controller(port, plan) as controller:
        return controller.identity


def test_a_silent_port_is_no_controller(quick_plan):
    with (
        serve(lambda _: b"") as port,
        pytest.raises(Fault, match=r"did not answer 'hello' within 0.2 s"),
    ):
        connect(port, quick_plan)


def test_a_port_that_talks_of_something_else_is_no_controller(quick_plan):
    with (
        serve(lambda _: b"$GPGGA,123519,4807.038,N\r\n") as port,
        pytest.raises(Fault, match=r"something answers, but not in the rig's protocol.*\$GPGGA"),
    ):
        connect(port, quick_plan)


def test_what_a_controller_says_while_it_boots_is_skipped(plan):
    bench = Bench(noise=b"rst:0x1 (POWERON)\xff\xfe\r\n0 sample n=5*0000\n")
    with serve(bench) as port:
        identity = connect(port, plan)
    assert identity.device == "softfinger-simulator"
    assert identity.limit_n == 20.0
    assert bench.device.state == "idle"


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"hard_limit_n": 11.0}, "tension_limit_n is 12 N, but the controller allows 11 N"),
        ({"watchdog_s": 0.5}, "watchdog of 0.5 s needs at most a third"),
        ({"max_rate_hz": 99}, "samples at 99 Hz at most"),
        ({"max_knots": 96}, "'swing' has 97 knots, but the controller stores at most 96"),
    ],
)
def test_a_plan_beyond_the_controllers_powers_is_refused(plan, settings, said):
    with (
        serve(Bench(**settings)) as port,
        pytest.raises(Fault, match=f"{said}.*; the wire is released"),
    ):
        connect(port, plan)


def test_a_refusal_is_told_in_the_controllers_words(plan):
    with (
        serve(Bench(watchdog_s=30.0)) as port,
        pytest.raises(Fault, match=r"refused 'knot': why tension_beyond_limit, limit_mn 12000"),
        connect_controller(port, plan) as controller,
    ):
        controller.arm((np.array([0.0]), np.array([12.5])), 100)


def test_any_error_inside_lets_the_wire_go(plan):
    bench = Bench(watchdog_s=30.0)

    def pull_and_stumble(port):
        with connect_controller(port, plan) as controller:
            controller.arm((np.array([0.0, 99.0]), np.array([5.0, 5.0])), 100)
            controller.start()
            assert bench.device.state == "running"
            raise ZeroDivisionError

    with serve(bench) as port, pytest.raises(ZeroDivisionError):
        pull_and_stumble(port)
    assert bench.device.state == "idle"
    assert bench.device.load_tension[-1] == 0.0


def test_an_earlier_release_is_not_blamed_on_a_later_pull(plan):
    with serve(Bench(watchdog_s=30.0)) as port, connect_controller(port, plan) as controller:
        for _ in range(2):
            controller.arm((np.array([0.0, 99.0]), np.array([5.0, 5.0])), 100)
            controller.start()
            controller.watch()
            controller.release()
