"""Foreign laws along the wire."""

import numpy as np

from softfinger.concealed.effects import joint_coupling, moment_arm, wire_friction
from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Move
from softfinger.concealed.foreign.law import (
    Curve,
    bend_softly,
    build_law,
    show,
    tabulate_angle,
)
from softfinger.concealed.physics import Physics


def _arm(curve: Curve) -> dict[str, object]:
    """Build an arm that gains s · curve(angle)."""
    row = tabulate_angle(curve)

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        return physics._replace(arm_law=dose.strength * np.tile(row, (physics.k_v.size, 1)))

    return {"move": move, **show("joint_angle_rad", curve)}


def _rub(curve: Curve, back: float = 1.0) -> Move:
    """Build capstan friction over curve(angle), weaker let go."""
    row = tabulate_angle(curve)

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        return physics._replace(
            friction=np.full_like(physics.k_v, dose.strength),
            friction_width=dose.shape["width_rad"],
            friction_back=back,
            drag_law=row[None],
        )

    return move


def _join(curve: Curve) -> Move:
    """Build a membrane between two joints.

    Its torque is a share of their stiffness times curve(difference).
    """
    row = tabulate_angle(curve)

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        first, second = dose.joints
        membrane = physics.membrane.copy()
        stiffness = np.sqrt(physics.k_v[first] * physics.k_v[second])
        membrane[first, second] = membrane[second, first] = dose.strength * stiffness
        return physics._replace(membrane=membrane, membrane_law=row[None])

    return move


def _membrane(why: str, law: str, curve: Curve) -> Effect:
    return build_law(
        joint_coupling.EFFECT,
        law,
        why,
        typical=0.2,
        largest=1.0,
        shape={},
        move=_join(curve),
    )


_WIDTH = {"width_rad": wire_friction.EFFECT.shape["width_rad"]}

LAWS = (
    build_law(
        moment_arm.EFFECT,
        "guides",
        "round guides: the arm grows as the square of the angle, not as a chord's sine",
        typical=1.0,
        largest=4.0,
        **_arm(lambda q: q**2),
    ),
    build_law(
        moment_arm.EFFECT,
        "saturating",
        "the wire leaves its guide at a small bend and then runs at a constant distance",
        typical=0.3,
        largest=1.5,
        **_arm(lambda q: np.tanh(q / 0.25)),
    ),
    build_law(
        moment_arm.EFFECT,
        "wavy",
        "the arm grows, falls and grows again, as the wire passes the edges of a bellows",
        typical=0.2,
        largest=0.8,
        **_arm(lambda q: np.sin(6.0 * q) ** 2),
    ),
    build_law(
        wire_friction.EFFECT,
        "edge",
        "an edge presses with the square of the bend: capstans count the bend itself",
        shape=_WIDTH,
        move=_rub(lambda q: 0.1 + 4.0 * q**2),
    ),
    build_law(
        wire_friction.EFFECT,
        "saturating",
        "the wire lies on its guide from a small bend on: more bend adds nothing",
        shape=_WIDTH,
        move=_rub(lambda q: 0.6 * (1.0 - np.exp(-q / 0.1))),
    ),
    build_law(
        wire_friction.EFFECT,
        "ratchet",
        "a braid rubs less when it is released than when it is pulled: one coefficient has no "
        "direction",
        shape=_WIDTH,
        move=_rub(lambda q: 0.2 + q, back=0.35),
    ),
    _membrane(
        "a torque of the difference of two angles, in proportion to each trial's own stiffness",
        "membrane",
        lambda d: d,
    ),
    _membrane(
        "a skin that pulls only where the difference is beyond its slack",
        "slack_skin",
        lambda d: bend_softly(d - 0.06, 0.01) - bend_softly(np.array(-0.06), 0.01),
    ),
    _membrane(
        "a torque of the cube of the difference",
        "cubic",
        lambda d: 20.0 * d**3 / (1.0 + 4.0 * d**2),
    ),
)
