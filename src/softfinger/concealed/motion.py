"""The proof's own equations of motion, compiled.

State of a trial: strain of each joint's Voigt element (joint,), of its dashpot (joint,), of further
Voigt elements (element, joint), then, where switched on, the direction in which the wire last slid
(joint,), the lagging tension (stage,), the largest strain so far (joint,), the direction in which a
joint last slid (joint,), how much of a dashpot's structure is broken (joint,), how warm a joint has
become (joint,), the speed (joint,).

What a rate is made of is compiled into its one caller: every call would hand over all of `Physics`,
which takes longer than the arithmetic.
"""

from __future__ import annotations

import numpy as np

from softfinger.compiled import compiled
from softfinger.concealed.chain import accelerate_in_place, weigh_in_place
from softfinger.concealed.laws import (
    ANGLE_SPAN_RAD,
    Array,
    Place,
    carry,
    flow,
    look_up,
    rub,
    share_torque,
    stretch,
)
from softfinger.concealed.physics import Physics

Ramp = tuple[float, float, float]  # from when, tension then, its slope
DRY_RAD = 0.005  # of motion that turns a joint's friction round


@compiled
def lay_out(p: Physics) -> Place:
    """Where the optional states start, and their end."""
    n = p.k_v.size
    friction = 2 * n + p.compliance.size
    lag = friction + (n if np.any(p.friction != 0.0) else 0)
    strain = lag + p.lag_times.size
    dry = strain + (n if np.any(p.mullins != 0.0) or np.any(p.plastic != 0.0) else 0)
    broken = dry + (n if np.any(p.dry != 0.0) else 0)
    warm = broken + (n if np.any(p.thixotropy != 0.0) else 0)
    softens = np.any(p.softening != 0.0) or np.any(p.thinning_out != 0.0)
    speed = warm + (n if softens else 0)
    end = speed + (n if p.inertia_scale != 0.0 else 0)
    return friction, lag, strain, dry, broken, warm, speed, end


@compiled
def find_rest(p: Physics, place: Place) -> Array:
    """State of the unloaded finger under its weight."""
    n = p.k_v.size
    state, borne = np.zeros(place[7]), np.zeros(n)
    weigh_in_place(p, p.q_ini, borne)
    state[:n] = borne / p.k_v
    for e in range(p.retardation_time.size):
        state[2 * n + e * n : 2 * n + (e + 1) * n] = p.compliance[e] * borne
    return state


@compiled(forceinline=True)
def bend(p: Physics, state: Array, rest: Array, angle: Array) -> None:
    """Joint angle in a state.

    It is the initial angle plus every element's strain beyond its strain at rest.
    """
    n = p.k_v.size
    for j in range(n):
        angle[j] = p.q_ini[j]
        for at in range(j, 2 * n + p.compliance.size, n):
            angle[j] += state[at] - rest[at]


@compiled(forceinline=True)
def pull(
    p: Physics, place: Place, time: float, tension: float, state: Array, angle: Array, torque: Array
) -> None:
    """Torque on each joint from outside."""
    friction, lag, strain, dry, broken, _, _, _ = place
    if strain > lag:
        tension = 0.0
        for stage in range(strain - lag):
            tension += p.lag_mix[stage] * state[lag + stage]
    if p.ripple != 0.0:
        tension *= 1.0 + p.ripple * np.sin(p.ripple_rate * time + p.ripple_phase)
    for j in range(angle.size):
        arm = p.wire_offset
        if lag > friction:  # the wire wraps the bend and a fixed angle of its guide
            wrapped = 0.2 + abs(angle[j])
            if p.drag_law.size:
                wrapped = look_up(p.drag_law[0], abs(angle[j]) / ANGLE_SPAN_RAD)
            if state[friction + j] < 0.0:
                wrapped *= p.friction_back
            drag = p.friction[j] * wrapped * state[friction + j]
            tension = rub(tension, drag, p.friction_power)
        if p.arm_scale != 0.0:  # the wire leaves the offset line and runs along the chord
            slant = np.arctan2(2.0 * p.wire_offset, p.joint_length)
            chord = np.hypot(0.5 * p.joint_length, p.wire_offset) * np.sin(0.5 * angle[j] + slant)
            arm += p.arm_scale * (chord - p.wire_offset)
        if p.arm_law.size:
            arm += p.wire_offset * look_up(p.arm_law[j], angle[j] / ANGLE_SPAN_RAD)
        torque[j] = tension * arm
        for i in range(angle.size):
            torque[j] += share_torque(p, j, i, angle)
        if angle[j] > p.stop_angle[j] and p.stop_stiffness[j] != 0.0:  # Hertz
            torque[j] -= p.stop_stiffness[j] * (angle[j] - p.stop_angle[j]) ** 1.5
        if p.stop_law.size:
            torque[j] -= look_up(p.stop_law[j], angle[j] / ANGLE_SPAN_RAD)
        if broken > dry:
            torque[j] -= p.dry[j] * state[dry + j]
    if p.tendon != 0.0:
        torque -= p.tendon * max(np.sum(angle) - p.tendon_slack, 0.0)
    if p.gravity_x != 0.0 or p.gravity_y != 0.0:
        weigh_in_place(p, angle, torque)


@compiled
def change_in_place(
    p: Physics, place: Place, ramp: Ramp, time: float, state: Array, rest: Array, change: Array
) -> None:
    """Rate of every state."""
    tension = ramp[1] + ramp[2] * (time - ramp[0])
    n = p.k_v.size
    friction, lag, strain, _, _, _, at_speed, end = place
    joint = np.empty((3, n))
    angle, torque, speed = joint[0], joint[1], joint[2]
    bend(p, state, rest, angle)
    pull(p, place, time, tension, state, angle, torque)
    if end > at_speed:
        for j in range(n):
            carried = carry(p, place, j, state[at_speed + j], state)
            change[at_speed + j] = torque[j] - carried
            torque[j] = carried
        accelerate_in_place(p, angle, state[at_speed:], change[at_speed:])
    for j in range(n):
        change[j] = stretch(p, place, j, torque[j], state)
        change[n + j] = flow(p, place, j, torque[j], state)
        speed[j] = change[j] + change[n + j]
        for e in range(p.retardation_time.size):
            at = 2 * n + e * n + j
            change[at] = (p.compliance[e, j] * torque[j] - state[at]) / p.retardation_time[e]
            speed[j] += change[at]
    for j in range(lag - friction):  # Bouc and Wen
        slide, z = np.sum(speed[j:]), state[friction + j]
        against = 0.5 + 0.5 * np.sign(slide * z)
        change[friction + j] = slide / p.friction_width * (1.0 - against * z * z)
    for stage in range(strain - lag):
        before = tension if stage == 0 else state[lag + stage - 1]
        change[lag + stage] = (before - state[lag + stage]) / p.lag_times[stage]
    _remember(p, place, state, speed, change)


@compiled(forceinline=True)
def _remember(p: Physics, place: Place, state: Array, speed: Array, change: Array) -> None:
    """Rate of what a joint remembers."""
    _, _, strain, dry, broken, warm, at_speed, _ = place
    n = p.k_v.size
    rate, power, heat, cooling = p.warming
    for j in range(n):
        if dry > strain:
            change[strain + j] = max(state[j] - state[strain + j], 0.0) / 0.02
        if broken > dry:
            z = state[dry + j]
            against = 0.5 + 0.5 * np.sign(speed[j] * z)
            change[dry + j] = speed[j] / DRY_RAD * (1.0 - against * z * z)
        if warm > broken:
            b, flowing = state[broken + j], abs(change[n + j])
            change[broken + j] = p.breaking * flowing * (1.0 - b) - p.healing * b
        if at_speed > warm:
            w = state[warm + j]
            left = max(1.0 - w, 0.0)
            change[warm + j] = rate * left**power + heat * abs(speed[j]) * left - cooling * w
