"""A chain of rods in a plane.

Its weight and inertia, and those of a payload, for the proof's integrator.
"""

from __future__ import annotations

import numpy as np

from softfinger.compiled import compiled
from softfinger.concealed.arrays import Array
from softfinger.concealed.linear import factor_in_place, solve_in_place
from softfinger.concealed.physics import Physics


@compiled
def weigh_in_place(p: Physics, angle: Array, torque: Array) -> None:
    """Add gravity's torque about each joint.

    It is Σ m ((x_c − x_j) g_y − (y_c − y_j) g_x), summed outwards from the joint.
    """
    for j in range(angle.size):
        x, y, heading = 0.0, 0.0, np.sum(angle[:j])
        for i in range(j, angle.size):
            heading += angle[i]
            half_x = 0.5 * p.link_length[i] * np.cos(heading)
            half_y = 0.5 * p.link_length[i] * np.sin(heading)
            at = p.rod_centre[i]
            lever = (x + at * half_x) * p.gravity_y - (y + at * half_y) * p.gravity_x
            torque[j] += p.link_mass[i] * lever
            x, y = x + 2.0 * half_x, y + 2.0 * half_y
        torque[j] += p.payload * (x * p.gravity_y - y * p.gravity_x)


@compiled
def accelerate_in_place(p: Physics, angle: Array, speed: Array, force: Array) -> None:
    """Angular acceleration of the chain, written over the torque.

    It is M⁻¹ (torque − h).

    A rod whose centre of mass lies at a share s of its half length turns about it with the inertia
    of a uniform one; a payload is a point at the tip; a rotor turns with its joint alone.
    """
    n = angle.size
    mass, lever = np.zeros((n, n)), np.empty((2, n))
    ax, ay, heading, turn = 0.0, 0.0, 0.0, 0.0  # centripetal acceleration of joint i
    for i in range(n):
        heading, turn = heading + angle[i], turn + speed[i]
        x, y = p.link_length[i] * np.cos(heading), p.link_length[i] * np.sin(heading)
        lever[:, i] = 0.0
        half = 0.5 * p.rod_centre[i]
        centre_x, centre_y = ax - half * turn * turn * x, ay - half * turn * turn * y
        heavy = p.inertia_scale * p.link_mass[i]
        for j in range(i + 1):
            arm_x, arm_y = lever[0, j] + half * x, lever[1, j] + half * y
            force[j] -= heavy * (arm_x * centre_y - arm_y * centre_x)
            for k in range(i + 1):
                arms = arm_x * (lever[0, k] + half * x) + arm_y * (lever[1, k] + half * y)
                mass[j, k] += heavy * (arms + p.link_length[i] ** 2 / 12.0)
        lever[0, : i + 1] += x
        lever[1, : i + 1] += y
        ax, ay = ax - turn * turn * x, ay - turn * turn * y
    tip = p.inertia_scale * p.payload
    for j in range(n):
        force[j] -= tip * (lever[0, j] * ay - lever[1, j] * ax)
        for k in range(n):
            mass[j, k] += tip * (lever[0, j] * lever[0, k] + lever[1, j] * lever[1, k])
        mass[j, j] += p.inertia_scale * p.rotor[j]
    order = np.empty(n, np.int64)
    factor_in_place(mass, order)
    solve_in_place(mass, order, force)
