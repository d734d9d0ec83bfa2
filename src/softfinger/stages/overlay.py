"""Rule `overlay`: a trial's video with its markers."""

from pathlib import Path

from softfinger.artifacts import open_artifact, write_atomically
from softfinger.artifacts.specs.markers import SPEC
from softfinger.campaign import read_campaign
from softfinger.tracking.overlay import write_contact_sheet, write_overlay


def overlay(
    *, folder: Path, trial: str, video: Path, markers: Path, film: Path, sheet: Path
) -> None:
    """Write one trial's film (.avi) and sheet (.jpg)."""
    fps = read_campaign(folder).camera.fps
    found = open_artifact(markers, SPEC).sel(trial=trial)
    with write_atomically(film) as temporary:
        write_overlay(video, fps, found, temporary)
    with write_atomically(sheet) as temporary:
        write_contact_sheet(video, fps, found, temporary)
