"""The table of trials: its rows and their covariates."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal, cast

import numpy as np
import pandas as pd

from softfinger.campaign.tables import read_text_table
from softfinger.faults import CampaignFault, TrialFault, list_briefly, show
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


def read_trials_table(folder: Path) -> tuple[pd.DataFrame, dict[str, np.ndarray]]:
    """Read the table's text, and its covariates.

    Raises
    ------
    CampaignFault
        A cell is no number, a name is there twice, or the table has no rows or too many.
    """
    try:
        table = read_text_table(folder / TABLE_NAME)
    except TrialFault as fault:
        raise CampaignFault(str(folder), [str(fault)]) from None
    return table, _read_covariates(folder, table)


def _read_covariates(folder: Path, table: pd.DataFrame) -> dict[str, np.ndarray]:
    faults = []
    if "trial" not in table.columns:
        faults.append("column 'trial' is missing")
    if not any(level in table.columns for level in LEVELS):
        faults.append(f"none of the columns {', '.join(LEVELS)} is there")
    if table.empty:
        faults.append(
            "it has no rows; fill in one for each recording: its name in the column 'trial', its "
            f"file in one of the columns {', '.join(LEVELS)}"
        )
    if len(table) > MOST_TRIALS or len(table.columns) > MOST_COLUMNS:
        faults.append(
            f"it has {len(table)} rows and {len(table.columns)} columns; expected at most "
            f"{MOST_TRIALS} and {MOST_COLUMNS}"
        )
    repeated = [] if "trial" not in table.columns else _find_repeated(table["trial"])
    faults += [f"the name {show(name)} appears more than once" for name in repeated]
    if "trial" in table.columns:
        faults += list(_list_colliding(table["trial"]))
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
                "not trial, started_at, load, video, markers or angles contains numbers"
            )
        covariates[column] = values
    if faults:
        raise CampaignFault(str(folder / TABLE_NAME), faults)
    return covariates


def _find_repeated(names: pd.Series) -> list[str]:
    stripped = names.str.strip()
    return stripped[stripped.duplicated()].unique().tolist()


def _list_colliding(names: pd.Series) -> Iterator[str]:
    """Names whose files would be one file on some disks."""
    different = names.str.strip().drop_duplicates()
    folded = different.str.casefold()
    for _, group in different[folded.duplicated(keep=False)].groupby(folded):
        yield (
            f"the names {list_briefly([show(name) for name in group])} differ in capitals only; "
            "files named after them are one file on some disks; rename one"
        )


def read_row(
    folder: Path, row: int, cells: Mapping[str, str], covariates: Mapping[str, float]
) -> Trial:
    """Read one row.

    Raises
    ------
    TrialFault
        It has no name, names no file that can be read, or more than one recording.
    """
    place = f"{TABLE_NAME}, row {row + 2}"
    name = cells["trial"].strip()
    if not is_name(name):
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


def is_name(name: str) -> bool:
    """Whether a trial may be called so."""
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
