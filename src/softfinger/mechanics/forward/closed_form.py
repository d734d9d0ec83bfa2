"""The step solution for many trials.

It gives what the general kernel gives without any effect, quicker.

An accelerator of `simulate`: it applies where effects have moved nothing but the joints' own
parameters. A test compares it with the general kernel.
"""

import math

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.load import fill_load_integral
from softfinger.mechanics.three_element import fill_elastic_basis


@compiled
def run_closed_form(
    joint: NDArray,
    d_joint: NDArray,
    time: NDArray,
    load_time: NDArray,
    load_torque: NDArray,
    by_own: bool,
) -> tuple[NDArray, NDArray]:
    """Compute angles and gradients in closed form.

    Angles are (trial, joint, n) [rad], gradients (trial, joint, n, column).

    Parameters
    ----------
    joint
        (trial, joint, slot): log k_v, log c_v, log c_p, q_ini come first.
    d_joint
        (direction, trial, joint, slot) its derivatives along each direction.
    time
        (trial, n) [s], nondecreasing, rows may end in NaN.
    load_time, load_torque
        (trial, knot) [s], [N m].
    by_own
        Whether the first 4 joint columns are the derivatives by the trial's own parameters.
    """
    trials, joints, _ = joint.shape
    n = time.shape[1]
    own = 4 * joints if by_own else 0
    directions = d_joint.shape[0]
    angle = np.empty((trials, joints, n))
    gradient = np.zeros((trials, joints, n, own + directions))
    basis, slope, integral = np.empty(n), np.empty(n), np.empty(n)
    parts = np.empty(4)
    for i in range(trials):
        fill_load_integral(time[i], load_time[i], load_torque[i], integral)
        for j in range(joints):
            soft, thin = math.exp(-joint[i, j, 0]), math.exp(-joint[i, j, 2])
            rate = math.exp(joint[i, j, 0] - joint[i, j, 1])
            fill_elastic_basis(rate, time[i], load_time[i], load_torque[i], basis, slope)
            for k in range(n):
                angle[i, j, k] = soft * basis[k] + thin * integral[k] + joint[i, j, 3]
                if own + directions == 0 or math.isnan(angle[i, j, k]):
                    continue
                parts[0] = soft * (slope[k] - basis[k])
                parts[1] = -soft * slope[k]
                parts[2] = -thin * integral[k]
                parts[3] = 1.0
                for a in range(4):
                    if by_own:
                        gradient[i, j, k, 4 * j + a] = parts[a]
                    for c in range(directions):
                        gradient[i, j, k, own + c] += parts[a] * d_joint[c, i, j, a]
    return angle, gradient
