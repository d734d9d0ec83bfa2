"""The paper's full equations of motion, integrated.

M(q) q̈ + h(q, q̇) + τ_in = P(q) f.

Per joint, with q_v the angle of the Kelvin–Voigt element and q_p = q − q_ini − q_v the creep:

    τ_in = k_v q_v + c_v q̇_v = c_p q̇_p     hence     τ_in = s (k_v q_v + c_v q̇),
    q̇_v = s q̇ − k_v q_v / (c_v + c_p),                s = c_p / (c_v + c_p).

At rest with q = q_ini until the first knot of the load. Stiff (the fastest rates reach −1.6e5 per
second, the slowest is 0), hence Rodas5P with the exact Jacobian; the states q and q_v are
eliminated from its linear systems, so that only N × N ones are solved.

ASSUME: horizontal plane, no friction in the wires, the extension wire is slack.
"""

from typing import Literal

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from softfinger.compiled import compiled
from softfinger.faults import Fault
from softfinger.mechanics import PARAMETERS, rodas
from softfinger.mechanics.chain import compute_inertia_coefficients
from softfinger.mechanics.checks import require_finite, require_forward_in_time, require_positive
from softfinger.mechanics.dynamics_step import fill_stages
from softfinger.mechanics.geometry import FingerGeometry
from softfinger.mechanics.load import check_load

WireGeometry = Literal["constant_arm", "paper"]
_H = rodas.H
TOLERANCE = 5e-7  # [rad] a step; tests show 1e-6 rad at every frame
_MAX_STEPS = 1_000_000


def simulate_full_dynamics(
    parameters: xr.Dataset,
    geometry: FingerGeometry,
    time: ArrayLike,
    load_time: ArrayLike,
    load_tension: ArrayLike,
    wire_geometry: WireGeometry = "constant_arm",
) -> xr.Dataset:
    """Compute the motion of a pulled finger.

    It is under a tension of the flexion wire, inertia included.

    Parameters
    ----------
    parameters
        k_v [N m/rad], c_v, c_p [N m s/rad], q_ini [rad], each (trial, joint).
    geometry
        Lengths, masses and wires of the finger.
    time
        (frame,) [s], nondecreasing.
    load_time, load_tension
        (knot,) or (trial, knot) [s], [N]: straight lines between knots, 0 before the first.
    wire_geometry
        "constant_arm": torque = wire offset × tension; "paper": moment arm r sin(q/2 + a).

    Returns
    -------
    joint_angle [rad], joint_velocity [rad/s], elastic_angle (q_v) [rad]: (trial, joint, frame). The
    joint angle is within 1e-6 rad of the exact solution where the damping is at least a hundredth
    of the paper's; a finger that swings for longer than that gathers up to 1e-5 rad.

    Raises
    ------
    Fault
        A parameter, time or load that no finger has, with its value and bound; or a motion so
        violent that the integration gives up.

    Notes
    -----
    References: Honji, Arita, Tahara, "Stochastic Approach for Modeling the Soft Finger with the
    Creep Behavior", equations of motion and three-element joint.
    """
    if wire_geometry not in ("constant_arm", "paper"):
        raise Fault(f"wire_geometry is {wire_geometry!r}: it must be 'constant_arm' or 'paper'")
    columns = [parameters[name].transpose("trial", "joint") for name in PARAMETERS]
    values = [np.array(column, float, order="C") for column in columns]
    for name, value in zip(("k_v", "c_v", "c_p"), values, strict=False):
        require_positive(name, value, "N m/rad" if name == "k_v" else "N m s/rad")
    require_finite("q_ini", values[3], "rad")
    if values[0].shape[1] != geometry.joints:
        raise Fault(
            f"the parameters have {values[0].shape[1]} joints and the geometry {geometry.joints}: "
            "they must have the same number"
        )
    time = np.asarray(time, float)
    require_forward_in_time("time", time)
    check_load(load_time, load_tension)
    trials = values[0].shape[0]
    knots = [np.asarray(a, float) for a in (load_time, load_tension)]
    knots = [np.array(np.broadcast_to(k, (trials, k.shape[-1])), order="C") for k in knots]
    state, worst = simulate_full_dynamics_array(
        *values,
        compute_inertia_coefficients(geometry),
        geometry.joint_length / 2 if wire_geometry == "paper" else np.nan,
        geometry.wire_offset,
        time,
        *knots,
        TOLERANCE,
    )
    if worst >= 0:
        raise Fault(
            f"the motion of trial {parameters.trial.to_numpy()[worst]} could not be integrated in "
            f"{_MAX_STEPS} steps: its parameters or its load are far from any finger's"
        )
    names = ("joint_angle", "joint_velocity", "elastic_angle")
    dims = ("trial", "joint", "frame")
    return xr.Dataset(
        {name: (dims, state[i]) for i, name in enumerate(names)},
        coords={**parameters[["trial", "joint"]].coords, "time": ("frame", time)},
    )


@compiled
def simulate_full_dynamics_array(
    k_v: NDArray,
    c_v: NDArray,
    c_p: NDArray,
    q_ini: NDArray,
    coefficients: NDArray,
    half_length: float,
    offset: float,
    time: NDArray,
    load_time: NDArray,
    load_tension: NDArray,
    tolerance: float,
) -> tuple[NDArray, int]:
    """Integrate every trial.

    The function returns −1, or the first trial that could not be integrated.

    Parameters (trial, joint), loads (trial, knot), times (frame,), `half_length` NaN for a constant
    arm. Returns the states q, q̇, q_v (3, trial, joint, frame).
    """
    trials, joints = k_v.shape
    output = np.zeros((3, trials, joints, time.size))
    joint, motion = np.empty((4, joints)), np.zeros((time.size, 3 * joints))
    failed = -1
    for trial in range(trials):
        joint[2] = c_p[trial] / (c_v[trial] + c_p[trial])
        joint[0], joint[1] = joint[2] * k_v[trial], joint[2] * c_v[trial]
        joint[3] = k_v[trial] / (c_v[trial] + c_p[trial])
        done = _integrate_trial(
            joint, q_ini[trial], coefficients, half_length, offset, time,
            load_time[trial], load_tension[trial], tolerance, motion,
        )  # fmt: skip
        if not done and failed < 0:
            failed = trial
        for row in range(3):
            output[row, trial] = motion[:, row * joints : (row + 1) * joints].T
    return output, failed


@compiled
def _integrate_trial(
    joint: NDArray,
    q_ini: NDArray,
    coefficients: NDArray,
    half_length: float,
    offset: float,
    time: NDArray,
    load_time: NDArray,
    load_tension: NDArray,
    tolerance: float,
    motion: NDArray,
) -> bool:
    """Integrate one trial, from rest.

    Steps end at the knots; frames go into `motion` by dense output.
    """
    n = q_ini.size
    state, after = np.zeros(3 * n), np.zeros(3 * n)
    state[:n] = q_ini
    stages, bends = np.zeros((3 * n, rodas.STAGES)), np.zeros((3, 3 * n))
    squares, rows = np.zeros((4, n, n)), np.zeros(9 * n)
    step, steps, frame = 0.0, 0, np.searchsorted(time, load_time[0], "right")
    motion[:frame] = state
    for knot in range(load_time.size):
        now, tension, climb, end = load_time[knot], load_tension[knot], 0.0, time[-1]
        if knot + 1 < load_time.size:
            end = load_time[knot + 1]
            if end == now:
                continue
            climb = (load_tension[knot + 1] - tension) / (end - now)
        if knot == 0 or load_time[knot - 1] == now:  # a jump of the load
            step = 1e-6
        while frame < time.size and now < end:
            steps += 1
            if steps > _MAX_STEPS or not step > 1e-13:
                return False
            last = now + step * 1.0001 >= end
            length = end - now if last else step
            fill_stages(
                joint, coefficients, half_length, offset, tension, climb, length,
                state, after, stages, squares, rows,
            )  # fmt: skip
            error = _measure_error(stages[:, rodas.STAGES - 1], length, tolerance)
            step = _propose_step(error, length, step, last)
            if error > 1.0:
                continue
            ahead = end if last else now + length
            if time[frame] <= ahead:
                _fill_bends(stages, bends)
            while frame < time.size and time[frame] <= ahead:
                _interpolate((time[frame] - now) / length, state, after, bends, motion[frame])
                frame += 1
            state[:] = after
            tension += climb * length
            now = ahead
    return True


@compiled
def _propose_step(error: float, length: float, step: float, last: bool) -> float:
    """Propose the step after one of `length`."""
    if error > 1.0:
        return length * (max(0.1, 0.9 * error**-0.2) if error < 1e30 else 0.1)
    grown = length * min(8.0, 0.9 * max(error, 1e-10) ** -0.2)
    return max(step, grown) if last else grown


@compiled
def _measure_error(error: NDArray, step: float, tolerance: float) -> float:
    """The largest error over the tolerance.

    It is of q and q_v, and of q̇ times the step.
    """
    n, worst = error.size // 3, 0.0
    for k in range(error.size):
        size = abs(error[k]) * (step if n <= k < 2 * n else 1.0)
        if not size < np.inf:  # `max` would forget a NaN
            return np.inf
        worst = max(worst, size)
    return worst / tolerance


@compiled
def _fill_bends(stages: NDArray, bends: NDArray) -> None:
    """Write H₁k, H₂k, H₃k into `bends`' rows."""
    for power in range(3):
        for k in range(stages.shape[0]):
            bends[power, k] = 0.0
            for i in range(rodas.STAGES):
                bends[power, k] += _H[power, i] * stages[k, i]


@compiled
def _interpolate(
    share: float, before: NDArray, after: NDArray, bends: NDArray, output: NDArray
) -> None:
    """The state at `share` of the step."""
    rest = 1.0 - share
    for k in range(before.size):
        bend = bends[0, k] + share * (bends[1, k] + share * bends[2, k])
        output[k] = rest * before[k] + share * (after[k] + rest * bend)
