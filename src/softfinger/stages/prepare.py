"""Bring any campaign to angles, nothing twice."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from softfinger.artifacts import open_artifact
from softfinger.artifacts.spec import ArtifactSpec
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.specs import markers as markers_spec
from softfinger.campaign import Campaign, Trial, list_tables, read_campaign
from softfinger.faults import ArtifactFault
from softfinger.provenance import Provenance, describe_run
from softfinger.stages.angles import angles
from softfinger.stages.keys import choose_settings
from softfinger.stages.track import track


def prepare_angles(folder: Path, out: Path, settings: Mapping[str, Any]) -> Path:
    """Make OUT/angles.nc, unless it is current.

    Current is what came from the same recordings, settings and code.
    """
    markers = track_campaign(folder, out, settings)
    config, target = choose_settings(settings, "angles"), out / "angles.nc"
    tables = list_tables(read_campaign(folder))
    expected = describe_run("angles", {"tables": tables, "markers": markers}, config)
    if not is_current(target, angles_spec.SPEC, expected):
        angles(folder=folder, tables=tables, markers=markers, angles=target, config=config)
    return target


def track_campaign(folder: Path, out: Path, settings: Mapping[str, Any]) -> list[Path]:
    """Make filmed campaigns' OUT/markers/*.nc, unless current."""
    described = read_campaign(folder)
    tables, made = list_tables(described), []
    for batch, trials in enumerate(batch_filmed(described, settings["trials_per_job"])):
        videos = [trial.recording for trial in trials]
        target = out / f"markers/{batch:04d}.nc"
        made.append(target)
        roles = {"tables": tables, "videos": videos}
        if not is_current(target, markers_spec.SPEC, describe_run("track", roles, {})):
            track(
                folder=folder,
                trials=[trial.name for trial in trials],
                tables=tables,
                videos=videos,
                markers=target,
            )
    return made


def batch_filmed(campaign: Campaign, size: int) -> list[list[Trial]]:
    """Trials that have a video, in job batches."""
    filmed = [trial for trial in campaign.trials if trial.level == "video"]
    return [filmed[first : first + size] for first in range(0, len(filmed), size)]


def is_current(path: Path, spec: ArtifactSpec, expected: Provenance) -> bool:
    """Whether an artifact is whole and current."""
    try:
        found = open_artifact(path, spec).attrs
    except ArtifactFault:
        return False
    return all(found.get(key) == value for key, value in expected.to_attrs().items())
