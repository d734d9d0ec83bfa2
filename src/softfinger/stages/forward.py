"""The forward model that propagation uses in place of the base: that of a model file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from softfinger.faults import Fault
from softfinger.mechanics.effects.model_file import read_model_file
from softfinger.mismatch.forward import Move, build_mover
from softfinger.propagation.hyperparameters import take_draws


def open_mover(
    angles: xr.Dataset, posterior: xr.DataTree, config: Mapping[str, Any], model: Path | None
) -> Move | None:
    """Open the forward model of a model file; None for the base model.

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
    fitted = "effect" in posterior["posterior"].dataset
    if model is None:
        if fitted:
            raise Fault(
                "the posterior holds effects, and no model file was given: give the one that it "
                "was fitted with (--model, or `model` in the configuration)"
            )
        return None
    if not fitted:
        raise Fault(f"{model}: the posterior was fitted without it; fit again with this model file")
    effect = take_draws(posterior, ["effect"], config["draws"])["effect"]
    return build_mover(angles, read_model_file(model), effect)
