"""Other protocols within the same rig's limits."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from softfinger.rig.profiles import Profile, Steps, Triangle

LEVELS = (0.4, 0.6, 0.8, 1.0)  # of the peak
STAIRS = (0.35, 0.7, 1.0, 0.6, 0.3, 0.9)


def propose_profiles(peak: float, duration: float) -> dict[str, list[Profile]]:
    """Protocols of one trial length [s] and peak [N].

    Examples
    --------
    >>> proposed = propose_profiles(8.0, 30.0)
    >>> {name: len(profiles) for name, profiles in proposed.items()}
    {'step': 1, 'levels': 4, 'staircase': 1, 'triangle': 1}
    >>> {float(p.build_knots()[0][-1]) for profiles in proposed.values() for p in profiles}
    {30.0}
    """
    step = Steps(name="step", shape="steps", levels_n=[peak], hold_s=duration)
    levels = [
        Steps(
            name=f"level_{number}",
            shape="steps",
            levels_n=[round(share * peak, 3), 0.0],
            hold_s=duration / 2,
        )
        for number, share in enumerate(LEVELS, start=1)
    ]
    stairs = [round(share * peak, 3) for share in STAIRS]
    staircase = Steps(
        name="staircase", shape="steps", levels_n=stairs, hold_s=duration / len(stairs)
    )
    triangle = Triangle(
        name="triangle", shape="triangle", peak_n=peak, rise_s=duration / 4, cycles=2
    )
    return {"step": [step], "levels": levels, "staircase": [staircase], "triangle": [triangle]}


def stack_knots(profiles: Sequence[Profile]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Profiles' [s], [N] (profile, knot), last repeated."""
    knots = [profile.build_knots() for profile in profiles]
    longest = max(time.size for time, _ in knots)
    time, tension = (
        np.stack([np.pad(pair[k], (0, longest - pair[k].size), mode="edge") for pair in knots])
        for k in (0, 1)
    )
    return time, tension


def measure_reach(profiles: Sequence[Profile]) -> tuple[float, float]:
    """Largest tension [N] and longest time [s] of profiles."""
    time, tension = stack_knots(profiles)
    return float(tension.max()), float(time.max())


def describe_profiles(profiles: Sequence[Profile]) -> list[Mapping[str, object]]:
    """The list under ``profiles:`` in a plan."""
    return [profile.model_dump(mode="json") for profile in profiles]
