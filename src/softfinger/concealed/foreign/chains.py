"""Foreign laws of weight and mass."""

from collections.abc import Callable

from softfinger.concealed.effects import gravity, inertia
from softfinger.concealed.effects.effect import Circumstances, Dose, Move
from softfinger.concealed.foreign.law import build_law
from softfinger.concealed.physics import Physics

PAYLOAD_LINKS = 1.5  # mass at the tip, in links
ROTOR_LINKS = 0.5  # a rotor's inertia, in those of a link about its end


def _load_tip(physics: Physics) -> Physics:
    return physics._replace(payload=PAYLOAD_LINKS * physics.link_mass.mean())


def _move_centre(physics: Physics, share: float) -> Physics:
    return physics._replace(rod_centre=share * physics.rod_centre)


def _weigh(change: Callable[[Physics], Physics]) -> Move:
    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        return change(gravity.EFFECT.move(physics, dose, trial))

    return move


def _swing(change: Callable[[Physics], Physics]) -> Move:
    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        return change(physics._replace(inertia_scale=dose.strength))

    return move


def _turn_rotors(physics: Physics) -> Physics:
    link = physics.link_mass * physics.link_length**2 / 3.0
    return physics._replace(rotor=ROTOR_LINKS * link)


_TILT = {"tell": gravity.EFFECT.tell}

LAWS = (
    build_law(
        gravity.EFFECT,
        "payload",
        "a weight at the tip that nobody declared",
        move=_weigh(_load_tip),
        **_TILT,
    ),
    build_law(
        gravity.EFFECT,
        "base_heavy",
        "links whose weight lies near their proximal joint: the textbook's are as declared",
        move=_weigh(lambda physics: _move_centre(physics, 0.4)),
        **_TILT,
    ),
    build_law(
        gravity.EFFECT,
        "tip_heavy",
        "links whose weight lies near their distal end",
        move=_weigh(lambda physics: _move_centre(physics, 1.7)),
        **_TILT,
    ),
    build_law(
        inertia.EFFECT,
        "payload",
        "a mass at the tip that nobody declared",
        typical=3.0,
        largest=20.0,
        move=_swing(_load_tip),
    ),
    build_law(
        inertia.EFFECT,
        "rotor",
        "wheels at the joints, which turn with their own joint alone",
        move=_swing(_turn_rotors),
    ),
    build_law(
        inertia.EFFECT,
        "tip_heavy",
        "links whose mass lies near their distal end",
        move=_swing(lambda physics: _move_centre(physics, 1.7)),
    ),
)
