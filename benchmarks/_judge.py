"""What `softfinger check` says of a campaign of angles, in words for a table."""

from __future__ import annotations

from pathlib import Path

import xarray as xr

from softfinger.campaign import read_campaign
from softfinger.doubts import doubt_files, find_doubts
from softfinger.faults import Fault
from softfinger.tracking import assemble_angles


def judge(folder: Path) -> str:
    """The ids of its doubts, its refusal, or nothing."""
    try:
        campaign = read_campaign(folder)
        angles: xr.Dataset = assemble_angles(campaign, [])
    except Fault as fault:
        return f"refused: {str(fault).splitlines()[-1].strip()[:100]}"
    aside = angles.sizes["set_aside_trial"]
    said = [f"set aside {aside}"] if aside else []
    files = doubt_files({trial.name: trial.recording for trial in campaign.trials})
    return ", ".join([*said, *sorted({doubt.id for doubt in [*files, *find_doubts(angles)]})])
