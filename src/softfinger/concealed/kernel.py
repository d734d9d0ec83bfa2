"""The proof's own integrator of `motion`, compiled."""

from __future__ import annotations

import numpy as np

from softfinger.compiled import compiled
from softfinger.concealed.arrays import Array
from softfinger.concealed.laws import Place
from softfinger.concealed.linear import factor_in_place, solve_in_place
from softfinger.concealed.motion import Ramp, bend, change_in_place, find_rest, lay_out
from softfinger.concealed.physics import Physics

LONGEST_STEP_S = 0.25
COLUMNS = 4  # of the extrapolation table, hence its order


class RunawayError(ValueError):
    """An effect is too strong for any rest."""


@compiled
def _differentiate(
    p: Physics, place: Place, ramp: Ramp, time: float, state: Array, rest: Array
) -> Array:
    """Jacobian of `change_in_place` by differences."""
    size = state.size
    jacobian, here, there = np.empty((size, size)), np.empty(size), np.empty(size)
    nudged = state.copy()
    change_in_place(p, place, ramp, time, state, rest, here)
    for k in range(size):
        nudged[k] = state[k] + 1e-7
        change_in_place(p, place, ramp, time, nudged, rest, there)
        nudged[k] = state[k]
        jacobian[:, k] = (there - here) / 1e-7
    return jacobian


@compiled
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
    """One extrapolated implicit Euler step; its error [rad]."""
    size, error = state.size, 0.0
    table, moved, push = np.empty((COLUMNS, size)), np.empty(size), np.empty(size)
    order = np.empty(size, np.int64)
    for row in range(COLUMNS):
        part = step / (row + 1)
        factors = np.eye(size) - part * jacobian
        factor_in_place(factors, order)
        moved[:] = state
        for i in range(1, row + 2):
            change_in_place(p, place, ramp, time + i * part, moved, rest, push)
            solve_in_place(factors, order, push)
            moved += part * push
        for column in range(row):  # Aitken and Neville
            error = 0.0
            for k in range(size):
                better = moved[k] + (moved[k] - table[column, k]) / ((row + 1) / (row - column) - 1)
                if k < place[6]:
                    error += abs(better - moved[k])
                table[column, k], moved[k] = moved[k], better
        table[row] = moved
    return moved, error


@compiled
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
    """Compute the frames that lie within a step.

    They follow a cubic between the step's ends. The function returns their number.
    """
    count = 0
    before, after = np.empty(state.size), np.empty(state.size)
    while count < frame_time.size and frame_time[count] <= time + step + 1e-12:
        if count == 0:
            change_in_place(p, place, ramp, time, state, rest, before)
            change_in_place(p, place, ramp, time + step, moved, rest, after)
        x = (frame_time[count] - time) / step
        bow = x * (1.0 - x) * step * ((1.0 - x) * before - x * after)
        between = state + x * x * (3.0 - 2.0 * x) * (moved - state) + bow
        bend(p, between, rest, angle[count])
        count += 1
    return count


@compiled
def simulate_angles(p: Physics, frame_time: Array, tolerance: float) -> Array:
    """Integrate the joint angles (frame, joint) [rad].

    Steps are adaptive from knot to knot; frames follow a cubic between steps.

    The finger rests before the first knot; after the last one the tension stays the same.
    """
    place = lay_out(p)
    rest = find_rest(p, place)
    state = rest.copy()
    state[: p.k_v.size] += p.residual
    angle, frame = np.empty((frame_time.size, p.k_v.size)), 0
    while frame < frame_time.size and frame_time[frame] <= p.load_time[0]:
        bend(p, state, rest, angle[frame])
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
