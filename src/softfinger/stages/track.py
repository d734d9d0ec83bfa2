"""Rule `track`: follow the markers through some videos."""

from collections.abc import Sequence
from pathlib import Path

from softfinger.artifacts import save_artifact
from softfinger.artifacts.specs.markers import SPEC
from softfinger.campaign import read_campaign
from softfinger.provenance import describe_run
from softfinger.tracking import track_trials


def track(
    *,
    folder: Path,
    trials: Sequence[str],
    tables: Sequence[Path],
    videos: Sequence[Path],
    markers: Path,
) -> None:
    """Write the marker positions of the named trials."""
    provenance = describe_run("track", {"tables": tables, "videos": videos}, {})
    found = track_trials(read_campaign(folder), trials)
    save_artifact(found, SPEC, markers, provenance)
