"""Rule `conceal`: one sealed campaign of the proof."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from softfinger.concealed.generate import generate_campaign
from softfinger.concealed.proof import draw_proof
from softfinger.concealed.rig import Rig
from softfinger.concealed.seal import seal_file
from softfinger.stages.linear_algebra import on_one_thread
from softfinger.virtual_rig.film import film_trial


@on_one_thread
def conceal(
    *,
    campaign: Path,
    truth: Path,
    salt: Path,
    seal: Path,
    place: int,
    suite: Mapping[str, Any],
    config: Mapping[str, Any],
    seed: int,
) -> None:
    """Write a campaign, its truth and the seal.

    Parameters
    ----------
    place
        Which of the proof's cases, from 0.
    suite
        What `draw_proof` takes besides the seed.
    config
        What films depend on, of the `virtual_rig` block of the configuration.
    """
    spec = draw_proof(seed, **suite)[place]
    generate_campaign(spec, Path(campaign), Path(truth), partial(film, config))
    digest = seal_file(Path(truth), Path(salt))
    Path(seal).write_text(digest + "\n", encoding="utf-8")
    print(f"sealed: SHA-256 of truth and salt is {digest}")


def film(config: Mapping[str, Any], angle: np.ndarray, rig: Rig, path: Path, seed: int) -> None:
    """Film a trial (frame, joint) [rad], with noise."""
    motion = xr.Dataset({"joint_angle": (("trial", "frame", "joint"), angle[None])})
    film_trial(motion, {**config, "fps": rig.fps}, 0, path, seed)
