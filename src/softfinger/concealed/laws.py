"""The proof's own laws of a joint, compiled.

None is shared with the forward model under test.

The state that they depend on is laid out in `motion`.
"""

from __future__ import annotations

import numpy as np

from softfinger.compiled import compiled
from softfinger.concealed.arrays import Array
from softfinger.concealed.physics import Physics

Place = tuple[int, int, int, int, int, int, int, int]

FRICTION_TENSION_N = 6.0  # at which the coefficient of friction has its stated value
# Arguments of the tables at their last point, or half-way along them.
ANGLE_SPAN_RAD, RATE_MIDDLE, TORQUE_MIDDLE_NM = 2.5, 1.0, 0.02


@compiled(forceinline=True)
def look_up(row: Array, share: float) -> float:
    """Value of a table, interpolated.

    The place is a share of the table's length; cubics (Catmull and Rom) interpolate.
    """
    last = row.size - 1
    x = min(max(share, 0.0), 1.0) * last
    i = min(int(x), last - 1)
    a, b, u = row[i], row[i + 1], x - i
    before = row[i - 1] if i > 0 else 2.0 * a - b
    after = row[i + 2] if i + 2 <= last else 2.0 * b - a
    slopes = (1.0 - u) * 0.5 * (b - before) - u * 0.5 * (after - a)
    return a + u * u * (3.0 - 2.0 * u) * (b - a) + u * (1.0 - u) * slopes


@compiled(forceinline=True)
def read_state(state: Array, start: int, following: int, j: int) -> float:
    """Optional state of a joint; 0 where off."""
    return state[start + j] if following > start else 0.0


@compiled(forceinline=True)
def rub(tension: float, drag: float, power: float) -> float:
    """Tension that remains after friction.

    With the pressure's power: dT/dβ = -μ T₀ (T/T₀)^power.
    """
    flat = 1.0 - power
    if flat < 1e-9:
        return tension * np.exp(-drag)  # capstan
    left = (max(tension, 0.0) / FRICTION_TENSION_N) ** flat - flat * drag
    return FRICTION_TENSION_N * max(left, 0.0) ** (1.0 / flat)


@compiled(forceinline=True)
def share_torque(p: Physics, j: int, i: int, angle: Array) -> float:
    """Torque through what lies between two joints."""
    shared = 0.0
    if p.coupling[j, i] != 0.0:
        slack = np.tanh((angle[i] - p.q_ini[i]) / 0.6)  # a skin that slackens as it is bent
        shared += p.coupling[j, i] * 0.6 * slack
    if p.membrane[j, i] != 0.0:
        apart = angle[j] - p.q_ini[j] - angle[i] + p.q_ini[i]
        strained = look_up(p.membrane_law[0], abs(apart) / ANGLE_SPAN_RAD)
        shared -= p.membrane[j, i] * np.copysign(strained, apart)
    return shared


@compiled(forceinline=True)
def stretch(p: Physics, place: Place, j: int, torque: float, state: Array) -> float:
    """Rate of a Voigt element.

    Its spring locks, softens or sets; its damper thins.
    """
    strain, largest = state[j], read_state(state, place[2], place[3], j)
    warm = read_state(state, place[5], place[6], j)
    elastic = strain
    if p.plastic[j] != 0.0:
        elastic -= p.plastic[j] * max(largest - p.plastic_from, 0.0)
    spring = p.k_v[j] * elastic
    if p.stiffening[j] != 0.0:
        spring /= 1.0 - min(p.stiffening[j] * strain * strain, 0.95)
    if p.mullins[j] != 0.0:
        spring *= 1.0 - p.mullins[j] * (1.0 - np.exp(-largest / 0.2))
    if p.spring_law.size:
        spring *= 1.0 + look_up(p.spring_law[j], abs(strain) / ANGLE_SPAN_RAD)
    if p.softening[j] != 0.0:
        spring *= 1.0 - p.softening[j] * warm
    rate = (torque - spring) / p.c_v[j]
    if p.thinning_out[j] != 0.0:
        rate /= 1.0 - p.thinning_out[j] * warm
    if p.damper_law.size:
        rate *= 1.0 + look_up(p.damper_law[j], abs(rate) / (abs(rate) + RATE_MIDDLE))
    if p.one_way[j] != 0.0:
        rate *= 1.0 + p.one_way[j] * 0.5 * (1.0 + np.tanh(rate / 0.05))
    return rate * (1.0 + p.thinning[j] * abs(rate))


@compiled(forceinline=True)
def flow(p: Physics, place: Place, j: int, torque: float, state: Array) -> float:
    """Rate of a dashpot.

    It yields at a soft corner, then flows more than in proportion.
    """
    size = abs(torque)
    if p.yield_torque[j] != 0.0:
        corner = 0.08 * abs(p.yield_torque[j])
        beyond = (size - p.yield_torque[j]) / corner
        at_zero = np.log1p(np.exp(-p.yield_torque[j] / corner))
        size = corner * (max(beyond, 0.0) + np.log1p(np.exp(-abs(beyond))) - at_zero)
    if p.flow_scale[j] != 0.0:
        size *= 1.0 + (abs(p.flow_scale[j]) * size) ** 1.5
    if p.flow_law.size:
        size *= 1.0 + look_up(p.flow_law[j], size / (size + TORQUE_MIDDLE_NM))
    if p.thixotropy[j] != 0.0:
        size *= 1.0 + p.thixotropy[j] * read_state(state, place[4], place[5], j)
    if p.thinning_out[j] != 0.0:
        size /= 1.0 - p.thinning_out[j] * read_state(state, place[5], place[6], j)
    return np.copysign(size, torque) / p.c_p[j]


@compiled(forceinline=True)
def _give(p: Physics, place: Place, j: int, torque: float, state: Array) -> float:
    """Rate of a joint's angle under its torque."""
    n = p.k_v.size
    rate = stretch(p, place, j, torque, state) + flow(p, place, j, torque, state)
    for e in range(p.retardation_time.size):
        rate += (p.compliance[e, j] * torque - state[2 * n + e * n + j]) / p.retardation_time[e]
    return rate


@compiled(forceinline=True)
def carry(p: Physics, place: Place, j: int, speed: float, state: Array) -> float:
    """Torque at this speed, by Newton's iteration."""
    torque = p.k_v[j] * state[j] + p.c_v[j] * speed
    for _ in range(30):
        lacking = speed - _give(p, place, j, torque, state)
        if abs(lacking) < 1e-10:
            break
        steeper = _give(p, place, j, torque + 1e-6, state) - speed + lacking
        torque += 1e-6 * lacking / steeper
    return torque
