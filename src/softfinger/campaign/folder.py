"""The campaign folder as a whole: its description, its trials and what is wrong with them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal, cast

import numpy as np
import pandas as pd

from softfinger.campaign.description import FILE_NAME, Camera, Finger, read_description
from softfinger.campaign.load_log import read_load
from softfinger.campaign.recordings import read_angle_table, read_marker_table
from softfinger.campaign.tables import read_text_table
from softfinger.faults import CampaignFault, TrialFault

TABLE_NAME = "trials.csv"
LEVELS = ("video", "markers", "angles")
Level = Literal["video", "markers", "angles"]


@dataclass(frozen=True)
class Trial:
    """One recorded pull: its recording, its load log and what else was noted."""

    name: str
    row: int
    level: Level
    recording: Path
    load: Path | None = None
    started_at: datetime | None = None
    covariates: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Campaign:
    """One finger, one rig, many trials, in the order in which they were recorded."""

    folder: Path
    name: str
    source: Literal["measured", "synthetic"]
    finger: Finger
    camera: Camera | None
    noise_sd_rad: float | None
    trials: tuple[Trial, ...]
    set_aside: Mapping[str, str]


def read_campaign(folder: Path | str) -> Campaign:
    """Read a campaign's description and its table of trials; recordings are not opened.

    A row that names no usable recording is set aside with its reason.

    Raises
    ------
    CampaignFault
        The description or the table cannot be used at all, or no trial is left; every fault is
        listed.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise CampaignFault(str(folder), ["the folder does not exist"])
    description = read_description(folder)
    try:
        table = read_text_table(folder / TABLE_NAME)
    except TrialFault as fault:
        raise CampaignFault(str(folder), [str(fault)]) from None
    covariates = _read_covariates(folder, table)
    trials, set_aside = [], {}
    for row, cells in enumerate(table.to_dict("records")):
        name = cells["trial"].strip()
        noted = {key: float(values[row]) for key, values in covariates.items()}
        try:
            trials.append(_read_row(folder, row, cells, noted))
        except TrialFault as fault:
            set_aside[name] = str(fault)
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
        finger=description.finger,
        camera=description.camera,
        noise_sd_rad=description.noise_sd_rad,
        trials=tuple(trials),
        set_aside=set_aside,
    )


def check_campaign(folder: Path | str) -> dict[str, str]:
    """Read every table of a campaign and list what would be set aside: trial → reason.

    Videos are only looked for; whether they decode is found out by tracking them.

    Raises
    ------
    CampaignFault
        As :func:`read_campaign`.
    """
    campaign = read_campaign(folder)
    reasons = dict(campaign.set_aside)
    for trial in campaign.trials:
        try:
            _check_trial(campaign, trial)
        except TrialFault as fault:
            reasons[trial.name] = str(fault)
    return reasons


def list_tables(campaign: Campaign) -> list[Path]:
    """Every text file that a campaign is read from: description, table, recordings and logs."""
    recordings = [trial.recording for trial in campaign.trials if trial.level != "video"]
    logs = sorted({trial.load for trial in campaign.trials if trial.load is not None})
    return [campaign.folder / FILE_NAME, campaign.folder / TABLE_NAME, *recordings, *logs]


def _check_trial(campaign: Campaign, trial: Trial) -> None:
    if trial.level == "video":
        camera = cast(Camera, campaign.camera)
        read_load(campaign, trial, 1.0 / camera.fps, 0.0)
        return
    read = read_angle_table if trial.level == "angles" else read_marker_table
    time = read(campaign, trial)["time"].to_numpy()
    interval = float(np.median(np.diff(time))) if time.size > 1 else 0.0
    read_load(campaign, trial, interval, float(time[0]))


def _read_covariates(folder: Path, table: pd.DataFrame) -> dict[str, np.ndarray]:
    faults = []
    if "trial" not in table.columns:
        faults.append("column 'trial' is missing")
    if not any(level in table.columns for level in LEVELS):
        faults.append(f"none of the columns {', '.join(LEVELS)} is there")
    if table.empty:
        faults.append("it has no rows")
    repeated = [] if "trial" not in table.columns else _find_repeated(table["trial"])
    faults += [f"the name '{name}' stands more than once" for name in repeated]
    covariates = {}
    for column in table.columns.difference(["trial", "started_at", "load", *LEVELS], sort=False):
        text = table[column].str.strip()
        filled = ~text.str.lower().isin({"", "nan"})
        values = pd.to_numeric(text.where(filled, "nan"), errors="coerce").to_numpy(float)
        wrong = filled.to_numpy() & ~np.isfinite(values)
        if wrong.any():
            row = int(np.argmax(wrong))
            faults.append(
                f"row {row + 2}, column '{column}': is '{text.iloc[row]}'; a column that is not "
                "trial, started_at, load, video, markers or angles holds numbers"
            )
        covariates[column] = values
    if faults:
        raise CampaignFault(str(folder / TABLE_NAME), faults)
    return covariates


def _find_repeated(names: pd.Series) -> list[str]:
    stripped = names.str.strip()
    return stripped[stripped.duplicated()].unique().tolist()


def _read_row(
    folder: Path, row: int, cells: Mapping[str, str], covariates: Mapping[str, float]
) -> Trial:
    place = f"{TABLE_NAME}, row {row + 2}"
    name = cells["trial"].strip()
    if not name or not name.isprintable():
        raise TrialFault(f"{place}, column 'trial': is {name!r}; expected a name")
    given = [level for level in LEVELS if cells.get(level, "").strip()]
    if len(given) != 1:
        found = " and ".join(given) if given else "none"
        raise TrialFault(
            f"{place} (trial {name}): expected one of {', '.join(LEVELS)}; found {found}"
        )
    level = cast(Level, given[0])
    load = cells.get("load", "").strip()
    return Trial(
        name=name,
        row=row,
        level=level,
        recording=_resolve(folder, cells[level].strip(), f"{place}, column '{level}'"),
        load=_resolve(folder, load, f"{place}, column 'load'") if load else None,
        started_at=_read_moment(cells.get("started_at", "").strip(), place),
        covariates=covariates,
    )


def _resolve(folder: Path, text: str, place: str) -> Path:
    path = folder / text
    try:
        outside = "\0" in text or not path.resolve().is_relative_to(folder.resolve())
    except RuntimeError:
        raise TrialFault(f"{place}: '{text}' is a link that leads in a circle") from None
    if outside:
        raise TrialFault(f"{place}: '{text}' leads out of the campaign folder; move it inside")
    if not path.is_file():
        raise TrialFault(f"{place}: the file '{text}' does not exist")
    if path.stat().st_size == 0:
        raise TrialFault(f"{place}: the file '{text}' is empty")
    return path


def _read_moment(text: str, place: str) -> datetime | None:
    if not text:
        return None
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        raise TrialFault(
            f"{place}, column 'started_at': is '{text}'; expected ISO 8601, 2026-03-01T14:05:00"
        ) from None
    return moment if moment.tzinfo else moment.replace(tzinfo=UTC)
