"""Rule `tracking_quality`: how well each filmed trial was tracked."""

from collections.abc import Sequence
from pathlib import Path

import xarray as xr

from softfinger.artifacts import open_artifact, save_artifact
from softfinger.artifacts.specs import markers as markers_spec
from softfinger.artifacts.specs import tracking_quality as quality_spec
from softfinger.provenance import describe_run
from softfinger.tracking.quality import compute_quality


def tracking_quality(*, markers: Sequence[Path], tracking_quality: Path) -> None:
    """Write the table of all filmed trials."""
    provenance = describe_run("tracking_quality", {"markers": markers}, {})
    parts = [compute_quality(open_artifact(path, markers_spec.SPEC)) for path in markers]
    save_artifact(xr.concat(parts, dim="trial"), quality_spec.SPEC, tracking_quality, provenance)
