import numpy as np
import pytest

from softfinger.rig.device import Device, DeviceSettings
from softfinger.rig.messages import Message, format_message, parse_line


class Bench:
    """A device whose two clocks are turned by hand."""

    def __init__(self, **settings):
        self.device = Device(
            DeviceSettings(**{"load_cell_noise_n": 0.0, **settings}), np.random.default_rng(1)
        )
        self.now = self.wall = 0.0
        self.number = 0

    def ask(self, verb, **fields):
        self.number += 1
        texts = {key: str(value) for key, value in fields.items()}
        line = format_message(Message(self.number, verb, texts)).rstrip()
        return self.device.receive(line, self.now, self.wall)

    def grant(self, verb, **fields):
        *_, answer = self.ask(verb, **fields)
        assert (answer.number, answer.verb) == (self.number, "ok"), answer
        return answer

    def refuse(self, verb, **fields):
        *_, answer = self.ask(verb, **fields)
        assert (answer.number, answer.verb) == (self.number, "error")
        return answer.fields["why"]

    def pass_time(self, seconds, wall=None):
        self.now += seconds
        self.wall += seconds if wall is None else wall
        return self.device.advance(self.now, self.wall)

    def load(self, *knots):
        self.grant("clear")
        for i, (time, tension) in enumerate(knots):
            self.grant("knot", i=i, t_us=round(time * 1e6), tension_mn=round(tension * 1e3))

    def run(self, *knots, rate=0):
        self.load(*knots)
        if rate:
            self.grant("stream", rate_hz=rate)
        self.grant("arm", knots=len(knots))
        self.pass_time(0.25, wall=0.0)
        self.grant("start")


def events(messages):
    return [(m.fields["name"], m.fields.get("reason")) for m in messages if m.verb == "event"]


def test_a_profile_is_pulled_measured_and_held_until_released():
    bench = Bench()
    bench.run((0, 6), (0.4, 8), rate=10)
    said = bench.pass_time(0.6)
    pulled = [m for m in said if m.verb == "sample" and m.get_integer("t_us") >= 250_000]
    assert [m.get_integer("t_us") for m in pulled] == [250_000 + 100_000 * k for k in range(7)]
    tension = [m.get_integer("tension_mn") for m in pulled]
    assert tension == [6000, 6500, 7000, 7500, 8000, 8000, 8000]
    assert pulled[-1].get_integer("current_ma") == 400
    assert events(said) == [("finished", None)]
    assert bench.device.state == "holding"
    event, answer = bench.ask("release")
    assert events([event]) == [("released", "request")]
    assert answer.get_integer("t_us") == 850_000
    assert bench.device.compute_tension(bench.now) == 0.0
    numbers = [m.get_integer("n") for m in said if m.verb == "sample"]
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))


@pytest.mark.parametrize("reached", ["armed", "running", "holding"])
def test_silence_lets_the_wire_go_in_every_state_with_power(reached):
    bench = Bench(watchdog_s=0.5)
    bench.load((0, 6), (10, 6))
    bench.grant("arm", knots=2)
    if reached != "armed":
        bench.grant("start")
    if reached == "holding":
        bench.grant("stop")
    assert bench.device.state == reached
    assert events(bench.pass_time(0.5)) == []
    bench.grant("heartbeat")
    assert events(bench.pass_time(0.5)) == []
    assert events(bench.pass_time(0.1)) == [("released", "heartbeat")]
    assert bench.device.state == "idle"
    assert bench.device.compute_tension(bench.now) == 0.0


def test_the_watchdog_follows_real_time():
    bench = Bench(watchdog_s=0.5)
    bench.run((0, 6), (100, 6))
    assert events(bench.pass_time(50.0, wall=0.4)) == []
    assert events(bench.pass_time(0.1, wall=0.2)) == [("released", "heartbeat")]


def test_garbage_does_not_feed_the_watchdog():
    bench = Bench(watchdog_s=0.5)
    bench.run((0, 6), (100, 6))
    for _ in range(3):
        bench.pass_time(0.2)
        (answer,) = bench.device.receive(b"1 heartbeat*0000", bench.now, bench.wall)
        assert (answer.number, answer.fields["why"]) == (0, "unreadable_line")
    assert bench.device.state == "idle"


def test_a_tension_above_the_limit_lets_the_wire_go():
    bench = Bench()
    bench.grant("limit", tension_mn=7000)
    bench.run((0, 6), (100, 6))
    assert events(bench.pass_time(0.1)) == []
    bench.device.disturbance_n = 1.5
    (said,) = bench.pass_time(0.1)
    assert said.fields["reason"] == "limit"
    assert said.get_integer("tension_mn") == 7500
    assert bench.device.state == "idle"


def test_limits_are_refused_before_anything_is_pulled():
    bench = Bench(hard_limit_n=10.0)
    assert bench.refuse("limit", tension_mn=10001) == "beyond_this_controller"
    assert bench.refuse("limit", tension_mn=0) == "beyond_this_controller"
    bench.grant("limit", tension_mn=7000)
    bench.grant("clear")
    assert bench.refuse("knot", i=0, t_us=0, tension_mn=7001) == "tension_beyond_limit"
    assert bench.refuse("knot", i=0, t_us=0, tension_mn=-1) == "tension_beyond_limit"
    assert bench.refuse("knot", i=1, t_us=0, tension_mn=0) == "wrong_number_of_knot"
    bench.grant("knot", i=0, t_us=5, tension_mn=7000)
    assert bench.refuse("knot", i=1, t_us=4, tension_mn=0) == "time_runs_backwards"
    assert bench.refuse("arm", knots=2) == "profile_is_not_whole"
    assert bench.refuse("start") == "not_while_idle"


@pytest.mark.parametrize(
    ("verb", "fields", "why"),
    [
        ("dance", {}, "unknown_verb"),
        ("knot", {"i": 0}, "bad_field"),
        ("stream", {"rate_hz": 1001}, "rate_out_of_range"),
        ("arm", {"knots": 0}, "profile_is_not_whole"),
        ("stop", {}, "not_while_idle"),
    ],
)
def test_nonsense_is_refused(verb, fields, why):
    assert Bench().refuse(verb, **fields) == why


def test_nothing_is_changed_while_the_motor_is_on():
    bench = Bench()
    bench.run((0, 6), (9, 6))
    for verb, fields in [
        ("clear", {}),
        ("limit", {"tension_mn": 9000}),
        ("arm", {"knots": 2}),
        ("sync", {"flashes": 1, "half_us": 1000}),
    ]:
        assert bench.refuse(verb, **fields) == "not_while_running"


def test_a_new_recorder_finds_the_wire_slack_and_the_line_quiet():
    bench = Bench()
    bench.run((0, 6), (9, 6), rate=10)
    event, hello = bench.ask("hello", version=1)
    assert events([event]) == [("released", "request")]
    assert hello.get_integer("watchdog_ms") == 1000
    assert bench.pass_time(1.0) == []


def test_stop_holds_the_tension_of_that_moment():
    bench = Bench()
    bench.run((0, 0), (2, 8))
    bench.pass_time(0.5)
    bench.grant("stop")
    bench.pass_time(0.5)
    assert bench.device.compute_tension(bench.now) == pytest.approx(2.0)


def test_the_light_flashes_after_a_pause():
    bench = Bench()
    bench.grant("sync", flashes=2, half_us=100_000)
    said = bench.pass_time(1.0)
    assert [(m.get_integer("t_us"), m.fields["on"]) for m in said] == [
        (100_000, "1"),
        (200_000, "0"),
        (300_000, "1"),
        (400_000, "0"),
    ]


def test_every_word_of_the_device_can_be_read_again():
    bench = Bench()
    bench.run((0, 6), (0.2, 6), rate=20)
    for message in [*bench.pass_time(0.5), *bench.ask("hello"), *bench.ask("environment")]:
        assert parse_line(format_message(message).rstrip()) == message
