"""The paper's two stages.

They are least squares of every trial, then a distribution over the estimates.

Stage 1: each trial and joint by ordinary least squares (`profile`). The frames are those that
`measure` keeps, as in every other stage: judged first by themselves, then by what a first fit
leaves. Each of them counts alike.
Stage 2: per joint and viscoelastic parameter, estimates that are negative or lie beyond three
median absolute deviations of the median are dropped; the rest gets a log-normal by maximum
likelihood (the sd of the logs with n − 1, as MATLAB's fitdist has it), q_ini a normal.

ASSUME: noise white, trials and parameters independent. Trap 5 of the paper: the rule on the raw,
skewed scale deflates σ and shifts μ, most for c_p; `outlier_rule: raw_mad` is the stricter reading.

References
----------
Honji, Arita, Tahara, "Stochastic Approach for Modeling the Soft Finger with the Creep Behavior".
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.collapse.basis import ElasticTable, interpolate_coefficients_array
from softfinger.inference.collapse.profile import Profile, build_joint_gram, profile_rates
from softfinger.inference.collapse.table import collapse_angles
from softfinger.inference.simulate import compute_motion
from softfinger.measurement.measure import LAYOUT, measure
from softfinger.mechanics import PARAMETERS

MAD_SCALE = {"scaled_mad": 1.4826, "raw_mad": 1.0}


def fit_least_squares(angles: xr.Dataset, config: Mapping[str, Any]) -> xr.Dataset:
    """Fit every trial by least squares.

    The population is then fitted over the kept estimates.

    Parameters
    ----------
    config
        The `estimation` block: outlier_rule (scaled_mad | raw_mad), outlier_cutoff.

    Returns
    -------
    Dataset
        estimate, estimate_sd, kept (trial, joint, parameter), in the parameters' own units;
        residual_rms (trial, joint) [rad]; population_mean, population_sd (joint, parameter), of
        the log for k_v, c_v, c_p. NaN where a joint was not seen, or too few were kept.
    """
    first = _fit_trials(angles, measure(angles))
    found = _fit_trials(angles, measure(angles, _move(angles, first)))
    estimate = found["estimate"].values
    kept = select_estimates_array(
        estimate, config["outlier_cutoff"] * MAD_SCALE[config["outlier_rule"]]
    )
    mean, spread = fit_population_array(estimate, kept)
    return found.assign(
        kept=(found["estimate"].dims, kept),
        population_mean=(("joint", "parameter"), mean),
        population_sd=(("joint", "parameter"), spread),
    )


def _fit_trials(angles: xr.Dataset, frames: xr.Dataset) -> xr.Dataset:
    """Estimates, sd and rms residuals of every trial."""
    collapse = collapse_angles(angles, frames)
    count = frames["used"].sum("frame").values
    joints, trials = angles.sizes["joint"], angles.sizes["trial"]
    estimate, sd = (np.full((trials, joints, 4), np.nan) for _ in range(2))
    rms = np.full((trials, joints), np.nan)
    for joint in range(joints):
        here = collapse.present[:, joint]
        gram = build_joint_gram(collapse, joint)[here]
        profile = profile_rates(gram, collapse.table)
        estimate[here, joint] = compute_estimates_array(profile)
        rms[here, joint] = np.sqrt(np.maximum(profile.rss, 0) / count[here])
        sd[here, joint] = compute_estimate_sd_array(profile, gram, collapse.table, count[here])
    dims = ("trial", "joint", "parameter")
    return xr.Dataset(
        {
            "estimate": (dims, estimate),
            "estimate_sd": (dims, sd),
            "residual_rms": (dims[:2], rms),
        },
        {"trial": angles["trial"], "joint": angles["joint"], "parameter": list(PARAMETERS)},
    )


def _move(angles: xr.Dataset, found: xr.Dataset) -> NDArray[np.float64]:
    """Motion (trial, joint, frame) [rad], 0 if unknown.

    A flow against the load is none; stiffness or damping of the wrong sign are unknown.
    """
    parameters = found["estimate"].to_dataset("parameter")
    flow = parameters["c_p"]
    known = (parameters["k_v"] > 0.0) & (parameters["c_v"] > 0.0)
    parameters = parameters.assign(c_p=flow.where(~(flow <= 0.0), np.inf)).where(known)
    return compute_motion(angles, parameters).fillna(0.0).transpose(*LAYOUT).values


def compute_estimates_array(profile: Profile) -> NDArray[np.float64]:
    """Turn linear coefficients into k_v, c_v, c_p, q_ini.

    They are (x, 1/k_v, 1/c_p, q_ini); the result is (trial, 4), of either sign.

    >>> compute_estimates_array(Profile(np.zeros(1), np.array([[4.0, -0.5, 0.1]]), np.zeros(1)))
    array([[ 0.25,  0.25, -2.  ,  0.1 ]])
    """
    with np.errstate(divide="ignore"):
        k_v, c_p = 1 / profile.linear[:, 0], 1 / profile.linear[:, 1]
    c_v = k_v * np.exp(-profile.log_rate)
    return np.column_stack([k_v, c_v, c_p, profile.linear[:, 2]])


def compute_estimate_sd_array(
    profile: Profile, gram: NDArray[np.float64], table: ElasticTable, count: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Compute the sd of the estimates from white noise.

    It is (trial, 4), linearised.

    NaN where the motion does not distinguish the parameters.
    """
    modes = table.value.shape[1]
    sd = np.full((len(gram), 4), np.nan)
    estimates = compute_estimates_array(profile)
    for i, (matrix, x) in enumerate(zip(gram, profile.log_rate, strict=True)):
        curve, bent = interpolate_coefficients_array(table, x)
        design = np.zeros((4, modes + 3))
        design[0, :modes], design[1, :modes] = curve, profile.linear[i, 0] * bent
        design[2, modes] = design[3, modes + 1] = 1.0
        normal = design @ matrix @ design.T
        size = np.sqrt(np.diag(normal))
        if not (size > 0).all() or np.linalg.cond(normal / np.outer(size, size)) > 1e12:
            continue
        covariance = np.linalg.inv(normal) * max(profile.rss[i], 0.0) / max(count[i] - 4, 1)
        k_v, c_v, c_p, _ = estimates[i]
        turn = np.zeros((4, 4))
        turn[0, 0], turn[1, 0], turn[1, 1] = -(k_v**2), -k_v * c_v, -c_v
        turn[2, 2], turn[3, 3] = -(c_p**2), 1.0
        sd[i] = np.sqrt(np.diag(turn @ covariance @ turn.T))
    return sd


def select_estimates_array(estimate: NDArray[np.float64], cutoff: float) -> NDArray[np.bool_]:
    """Select estimates that are positive and near the median.

    They are (trial, joint, 4), kept within cutoff · MAD of the median.

    The median and the MAD are those of the positive ones; q_ini is kept whenever it is finite.

    >>> k_v = np.array([1.0, 1.1, 0.9, 9.0, -1.0])
    >>> select_estimates_array(np.stack([k_v] * 4, axis=-1)[:, None], 3.0)[:, 0, 0]
    array([ True,  True,  True, False, False])
    """
    kept = np.isfinite(estimate)
    positive = kept[..., :3] & (estimate[..., :3] > 0)
    valid = np.where(positive, estimate[..., :3], np.nan)
    for joint in range(estimate.shape[1]):
        for k in range(3):
            some = valid[positive[:, joint, k], joint, k]
            if len(some) == 0:
                kept[:, joint, k] = False
                continue
            median = np.median(some)
            reach = cutoff * np.median(np.abs(some - median))
            distance = np.abs(estimate[:, joint, k] - median)
            kept[:, joint, k] = positive[:, joint, k] & (distance <= reach)
    return kept


def fit_population_array(
    estimate: NDArray[np.float64], kept: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Fit mean and sd of the population.

    They are (joint, 4), of the log for k_v, c_v, c_p. They are NaN of fewer than one and two
    values.
    """
    mean, sd = (np.full(estimate.shape[1:], np.nan) for _ in range(2))
    for joint, k in np.ndindex(*mean.shape):
        some = estimate[kept[:, joint, k], joint, k]
        some = some if k == 3 else np.log(some)
        if len(some) > 0:
            mean[joint, k] = some.mean()
        if len(some) > 1:
            sd[joint, k] = some.std(ddof=1)
    return mean, sd
