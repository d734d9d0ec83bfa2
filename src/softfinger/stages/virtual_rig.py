"""Rule `virtual_rig`: write a campaign, videos aside."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from softfinger.artifacts import save_artifact
from softfinger.artifacts.specs.truth import SPEC
from softfinger.mechanics.effects.model_file import read_model_file
from softfinger.provenance import derive_seed, describe_run
from softfinger.virtual_rig.campaign_folder import write_campaign_folder
from softfinger.virtual_rig.motion import draw_motion


def virtual_rig(
    *, truth: Path, folder: Path, config: Mapping[str, Any], seed: int, model: Path | None = None
) -> None:
    """Write a synthetic campaign, and its truth.

    The campaign goes to ``folder``, the truth beside it.

    Parameters
    ----------
    model
        A model file: further physics that the finger has.
    """
    stream = derive_seed(seed, "virtual_rig")
    physics = None if model is None else read_model_file(model)
    motion = draw_motion(dict(config), stream, physics)
    write_campaign_folder(motion, dict(config), Path(folder), stream)
    inputs = {} if model is None else {"model": model}
    save_artifact(motion, SPEC, truth, describe_run("virtual_rig", inputs, config, seed))
