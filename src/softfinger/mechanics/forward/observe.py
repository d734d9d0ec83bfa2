"""What the camera makes of the joint angles: scale, kinematic coupling, lens.

    q_seen = q (1 + b) + b₃ q³ + Σ_k K_jk (q_k − q_ini,k) + Δ_j − Δ_{j−1}
    Δ_i = 2 κ (p_i·t_i)(p_i·n_i) + a sin 2θ_i + s cos 2θ_i

with θ_i the direction of link i from the base, t_i along and n_i across it, and p_i the middle of
its markers from the optical centre: the turn of a short line under the distortion p (1 + κ p²),
to first order in κ, and under unequal scales along two axes (a, s).
"""

import math

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.forward.modes import Q_INI
from softfinger.mechanics.forward.slots import CHAIN_SLOTS, COUPLING_SLOTS, JOINT_SLOTS
from softfinger.mechanics.forward.work import HAS_LENS, Model

_SCALE, _CUBIC = JOINT_SLOTS.index("angle_scale"), JOINT_SLOTS.index("angle_cubic")
_KINEMATIC = COUPLING_SLOTS.index("coupling_kinematic")
_RADIAL = CHAIN_SLOTS.index("lens_radial")
_ASPECT, _SKEW = CHAIN_SLOTS.index("lens_aspect"), CHAIN_SLOTS.index("lens_skew")
_ALONG, _ACROSS = CHAIN_SLOTS.index("lens_along"), CHAIN_SLOTS.index("lens_across")


@compiled
def observe(
    model: Model,
    link_length: NDArray,
    middle: NDArray,
    centre: NDArray,
    angle: NDArray,
    gradient: NDArray,
) -> None:
    """Turn joint angles (joint, n) and tangents (joint, n, column) into seen ones, in place.

    `link_length` (joint,), `middle` (1 + joint,) of the markers along base and links, optical
    `centre` (2,) from the first joint, along and across the base [m].
    """
    joints, frames, columns = gradient.shape
    turn, by_turn = np.zeros(joints + 1), np.zeros((joints + 1, joints))
    unit = np.zeros((joints + 1, 5))  # by radial, aspect, skew, the centre along and across
    before = np.zeros((joints, columns))
    for frame in range(frames):
        q = angle[:, frame].copy()
        _fill_turns(model, link_length, middle, centre, q, turn, by_turn, unit)
        before[:] = gradient[:, frame]
        for j in range(joints):
            scale, cubic = model.joint[j, _SCALE], model.joint[j, _CUBIC]
            seen = q[j] * (1.0 + scale + cubic * q[j] * q[j]) + turn[j + 1] - turn[j]
            for c in range(columns):
                change = before[j, c] * (1.0 + scale + 3.0 * cubic * q[j] * q[j])
                change += q[j] * model.d_joint[c, j, _SCALE]
                change += q[j] ** 3 * model.d_joint[c, j, _CUBIC]
                change += (unit[j + 1, 0] - unit[j, 0]) * model.d_chain[c, _RADIAL]
                change += (unit[j + 1, 1] - unit[j, 1]) * model.d_chain[c, _ASPECT]
                change += (unit[j + 1, 2] - unit[j, 2]) * model.d_chain[c, _SKEW]
                change += (unit[j + 1, 3] - unit[j, 3]) * model.d_chain[c, _ALONG]
                change += (unit[j + 1, 4] - unit[j, 4]) * model.d_chain[c, _ACROSS]
                gradient[j, frame, c] = change
            for k in range(joints):
                coupling = model.coupling[_KINEMATIC, j, k]
                moved = q[k] - model.joint[k, Q_INI]
                seen += coupling * moved
                slope = coupling + by_turn[j + 1, k] - by_turn[j, k]
                for c in range(columns):
                    change = slope * before[k, c] - coupling * model.d_joint[c, k, Q_INI]
                    change += moved * model.d_coupling[c, _KINEMATIC, j, k]
                    gradient[j, frame, c] += change
            angle[j, frame] = seen


@compiled
def _fill_turns(
    model: Model,
    link_length: NDArray,
    middle: NDArray,
    centre: NDArray,
    q: NDArray,
    turn: NDArray,
    by_turn: NDArray,
    unit: NDArray,
) -> None:
    """Write Δ of base and links, its derivatives by joint angles and (κ, a, s, centre)."""
    radial, aspect, skew = model.chain[_RADIAL], model.chain[_ASPECT], model.chain[_SKEW]
    direction, place = np.zeros(q.size + 1), np.zeros((q.size + 1, 2))
    by_turn[:] = 0.0
    for i in range(q.size + 1):
        if i == 0:
            place[0, 0] = -centre[0] - model.chain[_ALONG]
            place[0, 1] = -centre[1] - model.chain[_ACROSS]
        else:
            length = link_length[i - 2] if i > 1 else 0.0
            direction[i] = direction[i - 1] + q[i - 1]
            place[i, 0] = place[i - 1, 0] + length * math.cos(direction[i - 1])
            place[i, 1] = place[i - 1, 1] + length * math.sin(direction[i - 1])
        cosine, sine = math.cos(direction[i]), math.sin(direction[i])
        along = place[i, 0] * cosine + place[i, 1] * sine + middle[i]
        across = place[i, 1] * cosine - place[i, 0] * sine
        if not model.groups[HAS_LENS]:  # of which the places of the markers may be unknown
            along, across = 0.0, 0.0
        unit[i, 0] = 2.0 * along * across
        unit[i, 1], unit[i, 2] = 2.0 * sine * cosine, 1.0 - 2.0 * sine * sine
        unit[i, 3] = 2.0 * radial * (sine * along - cosine * across)
        unit[i, 4] = -2.0 * radial * (cosine * along + sine * across)
        turn[i] = radial * unit[i, 0] + aspect * unit[i, 1] + skew * unit[i, 2]
        twist = 0.0
        if model.groups[HAS_LENS]:
            twist = 2.0 * radial * (across * across - along * (along - middle[i]))
        twist += 2.0 * aspect * unit[i, 2] - 2.0 * skew * unit[i, 1]
        for k in range(i):
            by_turn[i, k] += twist
            for m in range(k + 1, i if model.groups[HAS_LENS] else 0):  # links carry it sideways
                lean = direction[i] - direction[m]
                rise = math.cos(lean) * along + math.sin(lean) * across
                by_turn[i, k] += 2.0 * radial * link_length[m - 1] * rise
