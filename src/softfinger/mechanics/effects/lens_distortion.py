"""Angles bent by the optics.

By a lens, a picture plane aslant, a cubic, or a free law.
"""

import math

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import Effect, Form, Parameter, Setting, Values, signed
from softfinger.mechanics.effects.law import Law, free_form
from softfinger.mechanics.forward.curve import combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.work import Model

AXES = ("along", "across")
CENTRE_SD_M = 0.015  # how far from the middle of the straight finger a camera may look
SLANT_SD_PER_M = 0.5  # of a camera half a metre away that is aslant by a quarter of a radian


_CUBIC, _LAW, _REACH, _RADIAL, _ALONG, _ACROSS, _SLANT_ALONG, _SLANT_ACROSS = declare(
    angle_cubic=Slot("joint", "rad^-2", 0.0, "measured angle q + b q³"),
    direction_law=Slot(
        "law", "1", 0.0, "measured direction θ (1 + law) of a link, a law of |θ|: that of joint 1"
    ),
    direction_reach=Slot(
        "chain", "rad", 1.0, "direction at which that law ends", "positive", constant=True
    ),
    lens_radial=Slot(
        "chain", "m^-2", 0.0, "first radial distortion about the optical centre",
        needs=("link_length", "marker_middle"),
    ),
    lens_along=Slot(
        "chain", "m", 0.0, "optical centre beyond where it is thought, along",
        needs=("link_length", "marker_middle"),
    ),
    lens_across=Slot(
        "chain", "m", 0.0, "optical centre beyond where it is thought, across",
        needs=("link_length", "marker_middle"),
    ),
    slant_along=Slot(
        "chain", "m^-1", 0.0, "loss of scale towards the tip: the picture plane is aslant",
        needs=("link_length", "marker_middle"),
    ),
    slant_across=Slot(
        "chain", "m^-1", 0.0, "loss of scale across the finger",
        needs=("link_length", "marker_middle"),
    ),
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
    """The turn of each link, θ_j times a law of |θ_j|, with θ_j the sum of the angles up to j."""
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

    Δ_j − Δ_{j−1} with Δ_i = 2 κ (p_i·t_i)(p_i·n_i), with t_i along and n_i across link i and p_i
    the middle of its markers from the optical centre: the turn of a short line under the distortion
    p (1 + κ p²), to first order in κ.
    """
    joints, frames, columns = gradient.shape
    turn, by_turn = np.zeros(joints + 1), np.zeros((joints + 1, joints))
    unit = np.zeros((joints + 1, 3))  # by radial and the centre, along and across
    for frame in range(frames):
        _fill_turns(model, angle[:, frame].copy(), turn, by_turn, unit)
        for j in range(joints):
            seen[j, frame] += turn[j + 1] - turn[j]
            for c in range(columns):
                change = (unit[j + 1, 0] - unit[j, 0]) * model.d_chain[c, _RADIAL]
                change += (unit[j + 1, 1] - unit[j, 1]) * model.d_chain[c, _ALONG]
                change += (unit[j + 1, 2] - unit[j, 2]) * model.d_chain[c, _ACROSS]
                for k in range(joints):
                    change += (by_turn[j + 1, k] - by_turn[j, k]) * by[k, frame, c]
                gradient[j, frame, c] += change


@compiled
def _fill_turns(model: Model, q: NDArray, turn: NDArray, by_turn: NDArray, unit: NDArray) -> None:
    """Write Δ of base and links, and its derivatives."""
    radial = model.chain[_RADIAL]
    direction, place = np.zeros(q.size + 1), np.zeros((q.size + 1, 2))
    by_turn[:] = 0.0
    for i in range(q.size + 1):
        _place_link(model, q, i, model.chain[_ALONG], model.chain[_ACROSS], direction, place)
        along, across, cosine, sine = _turn_place(model, i, direction, place)
        unit[i, 0] = 2.0 * along * across
        unit[i, 1] = 2.0 * radial * (sine * along - cosine * across)
        unit[i, 2] = -2.0 * radial * (cosine * along + sine * across)
        turn[i] = radial * unit[i, 0]
        twist = 2.0 * radial * (across * across - along * (along - model.middle[i]))
        for k in range(i):
            by_turn[i, k] += twist
            for m in range(k + 1, i):  # links carry it sideways
                lean = direction[i] - direction[m]
                rise = math.cos(lean) * along + math.sin(lean) * across
                by_turn[i, k] += 2.0 * radial * model.link_length[m - 1] * rise


@compiled
def _place_link(
    model: Model, q: NDArray, i: int, beyond: float, aside: float, direction: NDArray,
    place: NDArray,
) -> None:  # fmt: skip
    """Write the direction of link i, and where it begins.

    That is from the optical centre; link 0 is the base.
    """
    if i == 0:
        place[0, 0], place[0, 1] = -model.centre[0] - beyond, -model.centre[1] - aside
        return
    length = model.link_length[i - 2] if i > 1 else 0.0
    direction[i] = direction[i - 1] + q[i - 1]
    place[i, 0] = place[i - 1, 0] + length * math.cos(direction[i - 1])
    place[i, 1] = place[i - 1, 1] + length * math.sin(direction[i - 1])


@compiled
def _turn_place(
    model: Model, i: int, direction: NDArray, place: NDArray
) -> tuple[float, float, float, float]:
    """The middle of link i's markers, along and across it.

    Also cosine and sine of its direction.
    """
    cosine, sine = math.cos(direction[i]), math.sin(direction[i])
    along = place[i, 0] * cosine + place[i, 1] * sine + model.middle[i]
    return along, place[i, 1] * cosine - place[i, 0] * sine, cosine, sine


@compiled
def slant_picture(
    model: Model, angle: NDArray, by: NDArray, seen: NDArray, gradient: NDArray
) -> None:
    """The turn of markers in a picture plane aslant.

    A place p is seen at p / (1 + k·p), and a short line along t turns by −(p·n)(k·t), to first
    order in k; p, t and n as in `bend_picture`.
    """
    joints, frames, columns = gradient.shape
    a, b = model.chain[_SLANT_ALONG], model.chain[_SLANT_ACROSS]
    direction, place = np.zeros(joints + 1), np.zeros((joints + 1, 2))
    change = np.zeros(columns)
    for frame in range(frames):
        q = angle[:, frame].copy()
        last, last_change = 0.0, np.zeros(columns)
        for i in range(joints + 1):
            _place_link(model, q, i, 0.0, 0.0, direction, place)
            along, across, cosine, sine = _turn_place(model, i, direction, place)
            lean = a * cosine + b * sine
            turn = -across * lean
            for c in range(columns):
                change[c] = -across * (
                    cosine * model.d_chain[c, _SLANT_ALONG] + sine * model.d_chain[c, _SLANT_ACROSS]
                )
            for k in range(i):
                sideways = model.middle[i] - along
                for m in range(k + 1, i):  # links carry it
                    between = direction[i] - direction[m]
                    sideways += model.link_length[m - 1] * math.cos(between)
                by_turn = -sideways * lean - across * (b * cosine - a * sine)
                for c in range(columns):
                    change[c] += by_turn * by[k, frame, c]
            if i > 0:
                seen[i - 1, frame] += turn - last
                for c in range(columns):
                    gradient[i - 1, frame, c] += change[c] - last_change[c]
            last = turn
            last_change[:] = change


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.camera:
        return "nothing was filmed, and no camera is declared"
    cubic = signed("angle_cubic_per_rad2", 0.1, per="joint", floor=1e-4)
    radial = signed("lens_radial_per_m2", 10.0, floor=5e-3)

    def bent(values: Values) -> dict:
        return {"angle_cubic": values["angle_cubic_per_rad2"]}

    def lens(values: Values) -> dict:
        return {"lens_radial": values["lens_radial_per_m2"]}

    def shifted_lens(values: Values) -> dict:
        place = {"lens_along": values["lens_along_m"], "lens_across": values["lens_across_m"]}
        return lens(values) | place

    def slanted(values: Values) -> dict:
        return {f"slant_{k}": values[f"slant_{k}_per_m"] for k in AXES}

    reach = float(np.sum(setting.reach))
    law = Law("direction_law", "direction_rad", reach, 0.05, terms=5)
    forms = [Form("cubic", (cubic,), bent), free_form(law, {"direction_reach": reach})]
    if setting.masses:
        centre = [Parameter(f"lens_{k}_m", 0.0, CENTRE_SD_M, starts=(0.0,)) for k in AXES]
        forms.insert(0, Form("radial", (radial,), lens))
        forms.insert(1, Form("radial_off_centre", (radial, *centre), shifted_lens))
        slant = [signed(f"slant_{k}_per_m", SLANT_SD_PER_M, floor=5e-3) for k in AXES]
        forms.insert(2, Form("aslant", tuple(slant), slanted))
    return forms


EFFECT = Effect(
    "lens_distortion",
    "the optics bend the angles",
    "measurement",
    _build_forms,
    "lens",
    hooks=(
        Hook("observe", bend_picture, ("lens_radial", "lens_along", "lens_across")),
        Hook("observe", slant_picture, ("slant_along", "slant_across")),
        Hook("observe", bend_angle, ("angle_cubic",)),
        Hook("observe", bend_direction, ("direction_law",)),
    ),
)
