"""The motor controller without port or clock.

Two times come from outside: `now` [s], which the motor, the samples and the sync light follow (it
may be accelerated), and `wall` [s], real time, which the watchdog follows: a silent recorder is as
dangerous to an accelerated finger as to a real one.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from softfinger.mechanics.load import evaluate_load_array
from softfinger.rig.messages import VERSION, LineFault, Message, parse_line

State = Literal["idle", "armed", "running", "holding"]


@dataclass(frozen=True)
class DeviceSettings:
    """What the controller is and bears."""

    hard_limit_n: float = 20.0  # what the recorder may set is below
    watchdog_s: float = 1.0
    max_knots: int = 512
    max_rate_hz: int = 1000
    time_scale: float = 1.0
    load_cell_noise_n: float = 0.01
    motor_a_per_n: float = 0.05


class Refusal(Exception):
    """A request that is answered by ``error``."""

    def __init__(self, why: str, **details: int) -> None:
        super().__init__(why)
        self.fields = {"why": why} | {key: str(value) for key, value in details.items()}


class Device:
    """The controller.

    Attributes
    ----------
    state
        ``idle``: the wire is slack; ``armed``: the motor is on, without tension; ``running``: the
        profile is pulled; ``holding``: its last tension is held.
    trial
        How often it was armed.
    load_time, load_tension
        The trial's load history so far and to come: knots in controller time [s] and [N].
    edges
        Controller times [s] at which the sync light goes on and off in turn.
    disturbance_n
        Tension that something other than the motor adds.
    ignores_limit
        A firmware at fault.
    verbs
        What it obeys.
    """

    def __init__(self, settings: DeviceSettings, rng: np.random.Generator) -> None:
        self.settings = settings
        self.state: State = "idle"
        self.trial = 0
        self.load_time, self.load_tension = np.zeros(1), np.zeros(1)
        self.edges: list[float] = []
        self.disturbance_n = 0.0
        self.ignores_limit = False
        self._rng = rng
        self._limit_n = settings.hard_limit_n
        self._knots: list[tuple[float, float]] = []
        self._sample_interval = np.inf
        self._next_sample, self._sample_number = np.inf, 0
        self._edges_told = 0
        self._fed = 0.0
        self.verbs: dict[str, Callable[[Message, float], Mapping[str, object]]] = {
            "hello": self._hello,
            "limit": self._set_limit,
            "environment": self._tell_environment,
            "sync": self._flash,
            "clear": self._clear,
            "knot": self._add_knot,
            "stream": self._stream,
            "arm": self._arm,
            "start": self._start,
            "stop": self._stop,
            "release": self._release_on_request,
            "heartbeat": lambda _message, _now: {},
        }

    def receive(self, line: bytes, now: float, wall: float) -> list[Message]:
        """Carry out a request line; answer and further lines."""
        try:
            message = parse_line(line)
        except LineFault:
            return [Message(0, "error", {"why": "unreadable_line"})]
        self._fed = wall
        said = []
        if message.verb in ("release", "hello"):
            said = self._release(now, "request")
        try:
            if message.verb not in self.verbs:
                raise Refusal("unknown_verb")
            fields = self.verbs[message.verb](message, now)
        except Refusal as refusal:
            return [*said, Message(message.number, "error", refusal.fields)]
        except LineFault:
            return [*said, Message(message.number, "error", {"why": "bad_field"})]
        answer = {"t_us": _to_micro(now)} | {key: str(value) for key, value in fields.items()}
        return [*said, Message(message.number, "ok", answer)]

    def advance(self, now: float, wall: float) -> list[Message]:
        """Advance to a time; samples, events until then."""
        said: list[tuple[float, Message]] = []
        while self._edges_told < len(self.edges) and self.edges[self._edges_told] <= now:
            time, on = self.edges[self._edges_told], 1 - self._edges_told % 2
            said.append((time, _event(time, "light", on=str(on))))
            self._edges_told += 1
        while self._next_sample <= now:
            said.append((self._next_sample, self._sample(self._next_sample)))
            self._next_sample += self._sample_interval
        if self.state == "running" and now >= self.load_time[-1]:
            self.state = "holding"
            said.append((self.load_time[-1], _event(self.load_time[-1], "finished")))
        messages = [message for _, message in sorted(said, key=lambda pair: pair[0])]
        if self.state in ("running", "holding") and not self.ignores_limit:
            tension = self.compute_tension(now)
            if tension > self._limit_n:
                messages += self._release(now, "limit", tension_mn=_to_milli(tension))
        if self.state != "idle" and wall - self._fed > self.settings.watchdog_s:
            messages += self._release(now, "heartbeat")
            self._next_sample = np.inf  # nobody listens
        return messages

    def compute_tension(self, time: float) -> float:
        """Compute the wire's tension [N] at a controller time."""
        pulled = evaluate_load_array([time], self.load_time, self.load_tension)[0]
        return float(pulled) + (self.disturbance_n if self.state in ("running", "holding") else 0.0)

    def _sample(self, time: float) -> Message:
        tension = self.compute_tension(time)
        measured = tension + self._rng.normal(0.0, self.settings.load_cell_noise_n)
        fields = {
            "n": str(self._sample_number),
            "t_us": _to_micro(time),
            "tension_mn": _to_milli(measured),
            "current_ma": _to_milli(tension * self.settings.motor_a_per_n),
        }
        self._sample_number += 1
        return Message(0, "sample", fields)

    def _release(self, now: float, reason: str, **details: str) -> list[Message]:
        if self.state == "idle":
            return []
        self._cut_load(now)
        self.load_time = np.append(self.load_time, now)
        self.load_tension = np.append(self.load_tension, 0.0)
        self.state, self.disturbance_n = "idle", 0.0
        return [_event(now, "released", reason=reason, **details)]

    def _cut_load(self, now: float) -> None:
        tension = evaluate_load_array([now], self.load_time, self.load_tension)[0]
        past = self.load_time <= now
        self.load_time = np.append(self.load_time[past], now)
        self.load_tension = np.append(self.load_tension[past], tension)

    def _require(self, *states: State) -> None:
        if self.state not in states:
            raise Refusal(f"not_while_{self.state}")

    def _hello(self, message: Message, now: float) -> dict[str, object]:
        self._next_sample = np.inf
        self._limit_n = self.settings.hard_limit_n
        return {
            "version": VERSION,
            "device": "softfinger-simulator",
            "firmware": "1.0",
            "simulated": 1,
            "limit_mn": _to_milli(self.settings.hard_limit_n),
            "max_knots": self.settings.max_knots,
            "max_rate_hz": self.settings.max_rate_hz,
            "watchdog_ms": _to_milli(self.settings.watchdog_s),
            "time_scale": f"{self.settings.time_scale:g}",
        }

    def _set_limit(self, message: Message, now: float) -> dict[str, object]:
        self._require("idle")
        limit = message.get_integer("tension_mn")
        if not 0 < limit <= self.settings.hard_limit_n * 1e3:
            raise Refusal(
                "beyond_this_controller", limit_mn=round(self.settings.hard_limit_n * 1e3)
            )
        self._limit_n = limit / 1e3
        return {}

    def _tell_environment(self, message: Message, now: float) -> dict[str, object]:
        return {"temperature_c": f"{self._rng.normal(23.0, 0.2):.2f}"}

    def _flash(self, message: Message, now: float) -> dict[str, object]:
        self._require("idle")
        half = message.get_integer("half_us") / 1e6
        # As a clock of microseconds gives them, after a pause in which the camera sees the dark.
        count = 2 * message.get_integer("flashes")
        self.edges = [round(now + half * k, 6) for k in range(1, count + 1)]
        self._edges_told = 0
        return {}

    def _clear(self, message: Message, now: float) -> dict[str, object]:
        self._require("idle")
        self._knots = []
        return {}

    def _add_knot(self, message: Message, now: float) -> dict[str, object]:
        self._require("idle")
        time, tension = message.get_integer("t_us") / 1e6, message.get_integer("tension_mn") / 1e3
        if (
            message.get_integer("i") != len(self._knots)
            or len(self._knots) >= self.settings.max_knots
        ):
            raise Refusal("wrong_number_of_knot", expected=len(self._knots))
        if time < (self._knots[-1][0] if self._knots else 0.0):
            raise Refusal("time_runs_backwards")
        if not 0.0 <= tension <= self._limit_n:
            raise Refusal("tension_beyond_limit", limit_mn=round(self._limit_n * 1e3))
        self._knots.append((time, tension))
        return {}

    def _stream(self, message: Message, now: float) -> dict[str, object]:
        rate = message.get_integer("rate_hz")
        if not 0 <= rate <= self.settings.max_rate_hz:
            raise Refusal("rate_out_of_range", max_rate_hz=self.settings.max_rate_hz)
        self._sample_interval, self._sample_number = (1 / rate if rate else np.inf), 0
        self._next_sample = now if rate else np.inf
        return {}

    def _arm(self, message: Message, now: float) -> dict[str, object]:
        self._require("idle")
        if not self._knots or message.get_integer("knots") != len(self._knots):
            raise Refusal("profile_is_not_whole", knots=len(self._knots))
        self.state = "armed"
        self.trial += 1
        self.load_time, self.load_tension = np.array([now]), np.zeros(1)
        return {}

    def _start(self, message: Message, now: float) -> dict[str, object]:
        self._require("armed")
        self.state = "running"
        self.load_time = now + np.array([time for time, _ in self._knots])
        self.load_tension = np.array([tension for _, tension in self._knots])
        if np.isfinite(self._next_sample):  # a sample falls on the very start
            self._next_sample = now
        return {}

    def _stop(self, message: Message, now: float) -> dict[str, object]:
        self._require("running")
        self._cut_load(now)
        self.state = "holding"
        return {}

    def _release_on_request(self, message: Message, now: float) -> dict[str, object]:
        return {}


def _event(time: float, name: str, **details: str) -> Message:
    return Message(0, "event", {"name": name, "t_us": _to_micro(time), **details})


def _to_micro(value: float) -> str:
    return str(round(value * 1e6))


def _to_milli(value: float) -> str:
    return str(round(value * 1e3))
