"""Whether trials move with their load: a wrong sign is found here, not in a posterior."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from softfinger.faults import CampaignFault
from softfinger.tracking.flags import JUMP, MISSING

_ABOVE_NOISE = 5.0  # frame-to-frame noise sd: what moves less has no sense


def refuse_wrong_sign(name: str, trials: Sequence[xr.Dataset]) -> None:
    """Refuse a campaign in which most trials move against their load.

    Parameters
    ----------
    name : str
        Of the campaign.
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
                    "must bend the finger positively: set finger.bends in campaign.yaml (videos "
                    "and markers), or turn the sign of the angles or of the load"
                )
            ],
        )


def find_sense(trial: xr.Dataset) -> int:
    """Whether a trial moves with its load (+1), against it (−1), or too little to say (0).

    Compares the summed joint angles of the tenth of frames under the strongest load, late ones
    before early ones, with those of the first frames.
    """
    time = trial["time"].to_numpy()
    good = (trial["angle_flag"] & (MISSING | JUMP)) == 0
    total = trial["joint_angle"].where(good).sum("joint", skipna=False).to_numpy()
    seen = np.isfinite(total)
    load = np.interp(time, trial["load_time"], trial["load_torque"], left=0.0)
    if seen.sum() < 4 or not np.any(load[seen]):
        return 0
    time, total, load = time[seen], total[seen], load[seen]
    count = max(1, seen.sum() // 10)
    strongest = np.lexsort((time, np.abs(load)))[-count:]
    first = np.flatnonzero(load == load[0])[: min(count, 3)]
    moved = np.median(total[strongest]) - np.median(total[first])
    # A load that stands from the first frame on began at zero.
    before = load[0] if np.ptp(load) > 0.0 else 0.0
    noise = 1.4826 * np.median(np.abs(np.diff(total))) / np.sqrt(2.0)
    if abs(moved) <= _ABOVE_NOISE * noise:
        return 0
    return int(np.sign(moved * (np.median(load[strongest]) - before)))
