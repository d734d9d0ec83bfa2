"""What the rules of the propagation compute from."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from softfinger.artifacts import open_artifact, open_tree
from softfinger.artifacts.specs import angles, least_squares, posterior
from softfinger.faults import Fault
from softfinger.inference.motion import Move, build_mover, move_paper_joint
from softfinger.mechanics.effects.model_file import read_model_file
from softfinger.propagation.populations import take_population_draws
from softfinger.provenance import Provenance, derive_seed, describe_run
from softfinger.stages.modelled import read_modelled

SPECS = {part.SPEC.name: part.SPEC for part in (angles, least_squares, posterior)}


def open_spread(
    rule: str, inputs: Mapping[str, Path], config: Mapping[str, Any], seed: int, model: Path | None
) -> tuple[tuple, Provenance]:
    """Open what a rule's library call takes.

    Parameters
    ----------
    model
        The model file that the posterior was fitted with, in place of the base model.

    Returns
    -------
    arguments, provenance
        The artifacts, the block, random numbers and the forward model; what results are stamped
        with.
    """
    provenance = describe_run(
        rule, {**inputs, **({} if model is None else {"model": model})}, config, seed
    )
    opened = {
        name: (open_tree if SPECS[name].groups else open_artifact)(path, SPECS[name])
        for name, path in inputs.items()
    }
    known = read_modelled(opened["angles"], provenance.inputs["angles"], model)
    opened["angles"] = known.angles
    rng = np.random.default_rng(derive_seed(seed, rule))
    other = np.random.default_rng(derive_seed(seed, "effects of new trials"))
    move = open_mover(opened["angles"], opened["posterior"], config, model, other)
    return (*opened.values(), config, rng, move), provenance


def open_mover(
    angles: xr.Dataset,
    posterior: xr.DataTree,
    config: Mapping[str, Any],
    model: Path | None,
    rng: np.random.Generator,
) -> Move:
    """Open the forward model of a model file.

    None gives that of the paper's joint. Where a file states that an effect's parameter differs
    between trials, each draw has its own.

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
    content = read_model_file(model)
    if not fitted and not content.effects:
        return move_paper_joint
    if not fitted:
        raise Fault(f"{model}: the posterior was fitted without it; fit again with this model file")
    effect = take_population_draws(posterior, ["effect"], config["draws"])["effect"]
    constant = posterior.get("constant_data", xr.DataTree()).to_dataset()
    return build_mover(constant, content, effect, angles["trial"], rng)
