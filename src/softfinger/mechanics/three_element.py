"""The paper's joint.

It is a Kelvin–Voigt element (k_v, c_v) in series with a dashpot c_p.

    q(t) = e(t; k_v/c_v) / k_v + ∫u dt / c_p + q_ini,   e(t; r) = ∫ r exp(−r (t − s)) u(s) ds

which for a step K is (K/k_v)(1 − exp(−(k_v/c_v) t)) + (K/c_p) t + q_ini (Honji, Arita, Tahara,
"Stochastic Approach for Modeling the Soft Finger with the Creep Behavior"). The load is linear
between its knots, so one recursion over knots and times is exact; nothing is stepped.

ASSUME: inertia ignored; the torque does not depend on the angle.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.checks import require_finite, require_forward_in_time, require_positive
from softfinger.mechanics.load import check_load, fill_load_integral

ROUNDING = 4.0 * np.finfo(float).eps  # of times, by which equal steps may differ


def compute_elastic_basis_array(
    rate: ArrayLike, time: ArrayLike, load_time: ArrayLike, load_torque: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Compute the lagged load e(t).

    e(t) = ∫ r exp(−r (t − s)) u(s) ds, and its derivative by log r.

    Parameters
    ----------
    rate
        () or (m,) [1/s], r = k_v/c_v.
    time
        (n,) [s], nondecreasing; NaN gives NaN.
    load_time, load_torque
        (knot,) [s], [N m].

    Returns
    -------
    e, de_dlograte : (n,) or (m, n) [N m].

    Examples
    --------
    A unit step, half its way after ln 2 / r:

    >>> e, slope = compute_elastic_basis_array(2.0, [0.0, np.log(2) / 2], [0.0], [1.0])
    >>> e.round(6), slope.round(6)
    (array([0. , 0.5]), array([0.      , 0.346574]))
    """
    rate, time = np.asarray(rate, float), np.asarray(time, float)
    load_time, load_torque = np.asarray(load_time, float), np.asarray(load_torque, float)
    require_positive("rate", rate, "1/s")
    require_forward_in_time("time", time, padded=True)
    check_load(load_time, load_torque)
    rates = np.atleast_1d(rate)
    basis, slope = np.empty((rates.size, time.size)), np.empty((rates.size, time.size))
    _fill_bases(rates, time, load_time, load_torque, basis, slope)
    shape = (*rate.shape, time.size)
    return basis.reshape(shape), slope.reshape(shape)


def compute_joint_angle_array(
    k_v: ArrayLike,
    c_v: ArrayLike,
    c_p: ArrayLike,
    q_ini: ArrayLike,
    time: ArrayLike,
    load_time: ArrayLike,
    load_torque: ArrayLike,
) -> NDArray[np.float64]:
    """Compute the paper's joint angle q(t).

    The load is piecewise linear.

    Leading dimensions of all arguments broadcast against each other.

    Parameters
    ----------
    k_v, c_v, c_p, q_ini
        (…) [N m/rad], [N m s/rad], [N m s/rad], [rad]; c_p may be infinite: no flow.
    time
        (…, n) [s], nondecreasing, rows may end in NaN.
    load_time, load_torque
        (…, knot) [s], [N m].

    Returns
    -------
    (…, n) [rad].

    Examples
    --------
    0.04 N m on k_v = 0.1 N m/rad and c_p = 20 N m s/rad: 0.4 rad creep, 0.02 rad flow in 10 s.

    >>> compute_joint_angle_array(0.1, 0.01, 20.0, 0.03, [10.0], [0.0], [0.04])
    array([0.45])
    """
    parameters = (k_v, c_v, c_p, q_ini)
    return compute_joint_angle_gradient_array(*parameters, time, load_time, load_torque)[0]


def compute_joint_angle_gradient_array(
    k_v: ArrayLike,
    c_v: ArrayLike,
    c_p: ArrayLike,
    q_ini: ArrayLike,
    time: ArrayLike,
    load_time: ArrayLike,
    load_torque: ArrayLike,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Compute the joint angle and its derivatives.

    They are exact, by (log k_v, log c_v, log c_p, q_ini).

    Arguments as for `compute_joint_angle_array`.

    Returns
    -------
    joint_angle, gradient : (…, n) [rad] and (…, n, 4) [rad].
    """
    parameters = [np.asarray(value, float) for value in (k_v, c_v, c_p, q_ini)]
    time = np.asarray(time, float)
    load_time, load_torque = np.asarray(load_time, float), np.asarray(load_torque, float)
    require_positive("k_v", parameters[0], "N m/rad")
    require_positive("c_v", parameters[1], "N m s/rad")
    require_positive("c_p", parameters[2], "N m s/rad", infinite=True)
    require_finite("q_ini", parameters[3], "rad")
    require_forward_in_time("time", time, padded=True)
    check_load(load_time, load_torque)
    series = (time, load_time, load_torque)
    lead = np.broadcast_shapes(*(p.shape for p in parameters), *(s.shape[:-1] for s in series))
    flat = [np.broadcast_to(p, lead).ravel() for p in parameters]
    rows = [np.broadcast_to(s, lead + s.shape[-1:]).reshape(-1, s.shape[-1]) for s in series]
    angle, gradient = _fill_joint_angles(*flat, *rows)
    shape = (*lead, time.shape[-1])
    return angle.reshape(shape), gradient.reshape(*shape, 4)


@compiled
def _fill_joint_angles(
    k_v: NDArray,
    c_v: NDArray,
    c_p: NDArray,
    q_ini: NDArray,
    time: NDArray,
    load_time: NDArray,
    load_torque: NDArray,
) -> tuple[NDArray, NDArray]:
    rows, n = time.shape
    angle, gradient = np.empty((rows, n)), np.empty((rows, n, 4))
    basis, slope, integral = np.empty(n), np.empty(n), np.empty(n)
    for row in range(rows):
        rate = k_v[row] / c_v[row]
        fill_elastic_basis(rate, time[row], load_time[row], load_torque[row], basis, slope)
        fill_load_integral(time[row], load_time[row], load_torque[row], integral)
        for i in range(n):
            elastic, lagging = basis[i] / k_v[row], slope[i] / k_v[row]
            flow = integral[i] / c_p[row]
            angle[row, i] = elastic + flow + q_ini[row]
            gradient[row, i, 0] = lagging - elastic
            gradient[row, i, 1] = -lagging
            gradient[row, i, 2] = -flow
            gradient[row, i, 3] = 1.0 if angle[row, i] == angle[row, i] else np.nan
    return angle, gradient


@compiled
def _fill_bases(
    rates: NDArray,
    time: NDArray,
    load_time: NDArray,
    load_torque: NDArray,
    basis: NDArray,
    slope: NDArray,
) -> None:
    for row in range(rates.size):
        fill_elastic_basis(rates[row], time, load_time, load_torque, basis[row], slope[row])


@compiled
def fill_elastic_basis(
    rate: float,
    time: NDArray,
    load_time: NDArray,
    load_torque: NDArray,
    basis: NDArray,
    slope: NDArray,
) -> None:
    """Write e and de/dlog(rate).

    They go into `basis` and `slope` at nondecreasing times (n,), unchecked.

    One pass over the merged knots and times, O(n + knot).
    """
    last = load_time.size - 1
    knot = 0  # the first knot that lies after the present
    now, load, climb = load_time[0], 0.0, 0.0  # present time, load and its slope
    e, de = 0.0, 0.0
    before, lost = 0.0, 0.0  # the last step, and expm1(−rate · step)
    for i in range(time.size):
        if np.isnan(time[i]):
            basis[i] = np.nan
            slope[i] = np.nan
            continue
        while knot <= last and load_time[knot] <= time[i]:
            step = load_time[knot] - now
            e, de = advance_lag(rate * step, math.expm1(-rate * step), load, climb * step, e, de)
            now, load, climb = load_time[knot], load_torque[knot], 0.0
            if knot < last and load_time[knot + 1] > now:
                climb = (load_torque[knot + 1] - load) / (load_time[knot + 1] - now)
            knot += 1
        if knot > 0 and time[i] > now:
            step = time[i] - now
            if abs(step - before) > ROUNDING * abs(time[i]):  # frames are mostly even
                before, lost = step, math.expm1(-rate * step)
            e, de = advance_lag(rate * step, lost, load, climb * step, e, de)
            load += climb * step
            now = time[i]
        basis[i] = e
        slope[i] = de


@compiled
def advance_lag(
    z: float, lost: float, load: float, rise: float, e: float, de: float
) -> tuple[float, float]:
    """E and its slope after a step.

    e' = rate (u − e), u = load + rise · t/step; the slope is de/dlog(rate).

    e → e E + u (1 − E) + rise · (1 − φ),  E = exp(−z), φ = (1 − E)/z, z = rate · step; `lost` is
    E − 1.
    """
    decay = 1.0 + lost
    e_next, de_next = e * decay - load * lost, decay * (de + z * (load - e))
    if rise != 0.0:  # a load that rests needs no more
        ramp, ramp_slope = lag_of_ramp(z)
        e_next += rise * ramp
        de_next += rise * ramp_slope
    return e_next, de_next


@compiled
def lag_of_ramp(z: float) -> tuple[float, float]:
    """1 − φ(z) and its slope.

    The slope is by log z; φ = (1 − exp(−z))/z. It is exact to rounding for every z ≥ 0.
    """
    if z > 0.2:
        decay = math.exp(-z)
        phi = (1.0 - decay) / z
        return 1.0 - phi, phi - decay
    value, slope, term = 0.0, 0.0, -1.0  # the series Σ −(−z)^n / (n + 1)!
    for n in range(1, 11):
        term *= -z / (n + 1)
        value += term
        slope += n * term
    return value, slope
