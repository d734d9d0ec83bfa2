"""New trials drawn from populations, evenly spread by a scrambled Sobol sequence."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr, ndtri
from scipy.stats import qmc

from softfinger.mechanics.load import integrate_load_array
from softfinger.mechanics.three_element import compute_elastic_basis_array
from softfinger.propagation.moments import C_P, Q_INI


def draw_parameters_array(
    mu: NDArray[np.float64],
    sigma: NDArray[np.float64],
    n: int,
    rng: np.random.Generator,
    c_p_truncation_sd: float | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.int_], NDArray[np.float64]]:
    """Draw new trials' parameters, each from one of the populations.

    Parameters
    ----------
    mu, sigma
        (draw, 4): populations, all equally probable.
    n
        A power of two keeps the sequence balanced.

    Returns
    -------
    parameters (n, 4) in the order k_v, c_v, c_p, q_ini; draw (n,), the population of each; and
    z (n,), one more standard normal number each, for the noise.
    """
    share = qmc.Sobol(d=6, rng=rng).random_base2(int(np.ceil(np.log2(n))))[:n]
    draw = np.minimum((share[:, 0] * len(mu)).astype(int), len(mu) - 1)
    if c_p_truncation_sd is not None:
        outside = ndtr(-c_p_truncation_sd)
        share[:, 1 + C_P] = outside + share[:, 1 + C_P] * (1 - 2 * outside)
    tiny = np.finfo(float).eps
    z = ndtri(np.clip(share[:, 1:], tiny, 1 - tiny))
    parameters = mu[draw] + sigma[draw] * z[:, :4]
    parameters[:, :Q_INI] = np.exp(parameters[:, :Q_INI])
    return parameters, draw, z[:, 4]


def compute_angles_array(
    parameters: NDArray[np.float64], time: ArrayLike, load_time: ArrayLike, load_torque: ArrayLike
) -> NDArray[np.float64]:
    """Compute joint angles (n, time) [rad] of the paper's joint for parameters (n, 4).

    As `compute_joint_angle_array`, without the gradient, which would need four times the memory.

    >>> compute_angles_array(np.array([[0.1, 0.01, 20.0, 0.03]]), [10.0], [0.0], [0.04])
    array([[0.45]])
    """
    k_v, c_v, c_p, q_ini = parameters.T[:, :, None]
    lagged = compute_elastic_basis_array((k_v / c_v)[:, 0], time, load_time, load_torque)[0]
    return lagged / k_v + integrate_load_array(time, load_time, load_torque) / c_p + q_ini
