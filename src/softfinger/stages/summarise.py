"""Rule `summarise`: what figures and report show."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from softfinger.artifacts import save_tree
from softfinger.faults import Fault
from softfinger.inference.motion import Move, build_mover, move_paper_joint
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.model_file import read_model_file
from softfinger.provenance import derive_seed, describe_run
from softfinger.stages.linear_algebra import on_one_thread
from softfinger.stages.modelled import read_modelled
from softfinger.stages.opening import SUMMED, open_artifacts
from softfinger.summary import judge_run
from softfinger.summary import summarise as sum_up
from softfinger.summary.config import read_config


@on_one_thread
def summarise(
    *,
    checks: Path,
    summary: Path,
    markers: Sequence[Path],
    config: Mapping[str, Any],
    seed: int,
    model: Path | None = None,
    **artifacts: Path,
) -> None:
    """Write the checks of a run, and its summary.

    Parameters
    ----------
    markers
        Marker files, if the campaign was filmed; the first one is shown.
    model
        The model file that the posterior was fitted with, in place of the base model.
    **artifacts
        Name → file; `angles` is needed, of the others those that are there.
    """
    roles = {**artifacts, "markers": markers} | ({} if model is None else {"model": model})
    provenance = describe_run("summarise", roles, config, seed)
    opened, limits = open_artifacts(artifacts, markers), read_config(config)
    known = read_modelled(opened["angles"], provenance.inputs["angles"], model)
    opened["angles"] = known.angles
    angles, posterior = opened["angles"], opened.get("posterior")
    rng = np.random.default_rng(derive_seed(seed, "summarise"))
    moves = _open_moves(angles, posterior, model)
    sentences = {name: effect.sentence for name, effect in list_effects().items()}
    made = {
        "checks": (checks, judge_run(opened, limits, rng, *moves)),
        "summary": (summary, sum_up(opened, limits, sentences)),
    }
    for name, (path, tree) in made.items():
        tree.attrs |= {key: angles.attrs[key] for key in ("campaign", "source")}
        tree.attrs["ci_prob"] = limits.ci_prob
        tree.attrs["note"] = "" if posterior is None else posterior.attrs["note"]
        save_tree(tree, SUMMED[name], path, provenance)


def _open_moves(
    angles: xr.Dataset, posterior: xr.DataTree | None, model: Path | None
) -> tuple[Move, Move]:
    """Open the model at middle and drawn effects."""
    if posterior is None or not posterior["posterior"].sizes.get("effect_parameter", 0):
        return move_paper_joint, move_paper_joint
    if model is None:
        raise Fault("the fit has effects: name the model file that it was made with (--model)")
    content, constant = read_model_file(model), posterior["constant_data"].to_dataset()
    middle = posterior["posterior"]["effect"].median(("chain", "draw")).expand_dims("draw")
    fitted = build_mover(constant, content, middle, angles["trial"])
    if "prior" not in posterior.children:
        return fitted, fitted
    drawn = posterior["prior"]["effect"].stack(sample=("chain", "draw"))
    drawn = drawn.reset_index("sample", drop=True).rename(sample="draw")
    return fitted, build_mover(constant, content, drawn, angles["trial"])
