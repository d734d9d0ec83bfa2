"""The moment arm of the wire.

Per joint of length l_joint, with the wires at ±d from its middle, r = √((l_joint/2)² + d²) and
a = arctan(2 d / l_joint):

    l₁ = l_joint − 2 r cos(q/2 + a)   (flexion)      l₂ = l_joint − 2 r cos(q/2 − a)   (extension)

and the finger's wire is the sum over its joints (Honji, Arita, Tahara). A tension f makes the
torque τ_ac = P f, P = (∂l/∂q)ᵀ. The flexion wire's moment arm is thus r sin(q/2 + a), which is d
for the straight finger and grows as the joint bends.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softfinger.compiled import compiled


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
