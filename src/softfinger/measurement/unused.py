"""Why a trial informs nothing."""

import numpy as np
import xarray as xr

from softfinger.measurement.decisions import DECISIONS
from softfinger.measurement.saturation import find_saturated_frames


def explain_unused(angles: xr.Dataset, used: list[str]) -> dict[str, str]:
    """Explain why trials are not among those used.

    Parameters
    ----------
    angles
        The `angles` artifact.
    used
        Names of the trials of which enough frames inform.

    Returns
    -------
    dict
        Trial → what most of its frames suffer from, in words.
    """
    left = [name for name in angles["trial"].values.astype(str) if name not in used]
    return {name: _explain_trial(angles.sel(trial=[name])) for name in left}


def _explain_trial(one: xr.Dataset) -> str:
    """Find what most frames of one trial suffer from."""
    angle = one["joint_angle"].transpose("trial", "joint", "frame").values[0]
    flag = one["angle_flag"].transpose("trial", "joint", "frame").values[0]
    timed = np.isfinite(one["time"].transpose("trial", "frame").values[0])
    seen = np.isfinite(angle) & (flag == 0) & timed
    count, total = int(seen.any(axis=0).sum()), int(timed.sum())
    if count < DECISIONS.least_frames:
        return f"in {count} of its {total} frames a joint was seen"
    limit = int((find_saturated_frames(one)[0] & seen).any(axis=0).sum())
    rows = angle[:, seen.all(axis=0)]
    same = int((np.diff(rows, axis=1) == 0.0).all(axis=0).sum())
    causes = {
        f"{limit} of its {total} frames are at or after a limit of a sensor": limit,
        f"{same} of its {total} frames repeat the one before": same,
        f"in {total - rows.shape[1]} of its {total} frames a joint was not seen": total
        - rows.shape[1],
    }
    words = max(causes, key=lambda cause: causes[cause])
    if causes[words] > 0.5 * total:
        return words
    return f"its {total} frames scatter so much that none can be told from gross errors"
