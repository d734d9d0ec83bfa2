"""A new campaign folder out of imported trials."""

import io
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from ruamel.yaml import YAML

from softfinger.campaign import DeclaredFinger
from softfinger.campaign.units import find_factor
from softfinger.faults import Fault
from softfinger.importing.build import ImportedTrial
from softfinger.importing.description import FILE_NAME, ImportDescription, format_description
from softfinger.importing.faults import ImportFault

DIGITS = "%.10g"


def refuse_existing(out: Path) -> None:
    """Refuse a folder that contains a campaign already.

    Raises
    ------
    ImportFault
        It does.
    """
    names = ("campaign.yaml", "trials.csv", "angles", "markers", "load")
    there = [name for name in names if (out / name).exists()]
    if there:
        raise ImportFault(
            f"{out}: it contains {', '.join(there)} already, and nothing is overwritten; name "
            "another "
            "folder with --out"
        )


def write_campaign(
    out: Path,
    description: ImportDescription,
    trials: Sequence[ImportedTrial],
    guessed: Sequence[str],
) -> None:
    """Write a campaign folder and its import description.

    Raises
    ------
    ImportFault
        The folder contains a campaign already.
    """
    refuse_existing(out)
    out.mkdir(parents=True, exist_ok=True)
    rows = [
        _write_trial(out, description, trial, stem)
        for trial, stem in zip(trials, name_files([t.name for t in trials]), strict=True)
    ]
    table = pd.DataFrame(rows)
    table.dropna(axis=1, how="all").to_csv(out / "trials.csv", index=False)
    content = describe_campaign(description, trials)
    (out / "campaign.yaml").write_text(_format(content), encoding="utf-8")
    if not (out / FILE_NAME).exists():
        text = format_description(description, guessed)
        (out / FILE_NAME).write_text(text, encoding="utf-8")


def name_files(names: Sequence[str]) -> list[str]:
    """Names of files for a file system.

    Also for one to which capitals make no difference.

    >>> name_files(["a/b", "a b", "a_b", "A_b"])
    ['a_b', 'a_b_2', 'a_b_3', 'A_b_4']
    """
    given: list[str] = []
    for name in names:
        stem = re.sub(r"[^\w.+-]+", "_", name).strip("._") or "trial"
        taken, own = [g.casefold() for g in given], stem.casefold()
        count = sum(own in (g, re.sub(r"_\d+$", "", g)) for g in taken)
        given.append(f"{stem}_{count + 1}" if own in taken else stem)
    return given


def describe_campaign(
    description: ImportDescription, trials: Sequence[ImportedTrial]
) -> dict[str, Any]:
    """Content of ``campaign.yaml``: a finger or specimen."""
    head: dict[str, Any] = {
        "version": 1, "name": description.name, "source": description.source,
    }  # fmt: skip
    joints = count_joints(description, trials)
    if joints:
        declared = description.finger.model_dump(exclude_unset=True) if description.finger else {}
        finger = {**declared, "joints": joints}
        if trials[0].points and description.motion.sign == -1:
            finger["bends"] = "clockwise"
        return {**head, "finger": DeclaredFinger.model_validate(finger).model_dump(
            mode="json", exclude_defaults=True)}  # fmt: skip
    motion, load = description.motion, description.load
    known = {"quantity": load.quantity or "load", "unit": load.unit or "1"}
    if load.none:
        known = {"quantity": "command", "unit": "1"}
    return {
        **head,
        "specimen": {
            "motion": {"quantity": motion.quantity, "unit": motion.unit},
            "load": known,
        },
    }


def count_joints(description: ImportDescription, trials: Sequence[ImportedTrial]) -> int:
    """Number of joints of a finger, else 0."""
    if trials[0].points:
        return len(trials[0].points) - 2
    return trials[0].motion.shape[1] if description.motion.quantity == "angle" else 0


def _format(content: dict[str, Any]) -> str:
    stream = io.StringIO()
    YAML().dump(content, stream)
    return stream.getvalue()


def _write_trial(
    out: Path, description: ImportDescription, trial: ImportedTrial, stem: str
) -> dict[str, Any]:
    level = "markers" if trial.points else "angles"
    path = f"{level}/{stem}.csv"
    table = _lay_out_markers(trial) if trial.points else _lay_out_motion(description, trial)
    _save(table, out / path)
    row: dict[str, Any] = {"trial": trial.name, "started_at": None, level: path, "load": None}
    if trial.started_at is not None:
        row["started_at"] = trial.started_at.isoformat(timespec="milliseconds")
    if trial.load.size:
        row["load"] = f"load/{stem}.csv"
        joints = count_joints(description, [trial])
        column, factor = find_load_column(description) if joints else ("load", 1.0)
        log = pd.DataFrame({"time_s": trial.load_time, column: trial.load * factor})
        _save(log, out / row["load"])
    return row | dict(trial.covariates)


def find_load_column(description: ImportDescription) -> tuple[str, float]:
    """Column of a finger's load log.

    The factor into the column's unit is returned too.

    A tension needs the wire's offset; without it, and for any other quantity, the load is a
    command, in whatever unit it was logged.
    """
    load, finger = description.load, description.finger
    wanted = {"torque_nm": "N*m"}
    if load.quantity == "tension" and finger is not None and finger.wire_offset_m is not None:
        wanted = {"tension_n": "N"}
    for column, unit in wanted.items():
        if load.quantity in ("torque", "tension"):
            try:
                return column, find_factor(load.unit or "1", unit)
            except Fault:
                continue
    return "command", 1.0


def _lay_out_motion(description: ImportDescription, trial: ImportedTrial) -> pd.DataFrame:
    angles = description.motion.quantity == "angle"
    names = [f"q{k + 1}_rad" for k in range(trial.motion.shape[1])] if angles else ["motion"]
    return pd.DataFrame({"time_s": trial.time, **dict(zip(names, trial.motion.T, strict=True))})


def _lay_out_markers(trial: ImportedTrial) -> pd.DataFrame:
    """Long table of a chain of markers.

    Each link goes from one point to the next; the first one is the base.
    """
    place = trial.motion.reshape(len(trial.time), -1, 2)
    parts = []
    for link in range(len(trial.points) - 1):
        name = "base" if link == 0 else f"link_{link}"
        for end in (0, 1):
            x, y = place[:, link + end].T
            seen = np.isfinite(x)
            parts.append(pd.DataFrame({
                "time_s": trial.time[seen], "marker": f"{name}_{end + 1}",
                "x_px": x[seen], "y_px": y[seen],
            }))  # fmt: skip
    return pd.concat(parts).sort_values("time_s", kind="stable")


def _save(table: pd.DataFrame, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    table.to_csv(path, index=False, float_format=DIGITS)
