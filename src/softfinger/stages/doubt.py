"""Rule `doubt`: what looks wrong in a campaign."""

from pathlib import Path

from softfinger.artifacts import open_artifact, save_artifact
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.specs import doubts as doubts_spec
from softfinger.doubts import find_doubts, tabulate_doubts
from softfinger.provenance import describe_run


def doubt(*, angles: Path, doubts: Path) -> None:
    """Write what looks wrong in the recordings."""
    provenance = describe_run("doubt", {"angles": angles}, {})
    recorded = open_artifact(angles, angles_spec.SPEC)
    found = tabulate_doubts(find_doubts(recorded), recorded)
    save_artifact(found, doubts_spec.SPEC, doubts, provenance)
