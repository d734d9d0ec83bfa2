"""What a viscoelastic network does.

Creep compliance, relaxation modulus, response to a load.

Springs and dashpots alone are exact in O(n) (`prony`); a network with a springpot goes through the
inverse Laplace transform (`laplace`), to 1e-10 relatively, in O(n × knots).
"""

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from softfinger.faults import Fault
from softfinger.mechanics.checks import require_forward_in_time
from softfinger.mechanics.load import (
    check_load,
    evaluate_load_array,
    integrate_load_array,
)
from softfinger.mechanics.three_element import compute_elastic_basis_array
from softfinger.mechanics.viscoelastic.elements import (
    Element,
    compute_impulse,
    compute_instant_compliance,
    compute_regular_stiffness,
    compute_transfer_function,
    is_fractional,
)
from softfinger.mechanics.viscoelastic.laplace import invert_laplace_array
from softfinger.mechanics.viscoelastic.prony import expand_compliance, expand_stiffness


def compute_creep_compliance(element: Element, time: xr.DataArray) -> xr.DataArray:
    """Compute the creep compliance J(t).

    Parameters
    ----------
    time
        (…) [s], ≥ 0; at 0 the value just after the step.

    Returns
    -------
    (…) [rad/(N m)].
    """
    result = time.copy(data=compute_creep_compliance_array(element, time.to_numpy()))
    return result.rename("creep_compliance")


def compute_relaxation_modulus(element: Element, time: xr.DataArray) -> tuple[float, xr.DataArray]:
    """Compute the relaxation modulus G(t).

    Parameters
    ----------
    time
        (…) [s], > 0.

    Returns
    -------
    The weight of the impulse at 0 [N m s/rad], which a dashpot alone on its way makes (Kelvin–Voigt
    and the paper's joint have one), and the regular part (…) [N m/rad].
    """
    impulse, regular = compute_relaxation_modulus_array(element, time.to_numpy())
    return impulse, time.copy(data=regular).rename("relaxation_modulus")


def compute_creep_compliance_array(element: Element, time: ArrayLike) -> NDArray[np.float64]:
    """Compute J(t) [rad/(N m)].

    At times (…) [s], ≥ 0, of the same shape.

    Examples
    --------
    The paper's joint: (1 − e^{−k_v t/c_v})/k_v + t/c_p.

    >>> from softfinger.mechanics.viscoelastic.elements import three_element
    >>> compute_creep_compliance_array(three_element(0.1, 0.1, 20.0), [0.0, np.log(2)]).round(6)
    array([0.      , 5.034657])
    """
    time = _check_time(time, 0.0)
    if is_fractional(element):
        after = np.where(time > 0.0, time, 1.0)
        creep = invert_laplace_array(lambda s: compute_transfer_function(element, s) / s, after)
        return np.where(time > 0.0, creep, compute_instant_compliance(element))
    constant, weight, rate = expand_compliance(element)
    still = rate == 0.0
    share = -np.expm1(-rate * time[..., None]) / np.where(still, 1.0, rate)
    return constant + (weight * np.where(still, time[..., None], share)).sum(-1)


def compute_relaxation_modulus_array(
    element: Element, time: ArrayLike
) -> tuple[float, NDArray[np.float64]]:
    """Compute the parts of G(t).

    The impulse's weight [N m s/rad], and the regular part (…) [N m/rad] for t > 0.

    Examples
    --------
    >>> from softfinger.mechanics.viscoelastic.elements import kelvin_voigt
    >>> compute_relaxation_modulus_array(kelvin_voigt(2.0, 0.5), [1.0])
    (0.5, array([2.]))
    """
    time = _check_time(time, np.finfo(float).tiny)
    if is_fractional(element):
        regular = invert_laplace_array(lambda s: compute_regular_stiffness(element, s) / s, time)
        return compute_impulse(element), regular
    constant, weight, rate = expand_stiffness(element)
    return float(constant), (weight * np.exp(-rate * time[..., None])).sum(-1)


def compute_network_response_array(
    element: Element, time: ArrayLike, load_time: ArrayLike, load_torque: ArrayLike
) -> NDArray[np.float64]:
    """Compute the angle under a piecewise-linear torque.

    There is no stepping.

    Parameters
    ----------
    time
        (n,) [s], nondecreasing.
    load_time, load_torque
        (knot,) [s], [N m]; 0 before the first knot, the last value after the last.

    Returns
    -------
    (n,) [rad]; at a step of the load, the value just after it.
    """
    time = np.asarray(time, float)
    load_time, load_torque = np.asarray(load_time, float), np.asarray(load_torque, float)
    require_forward_in_time("time", time)
    check_load(load_time, load_torque)
    if is_fractional(element):
        return _superpose(element, time, load_time, load_torque)
    constant, weight, rate = expand_compliance(element)
    angle = constant * evaluate_load_array(time, load_time, load_torque)
    for b, r in zip(weight, rate, strict=True):
        if r == 0.0:
            angle += b * integrate_load_array(time, load_time, load_torque)
        else:
            angle += b / r * compute_elastic_basis_array(r, time, load_time, load_torque)[0]
    return angle


def _superpose(
    element: Element, time: NDArray, load_time: NDArray, load_torque: NDArray
) -> NDArray[np.float64]:
    """Sum responses to steps (J), bends (∫J dt)."""
    length, rise = np.diff(load_time), np.diff(load_torque)
    slope = np.divide(rise, length, out=np.zeros_like(rise), where=length > 0.0)
    jumps = np.append(load_torque[0], np.where(length > 0.0, 0.0, rise))
    bends = np.diff(slope, prepend=0.0, append=0.0)
    angle = np.zeros_like(time)
    for knot, jump, bend in zip(load_time, jumps, bends, strict=True):
        later = time > knot
        since = time[later] - knot
        if jump != 0.0:
            angle[later] += jump * compute_creep_compliance_array(element, since)
            angle[time == knot] += jump * compute_instant_compliance(element)
        if bend != 0.0:
            angle[later] += bend * invert_laplace_array(
                lambda s: compute_transfer_function(element, s) / s**2, since
            )
    return angle


def _check_time(time: ArrayLike, lowest: float) -> NDArray[np.float64]:
    time = np.asarray(time, float)
    bad = ~((time >= lowest) & (time < np.inf))
    if bad.any():
        bound = "finite and at least 0" if lowest == 0.0 else "finite and after 0"
        raise Fault(f"time = {time[bad].flat[0]:g} s: it must be {bound}")
    return time
