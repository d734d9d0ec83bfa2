"""`softfinger join`: campaigns of one finger as one."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from softfinger.artifacts import open_artifact
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.campaign import Campaign, read_campaign
from softfinger.campaign.join import join_campaigns, refuse_unlike
from softfinger.faults import Fault
from softfinger.stages.prepare import prepare_angles


def join(folders: Sequence[Path], target: Path, settings: Mapping[str, Any]) -> Path:
    """Write several campaigns as one folder.

    Those that were filmed are tracked first, each with its own camera; what that makes is in a
    folder beside the target.

    Raises
    ------
    Fault
        Fewer than two campaigns, one twice, or of different fingers.
    """
    places = [folder.resolve() for folder in folders]
    if len(set(places)) < max(len(places), 2):
        raise Fault("give two or more campaign folders, each once")
    if target.resolve() in places:
        raise Fault(f"{target}: it is one of the campaigns; choose another folder for --out")
    campaigns = [read_campaign(folder) for folder in folders]
    refuse_unlike(campaigns)
    tracked = [
        _track(campaign, target.parent / f"{target.name}_tracked_{number}", settings)
        for number, campaign in enumerate(campaigns, start=1)
    ]
    join_campaigns(campaigns, tracked, target)
    return target


def join_recordings(
    *,
    tables: Sequence[str],
    videos: Sequence[str],
    folders: Sequence[str],
    target: str,
    config: Mapping[str, Any],
) -> None:
    """Join campaigns for the workflow.

    Parameters
    ----------
    tables, videos
        All files that the campaigns name; they are read through the folders.
    config
        Block `tracking`, and `trials_per_job`.
    """
    join([Path(folder) for folder in folders], Path(target), config)


def _track(campaign: Campaign, out: Path, settings: Mapping[str, Any]) -> dict[str, pd.DataFrame]:
    """Angles of a campaign's trials that are not tables already."""
    if all(trial.level == "angles" for trial in campaign.trials):
        return {}
    angles = open_artifact(prepare_angles(campaign.folder, out, settings), angles_spec.SPEC)
    tables = {}
    for name in angles["trial"].values.astype(str):
        seen = angles.sel(trial=name)
        kept = np.isfinite(seen["time"].values)
        usable = np.where(seen["angle_flag"].values == 0, seen["joint_angle"].values, np.nan)
        columns = {"time_s": seen["time"].values[kept]}
        columns |= {f"q{j + 1}_rad": row[kept] for j, row in enumerate(usable)}
        tables[name] = pd.DataFrame(columns)
    return tables
