"""Several campaigns of one finger as one folder, a session each."""

import csv
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
from ruamel.yaml import YAML

from softfinger.campaign.folder import Campaign
from softfinger.campaign.trials import Trial
from softfinger.faults import Fault
from softfinger.gate import read_document

SESSION = "session"
"""Column of trials.csv: which campaign a trial is of, from 1."""
ALIKE = ("joints", "link_length_m", "link_mass_kg", "link_centre_m", "link_inertia_kgm2",
         "joint_length_m", "wire_offset_m")  # fmt: skip


def join_campaigns(
    campaigns: Sequence[Campaign],
    tracked: Sequence[Mapping[str, pd.DataFrame]],
    folder: Path,
) -> None:
    """Write one campaign folder of several.

    Tables of angles and loads are copied as they are. Trials are named s1_…, s2_…, in the order of
    the campaigns.

    Parameters
    ----------
    campaigns
        Of one finger or specimen.
    tracked
        Of each campaign, trial → table of angles (time_s, q1_rad …) of trials that are videos or
        markers.
    folder
        Made anew.

    Raises
    ------
    Fault
        Joints, geometry or units differ.
    """
    refuse_unlike(campaigns)
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "angles").mkdir(parents=True)
    (folder / "load").mkdir()
    rows = []
    for number, (campaign, tables) in enumerate(zip(campaigns, tracked, strict=True), start=1):
        rows += [
            _copy_trial(trial, number, tables.get(trial.name), folder) for trial in campaign.trials
        ]
    columns = dict.fromkeys(key for row in rows for key in row)
    with (folder / "trials.csv").open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, list(columns), restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    with (folder / "campaign.yaml").open("w", encoding="utf-8", newline="\n") as stream:
        YAML().dump(_describe(campaigns), stream)


def list_joined(campaigns: Sequence[Campaign], folder: Path) -> list[Path]:
    """Files of the folder that `join_campaigns` writes."""
    files = [folder / "campaign.yaml", folder / "trials.csv"]
    for number, campaign in enumerate(campaigns, start=1):
        for trial in campaign.trials:
            name = name_joined(trial, number)
            files.append(folder / f"angles/{name}.csv")
            files += [] if trial.load is None else [folder / f"load/{name}.csv"]
    return files


def name_joined(trial: Trial, session: int) -> str:
    """A trial's name among those of all sessions."""
    return f"s{session}_{trial.name}"


def refuse_unlike(campaigns: Sequence[Campaign]) -> None:
    """Refuse campaigns of different fingers or units."""
    first = campaigns[0]
    for other in campaigns[1:]:
        where = f"{other.folder}: it cannot be joined to {first.folder}:"
        if (first.specimen is None) != (other.specimen is None):
            raise Fault(f"{where} one is of a finger, the other of a specimen; diagnose each alone")
        for key in ALIKE:
            mine, its = (getattr(c.finger, key) for c in (first, other))
            if mine != its:
                raise Fault(f"{where} finger.{key} is {its} and not {mine}; diagnose each alone")
        if first.specimen is not None and other.specimen is not None:
            for part in ("motion", "load"):
                mine, its = (getattr(c.specimen, part).unit for c in (first, other))
                if mine != its:
                    raise Fault(
                        f"{where} the unit of its {part} is {its} and not {mine}; "
                        "convert one of them"
                    )


def _copy_trial(trial: Trial, session: int, table: pd.DataFrame | None, folder: Path) -> dict:
    name = name_joined(trial, session)
    seen = f"angles/{name}.csv"
    if table is None:
        shutil.copyfile(trial.recording, folder / seen)
    else:
        table.to_csv(folder / seen, index=False, float_format="%.9g")
    row: dict[str, Any] = {"trial": name}
    row["started_at"] = "" if trial.started_at is None else trial.started_at.isoformat()
    row |= {"angles": seen, "load": ""}
    if trial.load is not None:
        row["load"] = f"load/{name}.csv"
        shutil.copyfile(trial.load, folder / row["load"])
    noted = {key: value for key, value in trial.covariates.items() if key != SESSION}
    return row | noted | {SESSION: session}


def _describe(campaigns: Sequence[Campaign]) -> dict[str, Any]:
    """Contents of campaign.yaml: the first's, with all names.

    A camera is declared where every campaign has one; a noise is measured anew.
    """
    described = [read_document(c.folder / "campaign.yaml").content for c in campaigns]
    first = {key: described[0][key] for key in ("finger", "specimen") if described[0].get(key)}
    if all(content.get("camera") for content in described):
        first["camera"] = described[0]["camera"]
    synthetic = any(c.source == "synthetic" for c in campaigns)
    return {
        "version": 1,
        "name": " + ".join(dict.fromkeys(c.name for c in campaigns))[:200],
        "source": "synthetic" if synthetic else "measured",
        **first,
    }
