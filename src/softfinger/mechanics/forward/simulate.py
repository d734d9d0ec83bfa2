"""The face of the forward model.

It gives joint angles of many trials, with exact tangents.

One compiled kernel serves simulation and inference, whatever physics its slots switch on.
"""

from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from softfinger.compiled.threads import run_side_by_side
from softfinger.faults import Fault
from softfinger.mechanics import LOG_PARAMETERS, PARAMETERS
from softfinger.mechanics.chain import compute_inertia_coefficients
from softfinger.mechanics.checks import require_finite, require_forward_in_time, require_positive
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.forward.closed_form import run_closed_form
from softfinger.mechanics.forward.hooks import compile_hooks, find_hooks
from softfinger.mechanics.forward.slot import SLOTS, list_slots
from softfinger.mechanics.forward.slots import (
    SlotArrays,
    build_slots,
    build_tangent,
    check_slots,
    find_moved_slots,
    stack_tangents,
)
from softfinger.mechanics.forward.trials import run_trials
from softfinger.mechanics.geometry import FingerGeometry
from softfinger.mechanics.load import check_load, drop_idle_knots

TOLERANCE = 1e-6
"""[rad] a step may err inside, where the model is nonlinear; linear models are exact."""


Route = Literal["quickest", "general", "closed_form"]


class Finger(NamedTuple):
    """A finger as plain arrays, for the kernel."""

    arm_ratio: float
    """l_joint / (2 d)"""
    moment: NDArray[np.float64]
    """(joint,) [kg m] mass beyond each joint times its lever along the link"""
    inertia: NDArray[np.float64]
    """(joint, joint) [kg m²] of `compute_inertia_coefficients`"""
    link_length: NDArray[np.float64]
    """(joint,) [m]"""
    marker_middle: NDArray[np.float64]
    """(1 + joint,) [m] middle of the markers along base and links"""
    optical_centre: NDArray[np.float64]
    """(2,) [m] from the first joint, along and across the base"""


def describe_finger(
    geometry: FingerGeometry,
    marker_middle: ArrayLike | None = None,
    optical_centre: ArrayLike = (0.0, 0.0),
) -> Finger:
    """Gather what is needed of a finger.

    Parameters
    ----------
    marker_middle
        (1 + joint,) [m], middle of the markers along the base (negative) and the links; where they
        are not given, half the link, and as far behind the first joint. Only the lens needs them.
    optical_centre
        (2,) [m], from the first joint, along and across the base.
    """
    half = geometry.link_length / 2
    middle = np.r_[-half[0], half] if marker_middle is None else np.asarray(marker_middle, float)
    beyond = np.cumsum(geometry.link_mass[::-1])[::-1] - geometry.link_mass
    moment = geometry.link_mass * geometry.link_centre + beyond * geometry.link_length
    return Finger(
        geometry.joint_length / (2 * geometry.wire_offset),
        moment,
        compute_inertia_coefficients(geometry),
        geometry.link_length,
        middle,
        np.asarray(optical_centre, float),
    )


def describe_unknown_finger(joints: int) -> Finger:
    """Build a finger of declared joints alone.

    Slots that need more (moment arm, gravity, inertia, radial lens) are refused.
    """
    unknown = np.full(joints, np.nan)
    pairs = np.full((joints, joints), np.nan)
    return Finger(np.nan, unknown, pairs, unknown, np.full(joints + 1, np.nan), np.full(2, np.nan))


def simulate_joint_angle(
    parameters: xr.Dataset,
    finger: Finger,
    time: ArrayLike,
    load_time: ArrayLike,
    load_torque: ArrayLike,
    slots: Mapping[str, ArrayLike] | None = None,
    directions: Sequence[Mapping[str, ArrayLike]] | None = None,
) -> xr.Dataset:
    """Compute the joint angles of trials.

    Parameters
    ----------
    parameters
        k_v [N m/rad], c_v, c_p [N m s/rad], q_ini [rad], each (trial, joint).
    finger
        Of `describe_finger`.
    time
        (frame,) or (trial, frame) [s], nondecreasing; rows may end in NaN.
    load_time, load_torque
        (knot,) or (trial, knot) [s], [N m]: straight lines between knots, 0 before the first.
    slots
        Left-out physics, slot → value (`forward.slots`); none: the paper's joint.
    directions
        Directions of differentiation, each slot → d(slot)/d(parameter). None: no derivatives;
        an empty list: only those by each trial's own parameters.

    Returns
    -------
    joint_angle (trial, joint, frame) [rad], NaN where time is, and all through a trial that could
    not be integrated; with directions also joint_angle_by_parameter (trial, joint, frame,
    other_joint, parameter), by (log k_v, log c_v, log c_p, q_ini), and joint_angle_by_direction
    (trial, joint, frame, direction).

    Examples
    --------
    >>> step = {name: (("trial", "joint"), [[value]]) for name, value in
    ...         {"k_v": 0.1, "c_v": 0.01, "c_p": 20.0, "q_ini": 0.03}.items()}
    >>> angles = simulate_joint_angle(
    ...     xr.Dataset(step), describe_unknown_finger(1), [10.0], [0.0], [0.04])
    >>> angles.joint_angle.values
    array([[[0.45]]])
    """
    values = [parameters[name].transpose("trial", "joint").to_numpy() for name in PARAMETERS]
    for name, value in zip(PARAMETERS[:3], values, strict=False):
        require_positive(name, value, "N m/rad" if name == "k_v" else "N m s/rad")
    require_finite("q_ini", values[3], "rad")
    natural = np.stack([*np.log(values[:3]), values[3]], axis=-1)
    trials, joints = values[0].shape
    tangents = [build_tangent(trials, joints, direction) for direction in directions or ()]
    angle, gradient = simulate_joint_angle_array(
        natural,
        build_slots(trials, joints, slots or {}),
        tangents,
        finger,
        time,
        load_time,
        load_torque,
        by_own=directions is not None,
    )
    result = xr.Dataset(
        {"joint_angle": (("trial", "joint", "frame"), angle)},
        coords=parameters[["trial", "joint"]].coords,
    )
    if directions is None:
        return result
    own = gradient[..., : 4 * joints].reshape(*angle.shape, joints, 4)
    dims = ("trial", "joint", "frame")
    return result.assign(
        joint_angle_by_parameter=((*dims, "other_joint", "parameter"), own),
        joint_angle_by_direction=((*dims, "direction"), gradient[..., 4 * joints :]),
    ).assign_coords(parameter=["log_k_v", "log_c_v", "log_c_p", "q_ini"])


def simulate_joint_angle_array(
    parameters: NDArray[np.float64],
    slots: SlotArrays,
    tangents: Sequence[SlotArrays],
    finger: Finger,
    time: ArrayLike,
    load_time: ArrayLike,
    load_torque: ArrayLike,
    *,
    by_own: bool = True,
    tolerance: float = TOLERANCE,
    longest_step: float = np.inf,
    route: Route = "quickest",
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Compute joint angles and tangents of trials.

    `simulate_joint_angle` on plain arrays.

    Parameters
    ----------
    parameters
        (trial, joint, 4): log k_v, log c_v, log c_p, q_ini.
    slots, tangents
        Of `build_slots` and `build_tangent`, one tangent for each direction.
    by_own
        Whether the gradient contains each trial's own parameters beside the directions.
    tolerance, longest_step
        [rad] inside a step, [s]; an infinite tolerance makes all steps the longest.
    route
        The general kernel, or the closed form, which has no slots but the joints' own parameters;
        or the quickest that applies.

    Returns
    -------
    angle (trial, joint, n) [rad] and gradient (trial, joint, n, 4 joint + direction): first by the
    parameters of joint 1, then of joint 2 … (`by_own`), then along the directions. NaN as there.
    """
    trials, joints, _ = parameters.shape
    check_load(load_time, load_torque)
    require_forward_in_time("time", np.asarray(time, float), padded=True)
    if finger.moment.size != joints:
        raise Fault(
            f"the parameters have {joints} joints and the finger {finger.moment.size}: "
            "they must have the same number"
        )
    changes = stack_tangents(slots, tangents)
    moved = find_moved_slots(slots, changes)
    check_slots(slots, sorted(moved))
    on = find_hooks((hook for effect in list_effects().values() for hook in effect.hooks), moved)
    _check_finger(finger, moved)
    rows = [np.asarray(a, float) for a in (time, load_time, load_torque)]
    rows = [np.array(np.broadcast_to(a, (trials, a.shape[-1])), order="C") for a in rows]
    if not any(hook.kind == "log" for hook in on):  # which may do something to every row
        rows[1:] = drop_idle_knots(*rows[1:])
    joint = slots.joint.copy()
    joint[..., :4] += parameters
    values = joint, *slots[1:]

    closed = _choose_closed_form(route, moved)
    sizes = [np.array(field, float, order="C") for field in finger[1:]]
    rest = () if closed else (*compile_hooks(on), float(finger.arm_ratio), *sizes)
    mixed, has_law = any(hook.mixes for hook in on), bool(moved & {*list_slots("law")})
    modes = max((hook.modes for hook in on), default=2)

    def run(some: slice) -> tuple[NDArray, NDArray]:
        if closed:
            history = (row[some] for row in rows)
            return run_closed_form(joint[some], changes[0][:, some], *history, by_own)
        return run_trials(
            *(value[some] for value in values),
            *(np.ascontiguousarray(change[:, some]) for change in changes),
            rest, modes, mixed, has_law, *(row[some] for row in rows),
            by_own, float(tolerance), float(longest_step),
        )  # fmt: skip

    return run_side_by_side(run, trials)


def _choose_closed_form(route: Route, moved: set[str]) -> bool:
    """Whether to take the closed form, else `Fault`."""
    on = sorted(moved - {*LOG_PARAMETERS})
    if route == "closed_form" and on:
        raise Fault(
            f"the closed form has no {', '.join(on)}: ask for the general route, or leave these "
            "slots at their null values"
        )
    return route != "general" and not on


def _check_finger(finger: Finger, moved: set[str]) -> None:
    for name in sorted(moved):
        if any(np.isnan(getattr(finger, field)).any() for field in SLOTS[name].needs):
            raise Fault(
                f"slot {name!r} needs the finger's lengths and masses, which are not declared: "
                "give them, or leave it at its null value"
            )
