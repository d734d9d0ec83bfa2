"""A fisheye lens, through which the markers are seen."""

from collections.abc import Callable

import numpy as np

from softfinger.concealed.effects.effect import Array, Circumstances, Dose, Effect
from softfinger.concealed.rig import Rig

AXIS_FROM_FIRST_JOINT_M = np.array([0.035, 0.012])


def _record(angle: Array, time: Array, dose: Dose, trial: Circumstances, rig: Rig) -> Array:
    """Markers as they appear through the lens.

    At a distance r from the axis they appear at f atan(r/f); the strength is 1/f² [1/m²].
    """
    focal = 1.0 / np.sqrt(max(dose.strength, 1e-12))
    return look_through(angle, rig, lambda place: _bend_light(place, focal))


def look_through(angle: Array, rig: Rig, bend: Callable[[Array], Array]) -> Array:
    """Angles as seen in a distorted picture."""
    heading = np.cumsum(angle, axis=1)
    unit = np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    link = rig.link_length[:, None] * unit
    joint = np.cumsum(link, axis=1) - link
    base = rig.base_marker[:, None] * np.array([1.0, 0.0])
    seen = [bend(base - AXIS_FROM_FIRST_JOINT_M)[None]]
    for i in range(angle.shape[1]):
        place = joint[:, i, None] + rig.link_marker[:, None] * unit[:, i, None]
        seen.append(bend(place - AXIS_FROM_FIRST_JOINT_M))
    direction = [np.arctan2(*(m[:, 1] - m[:, 0]).T[::-1]) for m in seen]
    direction[0] = np.full(len(angle), direction[0][0])
    return np.diff(np.unwrap(np.stack(direction, axis=1), axis=1), axis=1)


def _bend_light(place: Array, focal: float) -> Array:
    radius = np.linalg.norm(place, axis=-1, keepdims=True)
    return place * focal * np.arctan(radius / focal) / np.maximum(radius, 1e-12)


EFFECT = Effect(
    id="lens_distortion",
    sentence="angles bent by the optics",
    level="measurement",
    joints="chain",
    typical=20.0,
    largest=80.0,
    record=_record,
)
