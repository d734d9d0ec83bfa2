"""A foreign law: an effect by another curve."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from softfinger.concealed.effects.effect import Array, Dose, Effect
from softfinger.concealed.laws import ANGLE_SPAN_RAD, RATE_MIDDLE, TORQUE_MIDDLE_NM

POINTS = 601
Curve = Callable[[Array], Array]


def build_law(effect: Effect, law: str, why: str, **changes: Any) -> Effect:  # noqa: ANN401
    """Give an effect another law with own parameters."""
    return replace(effect, law=law, why=why, **{"tell": lambda dose, trials: {}} | changes)


def show(argument: str, curve: Curve) -> dict[str, object]:
    """Fields of an effect with a known curve.

    Its law is a factor 1 + s · curve(argument).
    """
    return {"argument": argument, "curve": lambda x, trials: curve(x)}


def tabulate_angle(curve: Curve) -> Array:
    """Table of a curve over angles [rad]."""
    return curve(np.linspace(0.0, ANGLE_SPAN_RAD, POINTS))


def tabulate_rate(curve: Curve) -> Array:
    """Table of a curve of a rate [rad/s]."""
    return curve(_stretch(RATE_MIDDLE))


def tabulate_torque(curve: Curve) -> Array:
    """Table of a curve of a torque [N m]."""
    return curve(_stretch(TORQUE_MIDDLE_NM))


def _stretch(middle: float) -> Array:
    share = np.minimum(np.linspace(0.0, 1.0, POINTS), 1.0 - 1e-6)
    return middle * share / (1.0 - share)


def act_on(dose: Dose, row: Array, joints: int) -> Array:
    """Table (joint, point) where the effect acts, scaled."""
    return np.outer(dose.spread(joints), row)


def bend_softly(x: Array, corner: float) -> Array:
    """Bend from 0 to x at a round corner.

    It is zero below 0 and x above it; its value at the far left is taken off.
    """
    return corner * np.logaddexp(0.0, x / corner)
