"""The paper's two assumptions, checked.

Inertia does not matter, and the torque is constant.

The step solution leaves out the links' mass and the growth of the moment arm as a joint bends. Both
are in the equations of motion, so three motions of the same fingers tell them apart:

    inertia       full motion with a constant arm  − step solution
    moment arm    full motion with the paper's arm − full motion with a constant arm

and the step solution fitted to the last shows where the arm goes: into the parameters.
"""

from itertools import pairwise

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.mechanics import PARAMETERS
from softfinger.mechanics.dynamics import simulate_full_dynamics
from softfinger.mechanics.geometry import FingerGeometry
from softfinger.mechanics.three_element import compute_joint_angle_gradient_array
from softfinger.mechanics.wires import compute_moment_arm_array

WINDOW_EDGES_S = (0.0, 0.01, 0.1, 1.0, 10.0, 30.0)
MATTERS_RAD = 1e-3
"""A gap above this matters: a camera's noise averaged over ten frames."""
_ITERATIONS = 40


def check_assumptions(
    parameters: xr.Dataset, geometry: FingerGeometry, tension: float, frame_rate: float = 30.0
) -> xr.Dataset:
    """Compare the step solution with the full motion.

    Parameters
    ----------
    parameters
        k_v [N m/rad], c_v, c_p [N m s/rad], q_ini [rad], each (trial, joint).
    tension
        Constant tension of the flexion wire from time 0 [N].
    frame_rate
        [Hz] of the recordings to which the step solution is fitted, 30 s long.

    Returns
    -------
    Dataset
        gap_largest, gap_rms (cause, joint, window) and gap_largest_at, gap_rms_at (cause, joint,
        time) [rad], over trials; inertia_lasts (joint) [s], after which no trial's gap exceeds
        1 mrad; arm_growth (angle) [1]; angle_reached (trial, joint) [rad] and torque_growth [1] at
        the end; fitted_change (trial, joint, parameter), relative [1] and for q_ini [rad];
        fitted_residual_rms (trial, joint) [rad]; statement (sentence) of `describe_assumptions`.
    """
    time = np.r_[0.0, np.geomspace(1e-4, WINDOW_EDGES_S[-1], 400)]
    names = ("trial", "joint")
    values = [parameters[name].transpose(*names).to_numpy() for name in PARAMETERS]
    torque = tension * geometry.wire_offset
    plain, bent = (
        simulate_full_dynamics(parameters, geometry, time, [0.0], [tension], wires).joint_angle
        for wires in ("constant_arm", "paper")
    )
    step = compute_joint_angle_gradient_array(*values, time, [0.0], [torque])[0]
    gap = xr.concat([plain - step, bent - plain], dim="cause")
    gap = gap.assign_coords(cause=["inertia", "moment_arm"]).swap_dims(frame="time")
    result = xr.merge(
        [
            summarise_gaps(gap),
            measure_arm(geometry, bent.isel(frame=-1).drop_vars("time")),
            fit_step_solution(parameters, geometry, tension, frame_rate),
        ]
    )
    return result.assign(statement=("sentence", describe_assumptions(result)))


def describe_assumptions(result: xr.Dataset) -> list[str]:
    """State where the assumptions apply, with the numbers."""
    inertia, arm = (result.gap_largest.sel(cause=cause) for cause in ("inertia", "moment_arm"))
    fingers, matters = result.sizes["trial"], f"{1e3 * MATTERS_RAD:g} mrad"
    lasts, mild = result.inertia_lasts, np.interp(0.01, result.arm_growth, result.angle)
    growth, change = 100 * result.torque_growth, 100 * result.fitted_change.median("trial")
    changes = ", ".join(
        f"{name} by {float(change.sel(parameter=name).min()):.0f} to "
        f"{float(change.sel(parameter=name).max()):.0f} %"
        for name in PARAMETERS[:3]
    )
    early = (
        f"Inertia can be ignored later than {float(lasts.max()):.2g} s after the step: the "
        "angle is "
        f"then less than {matters} off in each of {fingers} fingers. Before, it cannot be "
        f"ignored: it lasts {list_values(lasts)} s and moves the angle by up to "
        f"{list_values(1e3 * inertia.max('window'))} mrad (joints base to tip)."
    )
    if not lasts.notnull().any():
        early = f"Inertia can be ignored at all times: less than {matters} is missing."
    bent = (
        "Under a constant tension the torque is not constant. The moment arm grows by "
        f"1 % when a joint has bent by {mild:.2g} rad, and by "
        f"{float(growth.median()):.0f} % (median) to {float(growth.max()):.0f} % by the end. That "
        f"moves the angle by up to {1e3 * float(arm.max()):.0f} mrad within "
        f"{float(result.window_end.max()):g} s."
    )
    hidden = (
        "One trial does not show it. The step solution still fits to "
        f"{1e3 * float(result.fitted_residual_rms.median()):.2g} mrad rms (median), "
        f"but its parameters absorb the change: {changes} (medians of the joints)."
    )
    return [early, bent, hidden]


def list_values(values: xr.DataArray) -> str:
    """List a value for each joint.

    >>> list_values(xr.DataArray([0.5, 0.254, np.nan]))
    '0.5, 0.25, no'
    """
    return ", ".join("no" if np.isnan(value) else f"{value:.2g}" for value in values.to_numpy())


def summarise_gaps(gap: xr.DataArray) -> xr.Dataset:
    """Summarise gaps by time and by window.

    Gaps are (cause, trial, joint, time) [rad]; the summary is over trials.

    A window's rms counts every decade of its time alike. `inertia_lasts` is NaN where the gap never
    exceeds 1 mrad.
    """
    size = abs(gap)
    windows = [
        size.where((gap.time > low) & (gap.time <= high), drop=True)
        for low, high in pairwise(WINDOW_EDGES_S)
    ]
    largest = xr.concat([window.max(("trial", "time")) for window in windows], dim="window")
    square = xr.concat([(window**2).mean(("trial", "time")) for window in windows], dim="window")
    lasting = size.sel(cause="inertia", drop=True).max("trial") > MATTERS_RAD
    result = xr.Dataset(
        {
            "gap_largest": largest,
            "gap_rms": np.sqrt(square),
            "gap_largest_at": size.max("trial"),
            "gap_rms_at": np.sqrt((gap**2).mean("trial")),
            "inertia_lasts": gap.time.where(lasting).max("time"),
        },
        coords={
            "window_start": ("window", list(WINDOW_EDGES_S[:-1])),
            "window_end": ("window", list(WINDOW_EDGES_S[1:])),
        },
    )
    return result.transpose("cause", "joint", "window", "time")


def measure_arm(geometry: FingerGeometry, angle: xr.DataArray) -> xr.Dataset:
    """Measure how the moment arm grows with bending.

    Parameters
    ----------
    angle
        (trial, joint) [rad], reached at the end.

    Returns
    -------
    Dataset
        arm_growth (angle) and torque_growth (trial, joint): arm over wire offset, less 1; and the
        angle itself as angle_reached.
    """
    sizes = (geometry.joint_length, geometry.wire_offset)
    bends = np.linspace(0.0, 1.6, 65)
    growth = compute_moment_arm_array(bends, *sizes) / geometry.wire_offset - 1.0
    reached = compute_moment_arm_array(angle.to_numpy(), *sizes) / geometry.wire_offset - 1.0
    return xr.Dataset(
        {
            "arm_growth": ("angle", growth),
            "torque_growth": angle.copy(data=reached),
            "angle_reached": angle,
        },
        coords={"angle": bends},
    )


def fit_step_solution(
    parameters: xr.Dataset, geometry: FingerGeometry, tension: float, frame_rate: float
) -> xr.Dataset:
    """Fit the step solution to the full motion.

    Returns
    -------
    Dataset
        fitted_change (trial, joint, parameter): fitted/true − 1, for q_ini fitted − true [rad];
        fitted_residual_rms (trial, joint) [rad].
    """
    end = WINDOW_EDGES_S[-1]
    time = np.arange(1, round(end * frame_rate) + 1) / frame_rate
    motion = simulate_full_dynamics(parameters, geometry, time, [0.0], [tension], "paper")
    names = ("trial", "joint")
    true = np.stack([parameters[name].transpose(*names).to_numpy() for name in PARAMETERS], -1)
    start = np.concatenate([np.log(true[..., :3]), true[..., 3:]], axis=-1)
    load = ([0.0], [tension * geometry.wire_offset])
    fitted, residual = _fit_step_array(start, motion.joint_angle.to_numpy(), time, load)
    change = fitted - start
    change[..., :3] = np.expm1(change[..., :3])
    return xr.Dataset(
        {
            "fitted_change": ((*names, "parameter"), change),
            "fitted_residual_rms": (names, np.sqrt((residual**2).mean(-1))),
        },
        coords={**parameters[["trial", "joint"]].coords, "parameter": list(PARAMETERS)},
    )


def _fit_step_array(
    start: NDArray, angle: NDArray, time: NDArray, load: tuple[list[float], list[float]]
) -> tuple[NDArray, NDArray]:
    """Least squares of every joint at once.

    It is by Gauss–Newton with steps of at most 1 in the log.

    Parameters
    ----------
    start
        (trial, joint, 4): log k_v, log c_v, log c_p, q_ini.
    angle
        (trial, joint, n) [rad].

    Returns
    -------
    Fitted parameters like `start`, and residuals (trial, joint, n) [rad].
    """
    fitted = start.copy()
    for _ in range(_ITERATIONS):
        natural = [*np.exp(np.moveaxis(fitted[..., :3], -1, 0)), fitted[..., 3]]
        model, gradient = compute_joint_angle_gradient_array(*natural, time, *load)
        residual = angle - model
        gram = np.swapaxes(gradient, -1, -2) @ gradient
        pull = np.swapaxes(gradient, -1, -2) @ residual[..., None]
        step = np.linalg.solve(gram, pull)[..., 0]
        fitted += np.clip(step, -1.0, 1.0)
        if np.abs(step).max() < 1e-9:
            break
    return fitted, residual
