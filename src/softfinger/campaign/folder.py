"""A campaign's description, trials and faults."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, cast

import numpy as np
import pandas as pd

from softfinger.campaign.camera import Camera
from softfinger.campaign.description import FILE_NAME, DeclaredFinger, Description, read_description
from softfinger.campaign.load_log import read_load, refuse_mixed_loads
from softfinger.campaign.recordings import read_angle_table, read_marker_table
from softfinger.campaign.specimen import Specimen
from softfinger.campaign.trials import TABLE_NAME, Trial, is_name, read_row, read_trials_table
from softfinger.faults import CampaignFault, TrialFault, show


@dataclass(frozen=True)
class Campaign:
    """One finger or specimen, one rig, many trials.

    Trials are in the order in which they were recorded.

    A specimen is read as a finger of one joint; `specimen` then gives the units of its tables.
    """

    folder: Path
    name: str
    source: Literal["measured", "synthetic"]
    finger: DeclaredFinger
    camera: Camera | None
    noise_sd_rad: float | None
    trials: tuple[Trial, ...]
    set_aside: Mapping[str, str]
    specimen: Specimen | None = None


def read_campaign(folder: Path | str) -> Campaign:
    """Read a campaign's description and table of trials.

    Recordings are not opened.

    A row that names no usable recording is set aside with its reason.

    Raises
    ------
    CampaignFault
        The description or the table cannot be used at all, or no trial is left; every fault is
        listed.
    """
    folder = Path(folder)
    _refuse_no_folder(folder)
    description, (table, covariates) = _read_both(folder)
    trials, set_aside = [], {}
    for row, cells in enumerate(table.to_dict("records")):
        name = cells["trial"].strip()
        noted = {key: float(values[row]) for key, values in covariates.items()}
        try:
            trials.append(read_row(folder, row, cells, noted))
        except TrialFault as fault:
            set_aside[name if is_name(name) else f"row {row + 2}"] = str(fault)
    trials, set_aside = _set_aside_unlogged(trials, set_aside)
    if description.specimen is not None:
        trials, set_aside = _refuse_markers(trials, set_aside)
    videos = [trial for trial in trials if trial.level == "video"]
    if videos and description.camera is None:
        raise CampaignFault(
            str(folder / FILE_NAME), ["trials.csv names videos, but the key 'camera' is missing"]
        )
    if not trials:
        reasons = [f"trial {name}: {reason}" for name, reason in set_aside.items()]
        raise CampaignFault(str(folder / TABLE_NAME), ["no trial can be used", *reasons])
    return Campaign(
        folder=folder,
        name=description.name,
        source=description.source,
        finger=description.finger or DeclaredFinger(joints=1),
        specimen=description.specimen,
        camera=description.camera,
        noise_sd_rad=description.noise_sd_rad,
        trials=tuple(trials),
        set_aside=set_aside,
    )


def _read_both(
    folder: Path,
) -> tuple[Description, tuple[pd.DataFrame, dict[str, np.ndarray]]]:
    """Read description and table; list both their faults."""
    faults: list[CampaignFault] = []
    read: list[Any] = []
    for reader in (read_description, read_trials_table):
        try:
            read.append(reader(folder))
        except CampaignFault as fault:
            faults.append(fault)
    if len(faults) == 1:
        raise faults[0]
    if faults:
        said = [f"{Path(fault.place).name}, {line}" for fault in faults for line in fault.faults]
        raise CampaignFault(str(folder), said)
    return read[0], read[1]


def _refuse_no_folder(folder: Path) -> None:
    try:
        if folder.is_dir():
            return
        reason = "it is not a folder" if folder.exists() else "the folder does not exist"
    except OSError as error:
        reason = f"it cannot be read: {error.strerror}"
    raise CampaignFault(show(str(folder), 300)[1:-1], [reason])


def check_campaign(folder: Path | str) -> dict[str, str]:
    """List unusable trials of a campaign: trial → reason.

    Videos are only looked for; whether they decode is found out by tracking them.

    Raises
    ------
    CampaignFault
        As :func:`read_campaign`, or the trials log different kinds of load.
    """
    campaign = read_campaign(folder)
    reasons = dict(campaign.set_aside)
    kinds = {}
    for trial in campaign.trials:
        try:
            kinds[trial.name] = _check_trial(campaign, trial)
        except TrialFault as fault:
            reasons[trial.name] = str(fault)
    refuse_mixed_loads(campaign.name, kinds)
    return reasons


def list_tables(campaign: Campaign) -> list[Path]:
    """All text files that a campaign consists of."""
    recordings = [trial.recording for trial in campaign.trials if trial.level != "video"]
    logs = sorted({trial.load for trial in campaign.trials if trial.load is not None})
    return [campaign.folder / FILE_NAME, campaign.folder / TABLE_NAME, *recordings, *logs]


def _check_trial(campaign: Campaign, trial: Trial) -> str:
    """Read a trial's tables; the kind of its load."""
    if trial.level == "video":
        camera = cast(Camera, campaign.camera)
        return read_load(campaign, trial, 1.0 / camera.fps, 0.0)[2]
    read = read_angle_table if trial.level == "angles" else read_marker_table
    time = read(campaign, trial)["time"].to_numpy()
    interval = float(np.median(np.diff(time))) if time.size > 1 else 0.0
    return read_load(campaign, trial, interval, float(time[0]))[2]


def _refuse_markers(
    trials: list[Trial], set_aside: dict[str, str]
) -> tuple[list[Trial], dict[str, str]]:
    """Set aside marker tables of a specimen."""
    reasons = {
        trial.name: f"{TABLE_NAME}, row {trial.row + 2}, column '{trial.level}': a specimen's "
        "recordings are tables with time_s and motion; name them in the column 'angles'"
        for trial in trials
        if trial.level == "markers"
    }
    return [trial for trial in trials if trial.name not in reasons], set_aside | reasons


def _set_aside_unlogged(
    trials: list[Trial], set_aside: dict[str, str]
) -> tuple[list[Trial], dict[str, str]]:
    """Set aside unlogged trials where others have logs.

    A unit command is no newton.
    """
    logged = [trial for trial in trials if trial.load is not None]
    if not logged:
        return trials, set_aside
    reason = (
        f"its load is not logged, but that of {len(logged)} other trials is; name its log in the "
        "column 'load': an assumed command and a logged load do not mix"
    )
    unlogged = {
        trial.name: f"{TABLE_NAME}, row {trial.row + 2} (trial {trial.name}): {reason}"
        for trial in trials
        if trial.load is None
    }
    return logged, set_aside | unlogged
