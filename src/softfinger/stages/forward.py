"""The forward model that propagation moves new trials with."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from softfinger.faults import Fault
from softfinger.inference.motion import Move, build_mover, move_paper_joint
from softfinger.mechanics.effects.model_file import read_model_file
from softfinger.propagation.populations import take_population_draws


def open_mover(
    angles: xr.Dataset, posterior: xr.DataTree, config: Mapping[str, Any], model: Path | None
) -> Move:
    """Open the forward model of a model file.

    None gives that of the paper's joint.

    Parameters
    ----------
    posterior
        The fit of that model.
    config
        The `propagation` block.

    Raises
    ------
    Fault
        Posterior and model do not belong together.
    """
    fitted = posterior["posterior"].sizes.get("effect_parameter", 0) > 0
    if model is None:
        if fitted:
            raise Fault(
                "the posterior has effects, and no model file was given: give the one that it "
                "was fitted with (--model, or `model` in the configuration)"
            )
        return move_paper_joint
    if not fitted:
        raise Fault(f"{model}: the posterior was fitted without it; fit again with this model file")
    effect = take_population_draws(posterior, ["effect"], config["draws"])["effect"]
    constant = posterior.get("constant_data", xr.DataTree()).to_dataset()
    return build_mover(constant, read_model_file(model), effect, angles["trial"])
