"""The controller: it releases the wire, whatever happens."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from softfinger.faults import Fault, Interruption
from softfinger.rig.clocks import FLASHES
from softfinger.rig.identity import Identity, check_abilities, identify_controller
from softfinger.rig.link import SerialLink
from softfinger.rig.messages import LineFault, Message
from softfinger.rig.plan import Plan
from softfinger.rig.profiles import Knots


@dataclass(frozen=True)
class Sample:
    """Controller time [s], tension [N], motor current [A]."""

    time: float
    tension: float
    current: float


class Controller:
    """A controller that is connected, identified and limited.

    `connect_controller` makes it.

    Attributes
    ----------
    identity
        What it reported of itself.
    """

    def __init__(self, link: SerialLink, plan: Plan, identity: Identity) -> None:
        self.identity = identity
        self._link = link
        self._safety = plan.safety
        self._samples: list[Sample] = []
        self._events: list[tuple[str, float]] = []
        self._next_sample = 0
        self._beat_due = 0.0
        self._last_arrival = 0.0
        self._may_pull = False

    def read_environment(self) -> dict[str, float]:
        """Read the controller's room sensors: column → value."""
        answer = self._request("environment")
        fields = {key: value for key, value in answer.fields.items() if key != "t_us"}
        try:
            return {key: float(value) for key, value in fields.items()}
        except ValueError:
            raise Fault(
                f"the controller's environment {fields} contains a value that is not a number"
            ) from None

    def flash(self, half_period: float) -> None:
        """Let the sync light flash.

        An event ``light`` gives the time of each change.
        """
        self.take_events()
        self._request("sync", flashes=FLASHES, half_us=round(half_period * 1e6))

    def arm(self, knots: Knots, rate_hz: int) -> None:
        """Send a profile; start samples and motor, untensioned."""
        self._request("clear")
        for i, (moment, tension) in enumerate(zip(*knots, strict=True)):
            t_us, tension_mn = round(moment * 1e6), round(tension * 1e3)
            self._request("knot", i=i, t_us=t_us, tension_mn=tension_mn)
        self._samples, self._next_sample = [], 0
        self.take_events()
        self._request("stream", rate_hz=rate_hz)
        self._last_arrival = time.monotonic()
        self._may_pull = True
        self._request("arm", knots=len(knots[0]))

    def start(self) -> float:
        """Start the profile; return when it started [s]."""
        return self._request("start").get_integer("t_us") / 1e6

    def watch(self) -> None:
        """Listen, feed the watchdog, and refuse what is unsafe.

        It must be called all the time.

        Raises
        ------
        Fault
            A tension above the limit, samples lost, a wire that the controller let go by itself,
            or any fault of the line.
        """
        if self._may_pull and time.monotonic() >= self._beat_due:
            self._request("heartbeat")
            self._beat_due = time.monotonic() + self._safety.heartbeat_s
        self._take(self._link.poll())
        if self._may_pull and time.monotonic() - self._last_arrival > self._safety.stream_timeout_s:
            raise Fault(
                "the controller answers, but has sent no sample of the tension for "
                f"{self._safety.stream_timeout_s:g} s; check that its load cell is connected"
            )

    def take_samples(self) -> list[Sample]:
        """Return the samples since the last time."""
        taken, self._samples = self._samples, []
        return taken

    def take_events(self) -> list[tuple[str, float]]:
        """New events: name and controller time [s]."""
        taken, self._events = self._events, []
        return taken

    def release(self) -> None:
        """Let the wire go and end the samples.

        Raises
        ------
        Fault
            The controller does not confirm it.
        """
        self._may_pull = False
        self._request("release")
        self._request("stream", rate_hz=0)
        self._take(self._link.poll())  # so that no later pull is blamed for this release

    def release_for_certain(self) -> str:
        """Release the wire, though anything may be broken.

        Returns a clause with what is known.

        The line is not trusted any more: garbage is skipped, and the request repeated.
        """
        self._link.distrust()
        self._may_pull = False
        for _ in range(3):
            try:
                self._link.request("release", self._safety.answer_timeout_s)
            except Fault:
                continue
            return "the wire is released"
        return (
            "the controller does not confirm that the wire is released; its own watchdog releases "
            f"it {self.identity.watchdog_s:g} s after the last heartbeat; look before you touch it"
        )

    def _request(self, verb: str, **fields: object) -> Message:
        return self._link.request(verb, self._safety.answer_timeout_s, **fields)

    def _take(self, messages: list[Message]) -> None:
        try:
            for message in messages:
                if message.verb == "sample":
                    self._take_sample(message)
                elif message.verb == "event":
                    self._take_event(message)
                elif message.verb == "error":
                    raise Fault("the controller could not read a line; check the cable")
        except LineFault as fault:
            raise Fault(f"port {self._link.port}: {fault}") from None

    def _take_sample(self, message: Message) -> None:
        number = message.get_integer("n")
        if number != self._next_sample:
            raise Fault(
                f"samples {self._next_sample} to {number - 1} of the tension are lost; lower "
                "recording.stream_rate_hz or check the cable"
            )
        self._next_sample += 1
        sample = Sample(
            message.get_integer("t_us") / 1e6,
            message.get_integer("tension_mn") / 1e3,
            message.get_integer("current_ma") / 1e3,
        )
        self._samples.append(sample)
        self._last_arrival = time.monotonic()
        if sample.tension > self._safety.tension_limit_n:
            raise Fault(
                f"the wire's tension is {sample.tension:.3g} N, above safety.tension_limit_n "
                f"{self._safety.tension_limit_n:g} N; find what blocks the finger or the motor"
            )

    def _take_event(self, message: Message) -> None:
        name = message.fields.get("name", "")
        if name == "released" and self._may_pull:
            self._may_pull = False
            reasons = {
                "limit": "the tension was above the limit",
                "heartbeat": "it heard no heartbeat; is this computer too busy?",
            }
            reason = message.fields.get("reason", "")
            raise Fault(f"the controller released the wire: {reasons.get(reason, reason)}")
        self._events.append((name, message.get_integer("t_us") / 1e6))


@contextmanager
def connect_controller(port: str, plan: Plan) -> Iterator[Controller]:
    """Connect to the controller.

    At the end the wire is released, whatever happens inside.

    Raises
    ------
    Fault
        No controller, a wrong one, or one that cannot do what the plan asks; and every fault or
        interruption inside, with what is known of the wire added.
    """
    with SerialLink(port) as link:
        identity = identify_controller(link, plan.safety.connect_timeout_s)
        controller = Controller(link, plan, identity)
        try:
            check_abilities(identity, plan)
            limit = round(plan.safety.tension_limit_n * 1e3)
            link.request("limit", plan.safety.answer_timeout_s, tension_mn=limit)
            yield controller
        except Fault as fault:
            raise Fault(f"{fault}; {controller.release_for_certain()}") from None
        except KeyboardInterrupt:
            raise Interruption(f"interrupted; {controller.release_for_certain()}") from None
        except BaseException:
            controller.release_for_certain()
            raise
        controller.release()
