"""Rule `film`: render the videos of some trials."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from softfinger.artifacts import open_artifact
from softfinger.artifacts.specs.truth import SPEC
from softfinger.progress import track_progress
from softfinger.provenance import derive_seed
from softfinger.virtual_rig.film import film_trial


def film(*, truth: Path, videos: Sequence[Path], config: Mapping[str, Any], seed: int) -> None:
    """Film the trials after which the videos are named."""
    motion = open_artifact(truth, SPEC)
    names = motion.trial.to_numpy().tolist()
    stream = derive_seed(seed, "virtual_rig")
    for video in track_progress([Path(v) for v in videos], "filming trials"):
        film_trial(motion, dict(config), names.index(video.stem), video, stream)
