"""Angles bent by the optics.

By a lens, a picture plane aslant, a cubic, or a free law of the direction or of the place.

Brown (1966), Photogrammetric Eng. 32, 444.
"""

import math
import re

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import (
    FREE,
    Effect,
    Form,
    Parameter,
    Setting,
    Values,
    signed,
)
from softfinger.mechanics.effects.law import Law, free_form
from softfinger.mechanics.forward.curve import combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.work import Model

AXES = ("along", "across")
CENTRE_SD_M = 0.015  # how far from the middle of the straight finger a camera may look
SLANT_SD_PER_M = 0.5  # of a camera half a metre away that is aslant by a quarter of a radian
RADIAL_SD_PER_M2 = 10.0
EDGE_M = 0.1  # where the fifth order of a lens may be as large as its third


def _declare_picture(what: str, unit: str) -> Slot:
    return Slot("chain", unit, 0.0, what, needs=("link_length", "marker_middle"))


(
    _CUBIC, _LAW, _REACH, _RADIAL, _FIFTH, _ALONG, _ACROSS, _BESIDE_ALONG, _BESIDE_ACROSS,
    _SLANT_ALONG, _SLANT_ACROSS,
) = declare(
    angle_cubic=Slot("joint", "rad^-2", 0.0, "measured angle q + b q³"),
    direction_law=Slot(
        "law", "1", 0.0, "measured direction θ (1 + law) of a link, a law of |θ|: that of joint 1"
    ),
    direction_reach=Slot(
        "chain", "rad", 1.0, "direction at which that law ends", "positive", constant=True
    ),
    lens_radial=_declare_picture("first radial distortion about the optical centre", "m^-2"),
    lens_fifth=_declare_picture("second radial distortion, of the radius's fifth order", "m^-4"),
    lens_along=_declare_picture("optical centre beyond where it is thought, along", "m"),
    lens_across=_declare_picture("optical centre beyond where it is thought, across", "m"),
    decentring_along=_declare_picture("lenses beside each other's axes, along", "m^-1"),
    decentring_across=_declare_picture("lenses beside each other's axes, across", "m^-1"),
    slant_along=_declare_picture("loss of scale towards the tip: a picture plane aslant", "m^-1"),
    slant_across=_declare_picture("loss of scale across the finger", "m^-1"),
)  # fmt: skip
_PICTURE = (
    "lens_radial", "lens_fifth", "lens_along", "lens_across", "decentring_along",
    "decentring_across", "slant_along", "slant_across",
)  # fmt: skip


@compiled
def bend_angle(model: Model, angle: NDArray, by: NDArray, seen: NDArray, gradient: NDArray) -> None:
    """An odd cubic: b q³."""
    joints, frames, columns = gradient.shape
    for j in range(joints):
        cubic = model.joint[j, _CUBIC]
        for frame in range(frames):
            q = angle[j, frame]
            seen[j, frame] += cubic * q**3
            for c in range(columns):
                change = 3.0 * cubic * q * q * by[j, frame, c]
                gradient[j, frame, c] += change + q**3 * model.d_joint[c, j, _CUBIC]


@compiled
def bend_direction(
    model: Model, angle: NDArray, by: NDArray, seen: NDArray, gradient: NDArray
) -> None:
    """The turn of each link, by a law of its direction.

    It is θ_j times a law of |θ_j|, with θ_j the sum of the angles up to j.
    """
    joints, frames, columns = gradient.shape
    law, reach = model.law[0, _LAW], model.chain[_REACH]
    for frame in range(frames):
        direction, before = 0.0, 0.0
        moved, last = np.zeros(columns), np.zeros(columns)
        for j in range(joints):
            direction += angle[j, frame]
            x = abs(direction) / reach
            weights = weigh_value(x)
            turn = direction * combine(law, weights)
            steep = combine(law, weights) + x * combine(law, weigh_slope(x))
            seen[j, frame] += turn - before
            before = turn
            for c in range(columns):
                moved[c] += by[j, frame, c]
                change = steep * moved[c] + direction * combine(model.d_law[c, 0, _LAW], weights)
                gradient[j, frame, c] += change - last[c]
                last[c] = change


@compiled
def bend_picture(
    model: Model, angle: NDArray, by: NDArray, seen: NDArray, gradient: NDArray
) -> None:
    """The turn of each link's line of markers.

    Δ_j − Δ_{j−1}, where Δ_i is the turn of a short line along link i, at p from the optical centre,
    under the distortion p + κ p r² + κ' p r⁴ + c r² + 2 p (c·p) (Brown 1966), and in a plane that
    is aslant by s (p/(1 + s·p), a perspective). With a and b the parts of p along and across the
    link, tan Δ = U / (1 + V) with

        U = 2 a b (κ + 2 κ' r²) + 2 (a c_across + b c_along) − b s_along,
        V = (3 a² + b²) κ + (5 a² + b²) r² κ' + 6 a c_along + 2 b c_across + b s_across.
    """
    joints, frames, columns = gradient.shape
    direction, place = np.zeros(joints + 1), np.zeros((joints + 1, 2))
    change, last = np.zeros(columns), np.zeros(columns)
    for frame in range(frames):
        q, before = angle[:, frame].copy(), 0.0
        last[:] = 0.0
        for i in range(joints + 1):
            _place_link(model, q, i, direction, place)
            a, b = _turn_place(model, i, direction, place)
            turn, by_a, by_b, by_turn, ratio = _distort(model, a, b, direction[i])
            for c in range(columns):
                change[c] = _distort_more(model, a, b, (by_a, by_b), ratio, direction[i], c)
            for k in range(i):
                beside, ahead = b, model.middle[i] - a  # how joint k's turn moves a and b
                for m in range(k + 1, i):  # links carry it
                    lean = direction[i] - direction[m]
                    beside += model.link_length[m - 1] * math.sin(lean)
                    ahead += model.link_length[m - 1] * math.cos(lean)
                for c in range(columns):
                    change[c] += (by_a * beside + by_b * ahead + by_turn) * by[k, frame, c]
            if i > 0:
                seen[i - 1, frame] += turn - before
                for c in range(columns):
                    gradient[i - 1, frame, c] += change[c] - last[c]
            before = turn
            last[:] = change


@compiled
def _distort(
    model: Model, a: float, b: float, direction: float
) -> tuple[float, float, float, float, tuple[float, float]]:
    """Turn of a line, and its derivatives.

    They are by a, b and the direction, and by U and V.
    """
    radial, fifth, square = model.chain[_RADIAL], model.chain[_FIFTH], a * a + b * b
    along, across = _split(model.chain[_BESIDE_ALONG], model.chain[_BESIDE_ACROSS], direction)
    slant, aside = _split(model.chain[_SLANT_ALONG], model.chain[_SLANT_ACROSS], direction)
    aslant = 2.0 * (a * b * (radial + 2.0 * fifth * square) + a * across + b * along) - b * slant
    longer = 1.0 + (3.0 * a * a + b * b) * radial + (5.0 * a * a + b * b) * square * fifth
    longer += 6.0 * a * along + 2.0 * b * across + b * aside
    size = aslant * aslant + longer * longer
    by_u, by_v = longer / size, -aslant / size
    u_a = 2.0 * (b * radial + across) + 4.0 * fifth * b * (square + 2.0 * a * a)
    u_b = 2.0 * (a * radial + along) + 4.0 * fifth * a * (square + 2.0 * b * b) - slant
    v_a = 6.0 * (a * radial + along) + 4.0 * fifth * a * (3.0 * square + 2.0 * a * a)
    v_b = 2.0 * (b * radial + across) + 4.0 * fifth * b * (square + 2.0 * a * a) + aside
    u_turn = 2.0 * (b * across - a * along) - b * aside
    v_turn = 6.0 * a * across - 2.0 * b * along - b * slant
    return (
        math.atan2(aslant, longer),
        by_u * u_a + by_v * v_a,
        by_u * u_b + by_v * v_b,
        by_u * u_turn + by_v * v_turn,
        (by_u, by_v),
    )


@compiled
def _distort_more(
    model: Model, a: float, b: float, by_place: tuple[float, float], ratio: tuple[float, float],
    direction: float, c: int,
) -> float:  # fmt: skip
    """Change of the turn with a parameter, at one place."""
    d_chain, square = model.d_chain[c], a * a + b * b
    radial, fifth = d_chain[_RADIAL], d_chain[_FIFTH]
    beyond, beside = _split(d_chain[_ALONG], d_chain[_ACROSS], direction)
    along, across = _split(d_chain[_BESIDE_ALONG], d_chain[_BESIDE_ACROSS], direction)
    slant, aside = _split(d_chain[_SLANT_ALONG], d_chain[_SLANT_ACROSS], direction)
    aslant = 2.0 * (a * b * (radial + 2.0 * fifth * square) + a * across + b * along) - b * slant
    longer = (3.0 * a * a + b * b) * radial + (5.0 * a * a + b * b) * square * fifth
    longer += 6.0 * a * along + 2.0 * b * across + b * aside
    return ratio[0] * aslant + ratio[1] * longer - by_place[0] * beyond - by_place[1] * beside


@compiled
def _split(along: float, across: float, direction: float) -> tuple[float, float]:
    """Parts of a vector along and across a direction."""
    cosine, sine = math.cos(direction), math.sin(direction)
    return along * cosine + across * sine, across * cosine - along * sine


@compiled
def _place_link(model: Model, q: NDArray, i: int, direction: NDArray, place: NDArray) -> None:
    """Write the direction of link i, and where it begins.

    That is from the optical centre; link 0 is the base.
    """
    if i == 0:
        place[0, 0] = -model.centre[0] - model.chain[_ALONG]
        place[0, 1] = -model.centre[1] - model.chain[_ACROSS]
        return
    length = model.link_length[i - 2] if i > 1 else 0.0
    direction[i] = direction[i - 1] + q[i - 1]
    place[i, 0] = place[i - 1, 0] + length * math.cos(direction[i - 1])
    place[i, 1] = place[i - 1, 1] + length * math.sin(direction[i - 1])


@compiled
def _turn_place(model: Model, i: int, direction: NDArray, place: NDArray) -> tuple[float, float]:
    """The middle of link i's markers, along and across it."""
    along, across = _split(place[i, 0], place[i, 1], direction[i])
    return along + model.middle[i], across


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.camera:
        return "nothing was filmed, and no camera is declared"
    cubic = signed("angle_cubic_per_rad2", 0.1, per="joint", floor=1e-4)
    radial = signed("lens_radial_per_m2", RADIAL_SD_PER_M2, floor=5e-3)

    def bent(values: Values) -> dict:
        return {"angle_cubic": values["angle_cubic_per_rad2"]}

    reach = float(np.sum(setting.reach))
    law = Law("direction_law", "direction_rad", reach, 0.05, terms=5)
    forms = [Form("cubic", (cubic,), bent), free_form(law, {"direction_reach": reach})]
    if setting.masses:
        centre = [Parameter(f"lens_{k}_m", 0.0, CENTRE_SD_M, starts=(0.0,)) for k in AXES]
        slant = [signed(f"slant_{k}_per_m", SLANT_SD_PER_M, floor=5e-3) for k in AXES]
        forms = [
            Form("radial", (radial,), _fill_picture),
            Form("radial_off_centre", (radial, *centre), _fill_picture),
            Form("aslant", tuple(slant), _fill_picture),
            Form("aslant_off_centre", (*slant, *centre), _fill_picture),
            *forms,
            _build_free_place((radial, *slant, *centre)),
        ]
    return forms


def _build_free_place(known: tuple[Parameter, ...]) -> Form:
    """Build the free form by place.

    It is all that Brown's lens to fifth order and a plane aslant do, about any optical centre.
    """
    fifth = signed("lens_fifth_per_m4", RADIAL_SD_PER_M2 / EDGE_M**2, floor=0.5, term=True)
    sd = RADIAL_SD_PER_M2 * CENTRE_SD_M
    beside = [signed(f"decentring_{k}_per_m", sd, floor=1e-4, term=True) for k in AXES]
    return Form(f"{FREE}_of_place", (*known, fifth, *beside), _fill_picture)


def _fill_picture(values: Values) -> dict:
    """Fill the slots, named as the parameters without units."""
    return {re.sub("(_per)?_m[24]?$", "", name): value for name, value in values.items()}


EFFECT = Effect(
    "lens_distortion",
    "the optics bend the angles",
    "measurement",
    _build_forms,
    "lens",
    hooks=(
        Hook("observe", bend_picture, _PICTURE),
        Hook("observe", bend_angle, ("angle_cubic",)),
        Hook("observe", bend_direction, ("direction_law",)),
    ),
)
