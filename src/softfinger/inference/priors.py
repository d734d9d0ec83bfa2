"""Priors chosen on the scale of angles.

The load and the clock alone carry them to parameters.

With K the largest load of the campaign, T its median duration under load and Δ the median frame
interval, a joint is expected to bend elastically by about half a radian, to take between a frame
and a recording to do so, and to flow by about a tenth of a radian within a recording:

    log k_v about log(K / 0.5),  log c_v about log(K / 0.5 · √(T Δ)),  log c_p about log(K T / 0.1)

each with an sd that allows factors of 20 to 50 either way. No angle is looked at, so a tension in
newtons, a torque and a bare command need no tuning. The mode, the evidence, the diagnosis and the
sampled posterior share this prior of μ. That of the spread differs: Laplace's approximation needs
one that is conjugate (`spread`), the sampled posterior has a log-normal one.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.faults import Fault


@dataclass(frozen=True)
class InferencePriors:
    """What an inference assumes before any data."""

    elastic_rad: float = 0.5
    """[rad] that a joint is expected to bend elastically. Why: it is seen, and does not break."""
    flow_rad: float = 0.1
    """[rad] that it is expected to flow. Why: a soft polymer's share of that."""
    mu_sd: tuple[float, ...] = (1.5, 2.0, 2.0, 0.5)
    """Sds of the parameters' means, [rad] for q_ini. Why: factors of 20 to 50.

    Test: `test_priors.py::test_one_prior_of_the_mean_serves_all`.
    """
    sigma_median: tuple[float, ...] = (0.3, 0.3, 0.3, 0.02)
    """Medians of the spreads between trials. Why: the paper's finger has 0.1 to 0.6."""
    sigma_log_sd: float = 1.0
    """Sd of the spreads' logarithm. Why: a factor of seven either way."""
    noise_log_sd: float = 0.05
    """Sd of the log of the noise's scale. Why: what REML leaves of it."""
    spread: tuple[float, ...] = (0.2, 0.3, 0.4, 0.01)
    """Typical spreads in Laplace's approximation, where Ω is inverse-Wishart. Why: conjugate."""
    spread_weight: float = 2.0
    """What they count as, in trials. Why: the least that keeps Ω off zero for one trial."""
    lkj_shape: float = 2.0
    """Of correlations of parameters over trials. Why: weakly against ±1."""
    load_sizes: tuple[float, ...] = (0.001, 0.002, 0.005, 0.01, 0.02)
    """Equally likely relative sds of a load log's row. Why: a good cell up to a bad one."""
    load_drift_sizes: tuple[float, ...] = (0.003, 0.01, 0.03)
    """The same of its gain's drift at the end. Why: a warming cell, up to a bad one."""
    jitter_sizes_s: tuple[float, ...] = (0.0005, 0.001, 0.002, 0.004, 0.008)
    """[s] The same of a frame's time. Why: up to a quarter of a frame."""
    before_kick_s: float = 0.005
    """[s] How long before a kick a frame may be that was taken after it. Why: clocks jitter so.
    Test: `test_disturbances.py::test_a_frame_before_a_kick_may_have_been_taken_after_it`.
    """
    offset_sizes_s: tuple[float, ...] = (0.001, 0.003, 0.01, 0.03)
    """[s] The same of a trial's clock. Why: up to a frame."""
    rate_sizes: tuple[float, ...] = (1e-4, 3e-4, 1e-3, 3e-3)
    """The same of its rate. Why: a quartz has 1e-4 at worst, a driver's clock 1e-3."""
    step_sizes: tuple[float, ...] = (0.5, 1.0)
    """The same of steps in a slow log's gaps: 1 is any moment of them. Why: or nearer the middle.

    Test: `test_step_scatter.py::test_steps_between_the_rows_of_a_slow_log_are_found`.
    """
    drift_sizes: tuple[float, ...] = (0.5, 1.0, 2.0, 4.0)
    """The same of the picture's drift, over the noise. Why: hardly seen up to plain."""
    lasting_sizes: tuple[float, ...] = (0.5, 1.0, 2.0, 4.0)
    """The same of noise that lasts longer: 1 is twice as long. Why: windows show it to that."""
    flicker_sizes: tuple[float, ...] = (0.25, 0.5, 1.0, 2.0, 4.0)
    """The same of noise with equal power in each octave. Why: as of drifts."""
    gain_drift_sizes: tuple[float, ...] = (0.003, 0.01, 0.03)
    """The same of the gain of the angles' own sensor. Why: as of a load cell's."""
    largest_share: float = 0.05
    """Sd of what a disturbance adds, of the largest motion. Why: what errs more is broken.

    Test: `test_disturbances.py::test_what_asks_for_more_than_a_drift_is_no_drift`.
    """
    effect_spreads: tuple[float, ...] = (0.03, 0.1, 0.3)
    """Equally likely relative sds of an effect's parameter between trials. Why: a new mounting."""


PRIORS = InferencePriors()


class PopulationPrior(NamedTuple):
    """Normal priors of μ and log σ.

    μ ~ normal(mu_mean, mu_sd) and log σ ~ normal(log sigma_median, sigma_log_sd), each (4,).

    Noise: its scale over what was estimated, log s ~ normal(0, noise_log_sd).
    """

    mu_mean: NDArray[np.float64]
    mu_sd: NDArray[np.float64]
    sigma_median: NDArray[np.float64]
    sigma_log_sd: NDArray[np.float64]
    noise_log_sd: float


def build_prior(angles: xr.Dataset, frames: xr.Dataset) -> PopulationPrior:
    """Build a campaign's priors from loads and clock.

    Parameters
    ----------
    frames
        What `select_frames` gives for it.

    Raises
    ------
    Fault
        If no trial has any load.
    """
    load = angles["load_torque"].transpose("trial", "knot").values
    used = frames["used"].values
    largest = np.abs(load[used.any(axis=1)]).max()
    if largest == 0:
        raise Fault(
            "the load is 0 in every trial: such recordings do not determine the parameters; "
            "check the load logs"
        )
    duration = _compute_duration(angles, used)
    k_v = largest / PRIORS.elastic_rad
    centre = [k_v, k_v * np.sqrt(duration * float(frames["frame_interval"]))]
    centre += [largest * duration / PRIORS.flow_rad]
    return PopulationPrior(
        mu_mean=np.array([*np.log(centre), 0.0]),
        mu_sd=np.array(PRIORS.mu_sd),
        sigma_median=np.array(PRIORS.sigma_median),
        sigma_log_sd=np.full(4, PRIORS.sigma_log_sd),
        noise_log_sd=PRIORS.noise_log_sd,
    )


def _compute_duration(angles: xr.Dataset, used: NDArray[np.bool_]) -> float:
    """Median time [s] from load to last frame."""
    time = angles["time"].transpose("trial", "frame").values
    knots = angles["load_time"].transpose("trial", "knot").values
    load = angles["load_torque"].transpose("trial", "knot").values
    spans = []
    for i in np.flatnonzero(used.any(axis=1) & (load != 0).any(axis=1)):
        onset = max((load[i] != 0).argmax() - 1, 0)
        begin = knots[i, onset] if load[i, 0] == 0 else knots[i, 0]
        spans.append(time[i][used[i]].max() - max(begin, time[i][used[i]].min()))
    return float(np.median(spans))
