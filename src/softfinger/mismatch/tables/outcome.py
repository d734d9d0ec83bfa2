"""Artifacts of a diagnosis, and its repaired model."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.mechanics.effects.law_curve import compute_law_curves
from softfinger.mechanics.effects.model_file import FittedTo, ModelFile, describe_model
from softfinger.mismatch.checks.free_form import FreeForm
from softfinger.mismatch.checks.summary import compare_elpd, compute_square_excess
from softfinger.mismatch.diagnose import Diagnosis
from softfinger.mismatch.tables.evidence import tabulate_location, tabulate_ranking
from softfinger.mismatch.tables.repair import measure_repair

MEASURED = (
    "present",
    "used",
    "repeated",
    "saturated",
    "outlier_distance",
    "frame_scale",
    "trial_factor",
    "noise_sd",
    "noise_autocorrelation",
    "noise_white",
    "noise_correlation",
    "noise_per_rad",
    "noise_per_rate",
    "window_count",
    "component_size",
    "component_evidence",
    "hum_frequency",
)
"""What the artifact `measurement` keeps."""


def tabulate_diagnosis(
    diagnosis: Diagnosis, angles: xr.Dataset, config: Mapping[str, Any], seed: int
) -> dict[str, xr.Dataset]:
    """Tabulate a diagnosis: artifact name → Dataset."""
    problem, search = diagnosis.problem, diagnosis.search
    models = search.base, search.best
    needed = diagnosis.false_alarms.threshold(config["false_alarm_probability"])
    mended = diagnosis.mended.model_dump(
        include={
            "clock_rate",
            "steady_load",
            "ramps_held",
            "load_tared",
            "steps_early",
            "steps_open",
        }
    )
    offset = diagnosis.mended.clock_offsets_s
    later = [offset.get(name, 0.0) for name in problem.noise["trial"].values.tolist()]
    tables = {
        "ranking": tabulate_ranking(search, diagnosis.posterior, diagnosis.false_alarms, needed),
        "location": tabulate_location(problem, *models, diagnosis.findings.line),
        "masking": diagnosis.masking,
        "repair": measure_repair(problem, *models, angles, np.random.default_rng(seed)),
        "free_form": tabulate_free_form(diagnosis),
        "measurement": problem.noise[list(MEASURED)]
        .assign(mended | {"clock_offset": ("trial", later), "step_share": _list_shares(diagnosis)})
        .reset_coords(drop=True),
        "laws": compute_law_curves(
            search.best.model, search.best.fit.shared, search.best.fit.shared_covariance
        ),
    }
    verdict = diagnosis.verdict
    said: dict[str, Any] = {
        "campaign": str(angles.attrs["campaign"]),
        "source": str(angles.attrs["source"]),
        "decision": verdict.decision,
        "effects": "+".join(effect.id for effect in verdict.effects),
    }
    return {name: table.assign_attrs(said) for name, table in tables.items()}


def _list_shares(diagnosis: Diagnosis) -> tuple[tuple[str, str], NDArray[np.float64]]:
    """Shares of their gaps by which placed steps come sooner.

    NaN where a trial has fewer.
    """
    known = diagnosis.mended.step_shares
    shares = np.full(
        (len(diagnosis.problem.trials.name), max(map(len, known.values()), default=0)), np.nan
    )
    for row, name in zip(shares, diagnosis.problem.trials.name, strict=True):
        some = known.get(name, [])
        row[: len(some)] = some
    return ("trial", "step"), shares


def tabulate_free_form(diagnosis: Diagnosis) -> xr.Dataset:
    """Tabulate the free shape, or no quantity."""
    free, nan = diagnosis.findings.free, float("nan")
    if free is not None and diagnosis.verdict.free_form is not None:
        shape = free.shape.assign_attrs(argument=free.argument, gain_nats=free.gain)
        return shape.assign(measure_free_form(diagnosis, free))
    empty = np.zeros((0, 0))
    return xr.Dataset(
        {"value": (("quantity", "place"), empty), "sd": (("quantity", "place"), empty)}
        | dict.fromkeys(("elpd_difference", "elpd_se", "excess", "excess_without"), ((), nan)),
        coords={"quantity": np.array([], dtype=str), "place": np.zeros(0)},
        attrs={"argument": "", "gain_nats": 0.0},
    )


def measure_free_form(diagnosis: Diagnosis, free: FreeForm) -> dict[str, float]:
    """Measure what a free-form term does.

    Returns
    -------
    dict
        elpd_difference, elpd_se [nats], NaN for a single trial; excess, excess_without: of the
        variance within trials, over the noise's.
    """
    problem, best = diagnosis.problem, diagnosis.search.best
    without = best.fit, problem.build_prior(best.model)
    elpd = compare_elpd(problem, without, (free.fit, free.prior))
    rows = problem.trials.size[problem.trials.protocol]
    return {
        "elpd_difference": float("nan") if elpd is None else elpd.difference,
        "elpd_se": float("nan") if elpd is None else elpd.se,
        "excess": compute_square_excess(free.fit, rows),
        "excess_without": compute_square_excess(best.fit, rows),
    }


def describe_repair(diagnosis: Diagnosis, fitted_to: FittedTo) -> ModelFile:
    """Describe the repaired model, as a model file."""
    best = diagnosis.search.best
    found = best.fit.shared, best.fit.shared_covariance
    content = describe_model(best.model, *found, fitted_to, diagnosis.problem.disturbed)
    return content.model_copy(update={"measurement": diagnosis.mended.shorten()})
