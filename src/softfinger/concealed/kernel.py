"""The proof's own equations of motion and integrator, compiled: every law stands in this one file.

One file on purpose: a compiled cache is renewed only when the file itself changes, and only
textbook algebra lies elsewhere. Nothing here is shared with the forward model of the diagnosis, and
the laws differ from a fitted catalogue's.

State of a trial: strain of each joint's Voigt element (joint,), of its dashpot (joint,), of further
Voigt elements (element, joint), then, where switched on, the direction in which the wire last slid
(joint,), the lagging tension (3,), the largest strain so far (joint,), the speed (joint,).
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from softfinger.concealed.chain import accelerate_in_place, weigh_in_place
from softfinger.concealed.linear import factor_in_place, solve_in_place
from softfinger.concealed.physics import Physics

Array = NDArray[np.float64]
Place = tuple[int, int, int, int, int]
Ramp = tuple[float, float, float]  # from when, tension then, its slope

LONGEST_STEP_S = 0.25
FRICTION_TENSION_N = 6.0  # at which the coefficient of friction is what it is said to be
LAG_STAGES = (0.7, 0.2, 0.1)  # shares of the lag, in a row
COLUMNS = 4  # of the extrapolation table, hence its order


class RunawayError(ValueError):
    """An effect is stronger than the finger, which then has no rest."""


@njit(cache=True)
def _place(p: Physics) -> Place:
    """Where the optional states start: friction, lag, largest strain, speed; and the end."""
    n = p.k_v.size
    friction = 2 * n + p.compliance.size
    lag = friction + (n if np.any(p.friction != 0.0) else 0)
    strain = lag + (len(LAG_STAGES) if p.lag != 0.0 else 0)
    speed = strain + (n if np.any(p.mullins != 0.0) else 0)
    return friction, lag, strain, speed, speed + (n if p.inertia_scale != 0.0 else 0)


@njit(cache=True)
def _rest(p: Physics, place: Place) -> Array:
    """State of the unloaded finger, its weight long since borne by the springs."""
    n = p.k_v.size
    state, borne = np.zeros(place[4]), np.zeros(n)
    weigh_in_place(p, p.q_ini, borne)
    state[:n] = borne / p.k_v
    for e in range(p.retardation_time.size):
        state[2 * n + e * n : 2 * n + (e + 1) * n] = p.compliance[e] * borne
    return state


@njit(cache=True)
def _bend(p: Physics, state: Array, rest: Array, angle: Array) -> None:
    """Joint angle: the initial one plus every element's strain beyond its strain at rest."""
    n = p.k_v.size
    for j in range(n):
        angle[j] = p.q_ini[j]
        for at in range(j, 2 * n + p.compliance.size, n):
            angle[j] += state[at] - rest[at]


@njit(cache=True)
def _rub(tension: float, drag: float, power: float) -> float:
    """Tension that friction leaves of it: the pressure's power in dT/dβ = -μ T₀ (T/T₀)^power."""
    flat = 1.0 - power
    if flat < 1e-9:
        return tension * np.exp(-drag)  # capstan
    left = (max(tension, 0.0) / FRICTION_TENSION_N) ** flat - flat * drag
    return FRICTION_TENSION_N * max(left, 0.0) ** (1.0 / flat)


@njit(cache=True)
def _pull(
    p: Physics, place: Place, time: float, tension: float, state: Array, angle: Array, torque: Array
) -> None:
    """Torque on each joint from outside: wire, gravity, neighbours, stop."""
    friction, lag, strain, _, _ = place
    if strain > lag:
        tension = state[strain - 1]
    if p.ripple != 0.0:
        tension *= 1.0 + p.ripple * np.sin(p.ripple_rate * time + p.ripple_phase)
    for j in range(angle.size):
        arm = p.wire_offset
        if lag > friction:  # the wire wraps the bend and a fixed angle of its guide
            drag = p.friction[j] * (0.2 + abs(angle[j])) * state[friction + j]
            tension = _rub(tension, drag, p.friction_power)
        if p.arm_scale != 0.0:  # the wire leaves the offset line and runs along the chord
            slant = np.arctan2(2.0 * p.wire_offset, p.joint_length)
            chord = np.hypot(0.5 * p.joint_length, p.wire_offset) * np.sin(0.5 * angle[j] + slant)
            arm += p.arm_scale * (chord - p.wire_offset)
        torque[j] = tension * arm
        for i in range(angle.size):
            if p.coupling[j, i] == 0.0:
                continue
            slack = np.tanh((angle[i] - p.q_ini[i]) / 0.6)  # a skin that slackens as it is bent
            torque[j] += p.coupling[j, i] * 0.6 * slack
        if angle[j] > p.stop_angle[j] and p.stop_stiffness[j] != 0.0:  # Hertz
            torque[j] -= p.stop_stiffness[j] * (angle[j] - p.stop_angle[j]) ** 1.5
    if p.gravity_x != 0.0 or p.gravity_y != 0.0:
        weigh_in_place(p, angle, torque)


@njit(cache=True)
def _stretch(p: Physics, j: int, torque: float, strain: float, largest: float) -> float:
    """Rate of a Voigt element: its spring locks (Gent) or softened (Mullins), its damper thins."""
    spring = p.k_v[j] * strain
    if p.stiffening[j] != 0.0:
        spring /= 1.0 - min(p.stiffening[j] * strain * strain, 0.95)
    if p.mullins[j] != 0.0:
        spring *= 1.0 - p.mullins[j] * (1.0 - np.exp(-largest / 0.2))
    rate = (torque - spring) / p.c_v[j]
    return rate * (1.0 + p.thinning[j] * abs(rate))


@njit(cache=True)
def _flow(p: Physics, j: int, torque: float) -> float:
    """Rate of a dashpot: yields at a soft corner, then flows more than in proportion."""
    size = abs(torque)
    if p.yield_torque[j] != 0.0:
        corner = 0.08 * abs(p.yield_torque[j])
        beyond = (size - p.yield_torque[j]) / corner
        at_zero = np.log1p(np.exp(-p.yield_torque[j] / corner))
        size = corner * (max(beyond, 0.0) + np.log1p(np.exp(-abs(beyond))) - at_zero)
    if p.flow_scale[j] != 0.0:
        size *= 1.0 + (abs(p.flow_scale[j]) * size) ** 1.5
    return np.copysign(size, torque) / p.c_p[j]


@njit(cache=True)
def _give(p: Physics, j: int, torque: float, state: Array, largest: float) -> float:
    """Rate of a joint's angle under the torque that it carries."""
    n = p.k_v.size
    rate = _stretch(p, j, torque, state[j], largest) + _flow(p, j, torque)
    for e in range(p.retardation_time.size):
        rate += (p.compliance[e, j] * torque - state[2 * n + e * n + j]) / p.retardation_time[e]
    return rate


@njit(cache=True)
def _carry(p: Physics, j: int, speed: float, state: Array, largest: float) -> float:
    """Torque that a joint carries when it turns at this speed: Newton's iteration on `_give`."""
    torque = p.k_v[j] * state[j] + p.c_v[j] * speed
    for _ in range(30):
        lacking = speed - _give(p, j, torque, state, largest)
        if abs(lacking) < 1e-10:
            break
        steeper = _give(p, j, torque + 1e-6, state, largest) - speed + lacking
        torque += 1e-6 * lacking / steeper
    return torque


@njit(cache=True)
def _change(
    p: Physics, place: Place, ramp: Ramp, time: float, state: Array, rest: Array, change: Array
) -> None:
    """Rate of every state."""
    tension = ramp[1] + ramp[2] * (time - ramp[0])
    n = p.k_v.size
    friction, lag, strain, at_speed, end = place
    joint = np.empty((3, n))
    angle, torque, speed = joint[0], joint[1], joint[2]
    _bend(p, state, rest, angle)
    _pull(p, place, time, tension, state, angle, torque)
    if end > at_speed:
        for j in range(n):
            largest = state[strain + j] if at_speed > strain else 0.0
            carried = _carry(p, j, state[at_speed + j], state, largest)
            change[at_speed + j] = torque[j] - carried
            torque[j] = carried
        accelerate_in_place(p, angle, state[at_speed:], change[at_speed:])
    for j in range(n):
        largest = state[strain + j] if at_speed > strain else 0.0
        change[j] = _stretch(p, j, torque[j], state[j], largest)
        change[n + j] = _flow(p, j, torque[j])
        speed[j] = change[j] + change[n + j]
        for e in range(p.retardation_time.size):
            at = 2 * n + e * n + j
            change[at] = (p.compliance[e, j] * torque[j] - state[at]) / p.retardation_time[e]
            speed[j] += change[at]
        if at_speed > strain:
            change[strain + j] = max(state[j] - largest, 0.0) / 0.02
    for j in range(lag - friction):  # Bouc and Wen
        slide, z = np.sum(speed[j:]), state[friction + j]
        against = 0.5 + 0.5 * np.sign(slide * z)
        change[friction + j] = slide / p.friction_width * (1.0 - against * z * z)
    if strain > lag:
        for stage in range(len(LAG_STAGES)):
            before = tension if stage == 0 else state[lag + stage - 1]
            change[lag + stage] = (before - state[lag + stage]) / (LAG_STAGES[stage] * p.lag)


@njit(cache=True)
def _differentiate(
    p: Physics, place: Place, ramp: Ramp, time: float, state: Array, rest: Array
) -> Array:
    """Jacobian of `_change` by differences; the integrator's order does not hang on it."""
    size = state.size
    jacobian, here, there = np.empty((size, size)), np.empty(size), np.empty(size)
    nudged = state.copy()
    _change(p, place, ramp, time, state, rest, here)
    for k in range(size):
        nudged[k] = state[k] + 1e-7
        _change(p, place, ramp, time, nudged, rest, there)
        nudged[k] = state[k]
        jacobian[:, k] = (there - here) / 1e-7
    return jacobian


@njit(cache=True)
def _step(
    p: Physics,
    place: Place,
    ramp: Ramp,
    time: float,
    step: float,
    state: Array,
    rest: Array,
    jacobian: Array,
) -> tuple[Array, float]:
    """One step of the extrapolated linearly implicit Euler method, and its error [rad]."""
    size, error = state.size, 0.0
    table, moved, push = np.empty((COLUMNS, size)), np.empty(size), np.empty(size)
    order = np.empty(size, np.int64)
    for row in range(COLUMNS):
        part = step / (row + 1)
        factors = np.eye(size) - part * jacobian
        factor_in_place(factors, order)
        moved[:] = state
        for i in range(1, row + 2):
            _change(p, place, ramp, time + i * part, moved, rest, push)
            solve_in_place(factors, order, push)
            moved += part * push
        for column in range(row):  # Aitken and Neville
            error = 0.0
            for k in range(size):
                better = moved[k] + (moved[k] - table[column, k]) / ((row + 1) / (row - column) - 1)
                if k < place[3]:
                    error += abs(better - moved[k])
                table[column, k], moved[k] = moved[k], better
        table[row] = moved
    return moved, error


@njit(cache=True)
def _interpolate(
    p: Physics,
    place: Place,
    ramp: Ramp,
    time: float,
    step: float,
    state: Array,
    moved: Array,
    rest: Array,
    frame_time: Array,
    angle: Array,
) -> int:
    """Bend the frames that lie within a step, by a cubic between its ends; count them."""
    count = 0
    before, after = np.empty(state.size), np.empty(state.size)
    while count < frame_time.size and frame_time[count] <= time + step + 1e-12:
        if count == 0:
            _change(p, place, ramp, time, state, rest, before)
            _change(p, place, ramp, time + step, moved, rest, after)
        x = (frame_time[count] - time) / step
        bow = x * (1.0 - x) * step * ((1.0 - x) * before - x * after)
        between = state + x * x * (3.0 - 2.0 * x) * (moved - state) + bow
        _bend(p, between, rest, angle[count])
        count += 1
    return count


@njit(cache=True)
def simulate_angles(p: Physics, frame_time: Array, tolerance: float) -> Array:
    """Joint angles (frame, joint) [rad]: adaptive steps from knot to knot, cubic between steps.

    The finger rests before the first knot; after the last one the last tension holds.
    """
    place = _place(p)
    rest = _rest(p, place)
    state = rest.copy()
    state[: p.k_v.size] += p.residual
    angle, frame = np.empty((frame_time.size, p.k_v.size)), 0
    while frame < frame_time.size and frame_time[frame] <= p.load_time[0]:
        _bend(p, state, rest, angle[frame])
        frame += 1
    for knot in range(p.load_time.size):
        last = knot == p.load_time.size - 1
        time, tension, slope = p.load_time[knot], p.load_tension[knot], 0.0
        end = max(time, frame_time[-1]) if last else p.load_time[knot + 1]
        if not last and end > time:
            slope = (p.load_tension[knot + 1] - tension) / (end - time)
        ramp = (time, tension, slope)
        step, taken, jacobian = 1e-3, 0, np.empty((0, 0))
        while end - time > 1e-12 and frame < frame_time.size:
            if taken % 10 == 0:
                jacobian = _differentiate(p, place, ramp, time, state, rest)
            step = min(step, LONGEST_STEP_S, end - time)
            moved, error = _step(p, place, ramp, time, step, state, rest, jacobian)
            scale = 0.2
            if np.isfinite(error):
                scale = min(3.0, max(0.2, 0.8 * (tolerance / (error + 1e-30)) ** (1 / COLUMNS)))
            if error <= tolerance:
                seen, bent = frame_time[frame:], angle[frame:]
                frame += _interpolate(p, place, ramp, time, step, state, moved, rest, seen, bent)
                time, state, taken = time + step, moved, taken + 1
            step *= scale
            if not step > 1e-12:
                raise RunawayError("the motion runs away: an effect is stronger than the finger")
    return angle
