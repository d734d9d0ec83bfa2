"""A plan file with loads that were computed."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from softfinger.faults import Fault
from softfinger.rig.plan import Plan
from softfinger.rig.profiles import LoadPath, Profile

TIME_DIGITS, TENSION_DIGITS = 4, 3
"""A controller takes whole µs and mN; a tenth of a ms is finer than any camera."""

SAFETY = {
    "connect_timeout_s": 5.0,
    "heartbeat_s": 0.2,
    "answer_timeout_s": 1.0,
    "stream_timeout_s": 1.0,
    "camera_timeout_s": 3.0,
    "dropped_frames_share": 0.05,
}
RECORDING = {
    "stream_rate_hz": 100,
    "lead_in_s": 0.5,
    "picture_px": [640, 480],
    "sync_light_px": [24, 24, 16, 16],
    "video_quality": 90,
}
"""What `docs/rig/plan.yaml` has, for a rig that gave no plan."""


def list_paths(loads: Sequence[Mapping[str, Any]], trials: int) -> list[Profile]:
    """Profiles of so many trials, one for each or for all.

    Parameters
    ----------
    loads
        Histories that take turns: time_s, load [N].
    """
    if len(loads) == 1:
        return [_build_path("next", loads[0])]
    return [_build_path(f"next_{k + 1}", loads[k % len(loads)]) for k in range(trials)]


def _build_path(name: str, load: Mapping[str, Any]) -> LoadPath:
    times = [round(float(time), TIME_DIGITS) for time in load["time_s"]]
    size = 10**TENSION_DIGITS
    # rounded down, so that no limit is passed
    tensions = [math.floor(float(value) * size + 1e-9) / size for value in load["load"]]
    if max(tensions) <= 0.0:
        raise Fault(
            f"--max-load: the plan pulls with less than {1 / size:g} N, the least that a "
            "controller sets; give a larger one"
        )
    return LoadPath(name=name, shape="path", time_s=times, tension_n=tensions)


def list_repeats(profiles: Sequence[Profile], trials: int) -> int:
    """How often every profile is pulled."""
    return trials if len(profiles) == 1 else 1


def build_plan(
    campaign: Mapping[str, Any], profiles: Sequence[Profile], trials: int, rest: float, load: float
) -> dict[str, Any]:
    """Build a whole plan from a campaign's description.

    Parameters
    ----------
    campaign
        Contents of ``campaign.yaml``, with a camera.
    rest, load
        Between trials [s]; the tension at which the wire is released [N].
    """
    kept = {key: campaign[key] for key in ("name", "finger", "camera")}
    kept["name"] = f"next of {kept['name']}"
    content = {
        "version": 1,
        "campaign": kept,
        "safety": {"tension_limit_n": round(1.2 * load, 3), **SAFETY},
        "recording": {
            **RECORDING,
            "rest_s": round(rest, 1),
            "repeats": list_repeats(profiles, trials),
            "order": "randomised",
            "seed": 0,
        },
        "profiles": [profile.model_dump(mode="json") for profile in profiles],
    }
    Plan.model_validate(content)
    return content
