"""Doubts as the artifact `doubts`, and back."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from softfinger.doubts.doubt import Doubt


def tabulate_doubts(doubts: Sequence[Doubt], angles: xr.Dataset) -> xr.Dataset:
    """Build the artifact `doubts`.

    A doubt that names no trial or joint is about all of them.
    """
    names = angles["trial"].values.astype(str).tolist()
    joints = angles["joint"].values.tolist()
    about_trial = [[not d.trials or name in d.trials for name in names] for d in doubts]
    about_joint = [[not d.joints or joint in d.joints for joint in joints] for d in doubts]
    count = len(doubts)
    return xr.Dataset(
        {
            "kind": ("doubt", np.array([d.id for d in doubts], dtype=object)),
            "statement": ("doubt", np.array([d.statement for d in doubts], dtype=object)),
            "trial_doubted": (
                ("doubt", "trial"),
                np.array(about_trial, bool).reshape(count, len(names)),
            ),
            "joint_doubted": (
                ("doubt", "joint"),
                np.array(about_joint, bool).reshape(count, len(joints)),
            ),
        },
        coords={
            "doubt": np.arange(1, count + 1),
            "trial": angles["trial"].values,
            "joint": angles["joint"].values,
        },
        attrs={key: angles.attrs[key] for key in ("campaign", "source")},
    )
