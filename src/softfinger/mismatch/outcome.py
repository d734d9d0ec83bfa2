"""Everything behind a verdict, as the artifacts of a diagnosis, and its repaired model."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from softfinger.mechanics.effects.model_file import FittedTo, ModelFile, describe_model
from softfinger.mismatch.diagnose import Diagnosis
from softfinger.mismatch.evidence import tabulate_location, tabulate_ranking
from softfinger.mismatch.repair import measure_repair


def tabulate_diagnosis(
    diagnosis: Diagnosis, angles: xr.Dataset, config: Mapping[str, Any], seed: int
) -> dict[str, xr.Dataset]:
    """Tabulate a diagnosis: artifact name → Dataset.

    Parameters
    ----------
    angles
        The `angles` artifact that was diagnosed.
    config
        The `mismatch` block of the configuration.
    seed
        Of the predictions.
    """
    problem, search = diagnosis.problem, diagnosis.search
    models = search.base, search.best
    needed = diagnosis.false_alarms.threshold(config["false_alarm_probability"])
    tables = {
        "ranking": tabulate_ranking(search, diagnosis.posterior, diagnosis.false_alarms, needed),
        "location": tabulate_location(problem, *models, diagnosis.findings.line),
        "masking": diagnosis.masking,
        "repair": measure_repair(problem, *models, angles, np.random.default_rng(seed)),
        "free_form": tabulate_free_form(diagnosis),
    }
    verdict = diagnosis.verdict
    said: dict[str, Any] = {
        "campaign": str(angles.attrs["campaign"]),
        "source": str(angles.attrs["source"]),
        "decision": verdict.decision,
        "effects": "+".join(effect.id for effect in verdict.effects),
    }
    return {name: table.assign_attrs(said) for name, table in tables.items()}


def tabulate_free_form(diagnosis: Diagnosis) -> xr.Dataset:
    """Tabulate the shape of what no effect explains; without any quantity where none is needed."""
    free = diagnosis.findings.free
    if free is not None and diagnosis.verdict.free_form is not None:
        return free.shape.assign_attrs(argument=free.argument, gain_nats=free.gain)
    empty = np.zeros((0, 0))
    return xr.Dataset(
        {"value": (("quantity", "place"), empty), "sd": (("quantity", "place"), empty)},
        coords={"quantity": np.array([], dtype=str), "place": np.zeros(0)},
        attrs={"argument": "", "gain_nats": 0.0},
    )


def describe_repair(diagnosis: Diagnosis, fitted_to: FittedTo) -> ModelFile:
    """Describe the repaired model, as a model file."""
    best = diagnosis.search.best
    sd = np.sqrt(np.diag(best.fit.shared_covariance))
    return describe_model(best.model, best.fit.shared, sd, fitted_to)
