"""What a controller reports, and whether it suffices."""

import time
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

from softfinger.faults import Fault
from softfinger.rig.link import SerialLink, Silence
from softfinger.rig.messages import VERSION
from softfinger.rig.plan import Plan

_HELLO_EVERY_S = 0.5


@dataclass(frozen=True)
class Identity:
    """What the controller reports of itself.

    `zero` is the time at which its clock was at 0.
    """

    device: str
    firmware: str
    simulated: bool
    limit_n: float
    max_knots: int
    max_rate_hz: int
    watchdog_s: float
    time_scale: float
    zero: datetime


def identify_controller(link: SerialLink, timeout: float) -> Identity:
    """Ask a controller what it is, for `timeout` [s].

    Raises
    ------
    Fault
        Nothing answers, not in the rig's protocol, or in another version of it.
    """
    link.discard()
    deadline = time.monotonic() + timeout
    while True:
        try:
            answer = link.request("hello", min(_HELLO_EVERY_S, timeout), version=VERSION)
            break
        except Silence:
            if time.monotonic() < deadline:
                continue
            if link.skipped is None:
                raise
            raise Fault(
                f"port {link.port}: something answers, but not in the rig's protocol: "
                f"{link.skipped}; is this the controller's port, and its firmware the rig's?"
            ) from None
    version = answer.get_integer("version")
    if version != VERSION:
        raise Fault(
            f"port {link.port}: the controller speaks version {version} of the protocol and this "
            f"program version {VERSION}; install the firmware that belongs to this program"
        )
    link.trust()
    try:
        return Identity(
            device=answer.fields["device"],
            firmware=answer.fields["firmware"],
            simulated=bool(answer.get_integer("simulated")),
            limit_n=answer.get_integer("limit_mn") / 1e3,
            max_knots=answer.get_integer("max_knots"),
            max_rate_hz=answer.get_integer("max_rate_hz"),
            watchdog_s=answer.get_integer("watchdog_ms") / 1e3,
            time_scale=float(answer.fields.get("time_scale", "1")),
            zero=datetime.now(UTC) - timedelta(microseconds=answer.get_integer("t_us")),
        )
    except (KeyError, ValueError) as error:
        raise Fault(f"port {link.port}: the controller's hello lacks {error}") from None


def check_abilities(identity: Identity, plan: Plan) -> None:
    """Refuse a plan beyond what a controller can do."""
    if plan.safety.tension_limit_n > identity.limit_n:
        raise Fault(
            f"safety.tension_limit_n is {plan.safety.tension_limit_n:g} N, but the controller "
            f"allows {identity.limit_n:g} N at most; lower it"
        )
    if 3 * plan.safety.heartbeat_s > identity.watchdog_s:
        raise Fault(
            f"safety.heartbeat_s is {plan.safety.heartbeat_s:g} s; the controller's watchdog of "
            f"{identity.watchdog_s:g} s needs at most a third of that"
        )
    if plan.recording.stream_rate_hz > identity.max_rate_hz:
        raise Fault(
            f"recording.stream_rate_hz is {plan.recording.stream_rate_hz}, but the controller "
            f"samples at {identity.max_rate_hz} Hz at most"
        )
    for profile in plan.profiles:
        knots = profile.build_knots()[0].size
        if knots > identity.max_knots:
            raise Fault(
                f"profile '{profile.name}' has {knots} knots, but the controller stores "
                f"at most {identity.max_knots}; shorten it"
            )
