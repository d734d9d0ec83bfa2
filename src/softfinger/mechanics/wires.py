"""The two wires.

How far they move with the joints, and the torque that their tension makes.

Per joint of length l_joint, with the wires at ±d from its middle, r = √((l_joint/2)² + d²) and
a = arctan(2 d / l_joint):

    l₁ = l_joint − 2 r cos(q/2 + a)   (flexion)      l₂ = l_joint − 2 r cos(q/2 − a)   (extension)

and the finger's wire is the sum over its joints (Honji, Arita, Tahara). A tension f makes the
torque τ_ac = P f, P = (∂l/∂q)ᵀ. The flexion wire's moment arm is thus r sin(q/2 + a), which is d
for the straight finger and grows as the joint bends.
"""

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.geometry import FingerGeometry

WIRES = ("flexion", "extension")


def compute_wire_excursion(joint_angle: xr.DataArray, geometry: FingerGeometry) -> xr.DataArray:
    """Compute how far each wire has moved.

    It is from the straight finger, Σ over joints of l(q) − l(0).

    Parameters
    ----------
    joint_angle
        (…, joint) [rad], 0 for the straight finger.

    Returns
    -------
    (wire, …) [m], positive towards the motor that pulls this wire.
    """
    half, offset = geometry.joint_length / 2, geometry.wire_offset
    bend = joint_angle / 2
    sideways, along = half * (1 - np.cos(bend)), offset * np.sin(bend)
    each = [(2 * (sideways + sign * along)).sum("joint") for sign in (1, -1)]
    return xr.concat(each, dim="wire").assign_coords(wire=list(WIRES)).rename("wire_excursion")


def compute_wire_jacobian(joint_angle: xr.DataArray, geometry: FingerGeometry) -> xr.DataArray:
    """Compute the wires' moment arms ∂l/∂q.

    One for each wire at each joint; the transpose is the paper's P.

    Parameters
    ----------
    joint_angle
        (…, joint) [rad].

    Returns
    -------
    (wire, …, joint) [m], positive for flexion, negative for extension.
    """
    flexion = compute_moment_arm_array(joint_angle, geometry.joint_length, geometry.wire_offset)
    extension = -compute_moment_arm_array(-joint_angle, geometry.joint_length, geometry.wire_offset)
    both = xr.concat(
        [joint_angle.copy(data=flexion), joint_angle.copy(data=extension)],
        dim="wire",
    )
    return both.assign_coords(wire=list(WIRES)).rename("wire_jacobian")


def compute_moment_arm_array(
    joint_angle: ArrayLike, joint_length: float, wire_offset: float
) -> NDArray[np.float64]:
    """Compute the flexion wire's moment arm.

    It is r sin(q/2 + a) = (l_joint/2) sin(q/2) + d cos(q/2).

    Parameters
    ----------
    joint_angle
        (…) [rad].
    joint_length, wire_offset
        [m].

    Returns
    -------
    (…) [m].

    Examples
    --------
    The paper calls the torque constant; over half a radian it grows by a sixth:

    >>> compute_moment_arm_array([0.0, 0.5], 0.008, 0.005).round(6)
    array([0.005   , 0.005834])
    """
    return moment_arm(np.asarray(joint_angle, float), joint_length / 2, wire_offset)


@compiled
def moment_arm(angle: NDArray, half_length: float, offset: float) -> NDArray:
    """(l_joint/2) sin(q/2) + d cos(q/2) [m], unchecked."""
    return half_length * np.sin(angle / 2) + offset * np.cos(angle / 2)


@compiled
def moment_arm_slope(angle: NDArray, half_length: float, offset: float) -> NDArray:
    """The derivative of `moment_arm` by the angle [m/rad]."""
    return (half_length * np.cos(angle / 2) - offset * np.sin(angle / 2)) / 2
