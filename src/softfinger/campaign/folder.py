"""A campaign's description, trials and faults."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal, cast

import numpy as np
import pandas as pd

from softfinger.campaign.description import FILE_NAME, Camera, DeclaredFinger, read_description
from softfinger.campaign.load_log import read_load, refuse_mixed_loads
from softfinger.campaign.recordings import read_angle_table, read_marker_table
from softfinger.campaign.specimen import Specimen
from softfinger.campaign.tables import read_text_table
from softfinger.faults import CampaignFault, TrialFault, show
from softfinger.gate import find_obstacle

TABLE_NAME = "trials.csv"
LONGEST_NAME, LONGEST_PATH = 200, 1000
MOST_TRIALS, MOST_COLUMNS = 100_000, 200
LEVELS = ("video", "markers", "angles")
Level = Literal["video", "markers", "angles"]


@dataclass(frozen=True)
class Trial:
    """One pull: recording, load log and notes."""

    name: str
    row: int
    level: Level
    recording: Path
    load: Path | None = None
    started_at: datetime | None = None
    covariates: Mapping[str, float] = field(default_factory=dict)


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
            set_aside[name if _is_name(name) else f"row {row + 2}"] = str(fault)
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


def _refuse_no_folder(folder: Path) -> None:
    try:
        if folder.is_dir():
            return
        reason = "it is no folder" if folder.exists() else "the folder does not exist"
    except OSError as error:
        reason = f"it cannot be read: {error.strerror}"
    raise CampaignFault(show(str(folder), 300)[1:-1], [reason])


def check_campaign(folder: Path | str) -> dict[str, str]:
    """List unusable trials of a campaign: trial → reason.

    It reads every table.

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
    """A campaign's description, table, recordings and logs.

    These are all text files that it is read from.
    """
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
    """Set aside marker tables of a specimen.

    It has no use for them.
    """
    reasons = {
        trial.name: f"{TABLE_NAME}, row {trial.row + 2}, column '{trial.level}': a specimen's "
        "recordings are tables with time_s and motion; name them in the column 'angles'"
        for trial in trials
        if trial.level == "markers"
    }
    return [trial for trial in trials if trial.name not in reasons], set_aside | reasons


def _read_covariates(folder: Path, table: pd.DataFrame) -> dict[str, np.ndarray]:
    faults = []
    if "trial" not in table.columns:
        faults.append("column 'trial' is missing")
    if not any(level in table.columns for level in LEVELS):
        faults.append(f"none of the columns {', '.join(LEVELS)} is there")
    if table.empty:
        faults.append("it has no rows")
    if len(table) > MOST_TRIALS or len(table.columns) > MOST_COLUMNS:
        faults.append(
            f"it has {len(table)} rows and {len(table.columns)} columns; expected at most "
            f"{MOST_TRIALS} and {MOST_COLUMNS}"
        )
    repeated = [] if "trial" not in table.columns else _find_repeated(table["trial"])
    faults += [f"the name {show(name)} stands more than once" for name in repeated]
    covariates = {}
    for column in table.columns.difference(["trial", "started_at", "load", *LEVELS], sort=False):
        text = table[column].str.strip()
        filled = ~text.str.lower().isin({"", "nan"})
        values = pd.to_numeric(text.where(filled, "nan"), errors="coerce").to_numpy(float)
        wrong = filled.to_numpy() & ~np.isfinite(values)
        if wrong.any():
            row = int(np.argmax(wrong))
            faults.append(
                f"row {row + 2}, column '{column}': is {show(text.iloc[row])}; a column that is "
                "not trial, started_at, load, video, markers or angles holds numbers"
            )
        covariates[column] = values
    if faults:
        raise CampaignFault(str(folder / TABLE_NAME), faults)
    return covariates


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
        "column 'load', for an assumed command and a logged load do not mix"
    )
    unlogged = {
        trial.name: f"{TABLE_NAME}, row {trial.row + 2} (trial {trial.name}): {reason}"
        for trial in trials
        if trial.load is None
    }
    return logged, set_aside | unlogged


def _find_repeated(names: pd.Series) -> list[str]:
    stripped = names.str.strip()
    return stripped[stripped.duplicated()].unique().tolist()


def _read_row(
    folder: Path, row: int, cells: Mapping[str, str], covariates: Mapping[str, float]
) -> Trial:
    place = f"{TABLE_NAME}, row {row + 2}"
    name = cells["trial"].strip()
    if not _is_name(name):
        raise TrialFault(
            f"{place}, column 'trial': is {show(name)}; expected a name of at most {LONGEST_NAME} "
            "characters that can be printed"
        )
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


def _is_name(name: str) -> bool:
    return 0 < len(name) <= LONGEST_NAME and name.isprintable()


def _resolve(folder: Path, text: str, place: str) -> Path:
    path = folder / text
    if not text.isprintable() or len(text) > LONGEST_PATH:
        raise TrialFault(f"{place}: is {show(text)}; expected the path of a file")
    try:
        outside = not path.resolve().is_relative_to(folder.resolve())
    except (RuntimeError, OSError):
        outside = False  # a circle of links, or a name too long: an obstacle
    if outside:
        raise TrialFault(f"{place}: '{text}' leads out of the campaign folder; move it inside")
    obstacle = find_obstacle(path)
    if obstacle:
        raise TrialFault(f"{place}: the file '{text}' {obstacle}")
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
            f"{place}, column 'started_at': is {show(text)}; expected ISO 8601, 2026-03-01T14:05:00"
        ) from None
    return moment if moment.tzinfo else moment.replace(tzinfo=UTC)
