"""Rule `diagnose`: which physics was left out."""

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from softfinger.artifacts import open_artifact, save_artifact, write_atomically
from softfinger.artifacts.declared_units import state_sizes
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.specs import free_form as free_form_spec
from softfinger.artifacts.specs import laws as laws_spec
from softfinger.artifacts.specs import location as location_spec
from softfinger.artifacts.specs import masking as masking_spec
from softfinger.artifacts.specs import measurement as measurement_spec
from softfinger.artifacts.specs import ranking as ranking_spec
from softfinger.artifacts.specs import repair as repair_spec
from softfinger.artifacts.verdict import Warned, write_verdict
from softfinger.doubts import find_doubts
from softfinger.mechanics.effects.model_file import (
    FittedTo,
    read_model_file,
    write_model_file,
)
from softfinger.mismatch.diagnose import Diagnosis
from softfinger.mismatch.diagnose import diagnose as find_left_out
from softfinger.mismatch.experiment.proposal import propose_experiment
from softfinger.mismatch.experiment.survivors import (
    OpenModels,
    describe_survivors,
    list_survivors,
    write_survivors,
)
from softfinger.mismatch.tables.outcome import describe_repair, tabulate_diagnosis
from softfinger.mismatch.verdict.assumed import list_assumed, list_unused
from softfinger.mismatch.verdict.sufferings import doubt_declared, doubt_patience
from softfinger.provenance import derive_seed, describe_run
from softfinger.stages.linear_algebra import on_one_thread
from softfinger.units import read_units

SPECS = {
    spec.SPEC.name: spec.SPEC
    for spec in (
        ranking_spec,
        location_spec,
        masking_spec,
        repair_spec,
        free_form_spec,
        laws_spec,
        measurement_spec,
    )
}


@on_one_thread
def diagnose(
    *,
    angles: Path,
    verdict: Path,
    repaired: Path,
    survivors: Path,
    next_experiment: Path,
    config: Mapping[str, Any],
    r_hat_max: float,
    seed: int,
    model: Path | None = None,
    **artifacts: Path,
) -> None:
    """Write a campaign's verdict and repaired model.

    Parameters
    ----------
    verdict, repaired, survivors
        The verdict (JSON), the model file and the models that are left (YAML) that are written.
    next_experiment
        Folder for the load logs of the experiment that is proposed; empty where none is.
    r_hat_max
        The configuration's, beyond which a sampled size is not taken.
    model
        A model file whose model is diagnosed in place of the base.
    **artifacts
        Name → file, for every name in ``SPECS``.
    """
    Path(verdict).unlink(missing_ok=True)  # an older one would be of other artifacts
    roles = {"angles": angles} if model is None else {"angles": angles, "model": model}
    provenance = describe_run("diagnose", roles, {**config, "r_hat_max": r_hat_max}, seed)
    recorded = open_artifact(angles, angles_spec.SPEC)
    stream = derive_seed(seed, "diagnose")
    content = None if model is None else read_model_file(model)
    fitted_to = FittedTo(
        campaign=str(recorded.attrs["campaign"]), sha256=provenance.inputs["angles"]
    )
    priors = content is None or not content.was_fitted_to(fitted_to.sha256)
    if content and (said := content.describe_origin(fitted_to.sha256)):
        print(said)
    found = find_left_out(recorded, config, stream, content=content, priors=priors)
    tables = tabulate_diagnosis(found, found.angles, config, stream)
    for name, path in artifacts.items():
        save_artifact(tables[name], SPECS[name], path, provenance)
    with write_atomically(repaired) as temporary:
        write_model_file(describe_repair(found, fitted_to), temporary)
    write_survivors(list_open_models(found, fitted_to), Path(survivors))
    said = found.verdict
    if config["sample_repaired"]:
        # the sampler takes seconds to import
        from softfinger.mismatch.verdict.refine import refine_verdict

        rng = np.random.default_rng(stream)
        said, r_hat = refine_verdict(found, found.angles, rng, r_hat_max)
        print(f"sampling the repaired model: largest R-hat {r_hat:.3f}")
    proposal = propose_experiment(found, recorded, stream)
    warnings = list_warnings(found, recorded)
    warnings += doubt_patience(found.cut_short, config["longest_search_s"])
    said = state_sizes(said, read_units(recorded.attrs))
    said = said.model_copy(update={"next_experiment": proposal, "warnings": warnings})
    write_load_files(proposal, Path(next_experiment))  # Snakemake gives a str
    with write_atomically(verdict) as temporary:
        write_verdict(said, temporary)


def list_open_models(found: Diagnosis, fitted_to: FittedTo) -> OpenModels:
    """List the models that a diagnosis leaves open."""
    return describe_survivors(
        list_survivors(found.problem, found.posterior),
        fitted_to,
        found.verdict.decision,
        found.verdict.not_testable,
        found.mended.shorten(),
    )


def list_warnings(found: Diagnosis, recorded: xr.Dataset) -> list[Warned]:
    """List what looks wrong in recordings, or is assumed of them."""
    problem = found.problem
    return [
        *(
            Warned(id=doubt.id, trials=list(doubt.trials), statement=doubt.statement)
            for doubt in find_doubts(recorded)
        ),
        *doubt_declared(problem.noise),
        *list_unused(recorded, problem.trials.name),
        *list_assumed(problem.noise, load_known=problem.setting.load_known),
    ]


def write_load_files(proposal: Mapping[str, Any] | None, folder: Path) -> None:
    """Write a proposal's histories as load logs."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    if proposal is None:
        return
    for number, load in enumerate(proposal["loads"], start=1):
        pairs = zip(load["time_s"], load["load"], strict=True)
        rows = [f"{time:.6g},{value:.6g}" for time, value in pairs]
        with write_atomically(folder / f"load_{number}.csv") as temporary:
            head = f"time_s,{proposal['load_column']}"
            temporary.write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
