"""Foreign laws of spring torque: stiffening and stops."""

import numpy as np

from softfinger.concealed.effects import contact_stop, strain_stiffening
from softfinger.concealed.effects.effect import Circumstances, Dose, Move
from softfinger.concealed.foreign.law import (
    Curve,
    act_on,
    bend_softly,
    build_law,
    show,
    tabulate_angle,
)
from softfinger.concealed.physics import Physics

KNEE_RAD = 0.2


def _stiffen(curve: Curve) -> dict[str, object]:
    row = tabulate_angle(curve)

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        return physics._replace(spring_law=act_on(dose, row, physics.k_v.size))

    return {"move": move, **show("elastic_angle_rad", curve)}


def _stop(shape: Curve) -> Move:
    """Build a stop with its own torque law.

    The torque [N m/rad] is the strength times shape(angle beyond the stop).
    """

    def move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
        at = dose.shape["stop_angle_rad"]
        row = tabulate_angle(lambda angle: shape(angle - at) - shape(-at))
        return physics._replace(stop_law=act_on(dose, row, physics.k_v.size))

    return move


LAWS = (
    build_law(
        strain_stiffening.EFFECT,
        "plateau",
        "the stiffness rises by an S and stays: no power and no exponential has a plateau",
        typical=0.3,
        largest=2.0,
        **_stiffen(lambda y: y**4 / (y**4 + 0.25**4)),
    ),
    build_law(
        strain_stiffening.EFFECT,
        "fourth_power",
        "the textbook's powers are one and two",
        typical=0.5,
        largest=3.0,
        **_stiffen(lambda y: (y / 0.4) ** 4 / (1.0 + (y / 1.2) ** 4)),
    ),
    build_law(
        strain_stiffening.EFFECT,
        "knee",
        "stiffness is constant up to a strain and then grows in proportion",
        typical=0.3,
        largest=2.0,
        **_stiffen(lambda y: bend_softly(y - KNEE_RAD, 0.03) / KNEE_RAD),
    ),
    build_law(
        contact_stop.EFFECT,
        "foam",
        "a wall whose torque grows as an exponential, with no spring beyond any angle",
        typical=0.1,
        largest=2.0,
        move=_stop(lambda x: 0.06 * np.exp(np.minimum(x, 0.6) / 0.06)),
    ),
    build_law(
        contact_stop.EFFECT,
        "two_stages",
        "a soft rim and a hard core behind it: two springs, where the textbook has one",
        typical=0.05,
        largest=2.0,
        move=_stop(lambda x: bend_softly(x, 0.01) + 4.0 * bend_softly(x - 0.06, 0.01)),
    ),
    build_law(
        contact_stop.EFFECT,
        "crushing",
        "a stop that gives way the more it is pressed: its torque saturates",
        typical=0.2,
        largest=3.0,
        move=_stop(lambda x: 0.05 * np.tanh(bend_softly(x, 0.01) / 0.05)),
    ),
)
