"""Whether trials move with their load."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from softfinger.doubts.features import measure_noise, measure_unexplained, thin
from softfinger.doubts.response import choose_times, compute_terms, fit_response
from softfinger.faults import CampaignFault
from softfinger.measurement.flags import JUMP, MISSING

_ABOVE_NOISE = 5.0  # sd of the noise: what moves less has no sense
_UNEXPLAINED = 0.9  # of the motion: what its load explains less of has no sense


def refuse_wrong_sign(name: str, trials: Sequence[xr.Dataset]) -> None:
    """Refuse a campaign that moves against its load.

    Most trials must do so.

    Parameters
    ----------
    trials : sequence of Dataset
        ``time``, ``joint_angle``, ``angle_flag``, ``load_time`` and ``load_torque`` of each trial.

    Raises
    ------
    CampaignFault
        More trials move against the load than with it.
    """
    senses = np.array([find_sense(trial) for trial in trials])
    against = int((senses < 0).sum())
    if against > int((senses > 0).sum()):
        raise CampaignFault(
            name,
            [
                (
                    f"{against} of {len(trials)} trials move against the load; a positive load "
                    "must bend the finger positively: set finger.bends in campaign.yaml, or change "
                    "the sign of angles or load"
                )
            ],
        )


def find_sense(trial: xr.Dataset) -> int:
    """Whether a trial moves with its load (+1).

    It is −1 where it moves against it, and 0 where it moves too little.

    The sign is that of the causal creep response of the summed joint angles to the load, whatever
    the load's history; see :mod:`softfinger.doubts.response`.
    """
    time = trial["time"].to_numpy()
    good = (trial["angle_flag"] & (MISSING | JUMP)) == 0
    total = trial["joint_angle"].where(good).sum("joint", skipna=False).to_numpy()
    seen = np.isfinite(total)
    load_time, load = trial["load_time"].to_numpy(), trial["load_torque"].to_numpy()
    if seen.sum() < 4 or not np.any(load):
        return 0
    time, total = time[seen], total[seen][None]
    chosen = thin(time, load_time)
    times = choose_times(float(np.ptp(time)), float(np.median(np.diff(time))))
    terms = compute_terms(time[chosen], load_time, load, times)
    response = fit_response(terms, total[:, chosen], times)
    moved = float(np.ptp(total[:, chosen] - response.residual))
    noise = float(np.nan_to_num(measure_noise(total)[0][0]))
    if (
        moved <= _ABOVE_NOISE * noise
        or measure_unexplained(response, total[:, chosen]) > _UNEXPLAINED
    ):
        return 0
    return int(np.sign(response.amplitude.sum()))
