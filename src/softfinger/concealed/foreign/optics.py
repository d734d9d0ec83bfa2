"""Foreign laws of lenses and of play."""

from collections.abc import Callable

import numpy as np

from softfinger.concealed.effects import joint_play, lens_distortion
from softfinger.concealed.effects.effect import Array, Circumstances, Dose, Record
from softfinger.concealed.effects.lens_distortion import look_through
from softfinger.concealed.foreign.law import build_law
from softfinger.concealed.rig import Rig


def _lens(bend: Callable[[Array, float], Array]) -> Record:
    """Build a lens that moves what it shows.

    It shows a place at bend(place, strength), places from its axis [m].
    """

    def record(angle: Array, time: Array, dose: Dose, trial: Circumstances, rig: Rig) -> Array:
        return look_through(angle, rig, lambda place: bend(place, dose.strength))

    return record


def _orthographic(place: Array, strength: float) -> Array:
    """Radius f sin(r/f), f² the inverse of the strength."""
    radius = np.linalg.norm(place, axis=-1, keepdims=True)
    turned = np.sqrt(max(strength, 1e-12)) * radius
    return place * np.sinc(turned / np.pi)


def _moustache(place: Array, strength: float) -> Array:
    """Barrel near the axis and pincushion far from it."""
    square = (place**2).sum(axis=-1, keepdims=True)
    return place * (1.0 - strength * square + 1.5 * strength * square**2 / 0.045**2)


def _keystone(place: Array, strength: float) -> Array:
    """A picture plane aslant: a smaller far side."""
    return place / (1.0 + 0.25 * strength * place[..., :1])


def _decentred(place: Array, strength: float) -> Array:
    """Lenses beside each other's axes: Brown's tangential distortion along the finger."""
    square = (place**2).sum(axis=-1, keepdims=True)
    along, across = place[..., :1], place[..., 1:]
    turned = np.concatenate([square + 2.0 * along**2, 2.0 * along * across], axis=-1)
    return place + 0.1 * strength * turned


def _backlash(angle: Array, time: Array, dose: Dose, trial: Circumstances, rig: Rig) -> Array:
    """The link follows after play of the strength."""
    seen = angle.copy()
    half = 0.5 * dose.strength
    for j in dose.joints:
        centre = angle[0, j]
        for k, at in enumerate(angle[:, j]):
            centre = min(max(centre, at - half), at + half)
            seen[k, j] = centre
    return seen


def _taken_up(share: Callable[[Array], Array]) -> Record:
    """Build play, of which share(tension) is taken up."""

    def record(angle: Array, time: Array, dose: Dose, trial: Circumstances, rig: Rig) -> Array:
        taken = share(trial.load.value(time))
        return angle + taken[:, None] * dose.spread(angle.shape[1])

    return record


LAWS = (
    build_law(
        lens_distortion.EFFECT,
        "orthographic",
        "an orthographic fisheye: a sine, where the textbook has the first power of r²",
        record=_lens(_orthographic),
    ),
    build_law(
        lens_distortion.EFFECT,
        "moustache",
        "barrel inside and pincushion outside",
        typical=4.0,
        largest=12.0,  # a fifth at 75 mm, a finger long: no camera does more
        record=_lens(_moustache),
    ),
    build_law(
        lens_distortion.EFFECT,
        "keystone",
        "a picture plane that is aslant: no radius about an axis does the same",
        typical=8.0,
        largest=40.0,
        record=_lens(_keystone),
    ),
    build_law(
        lens_distortion.EFFECT,
        "decentred",
        "lenses beside each other's axes: a distortion that is not radial",
        typical=8.0,
        largest=40.0,
        record=_lens(_decentred),
    ),
    build_law(
        joint_play.EFFECT,
        "backlash",
        "play on both sides, taken up again at each turn of the motion",
        record=_backlash,
    ),
    build_law(
        joint_play.EFFECT,
        "gradual",
        "play that is taken up little by little, with no dead band's end",
        record=_taken_up(lambda tension: tension / (tension + 2.0)),
    ),
    build_law(
        joint_play.EFFECT,
        "threshold",
        "play that is taken up about one tension",
        record=_taken_up(lambda tension: 1.0 / (1.0 + np.exp(-(tension - 3.0) / 0.4))),
    ),
)
