"""The diagnosis: one call from angles to a verdict and the artifacts behind it."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
import xarray as xr

from softfinger.mismatch.calibrate import (
    FalseAlarms,
    calibrate_false_alarms,
    collect_columns,
    find_invisible,
)
from softfinger.mismatch.conclude import conclude, test_misfit
from softfinger.mismatch.decide import Posterior, weigh_models
from softfinger.mismatch.problem import Problem, pose_problem
from softfinger.mismatch.rank import Candidate, list_pieces
from softfinger.mismatch.search import Search, search_effects
from softfinger.mismatch.verdict import Verdict
from softfinger.progress import track_progress

Progress = Callable[[Iterable, str], Iterable]


class Diagnosis(NamedTuple):
    """A verdict and everything behind it."""

    verdict: Verdict
    problem: Problem
    search: Search
    posterior: Posterior
    false_alarms: FalseAlarms


def diagnose(
    angles: xr.Dataset, config: dict, seed: int, progress: Progress = track_progress
) -> Diagnosis:
    """Diagnose a campaign.

    Parameters
    ----------
    angles
        The `angles` artifact.
    config
        The `mismatch` block of the configuration.
    seed
        Of the bootstrap.
    progress
        Wraps the long loops: (items, description) → items.
    """
    problem, fit = pose_problem(angles)
    base = Candidate(problem.base, fit, fit.log_evidence)
    pieces, refused = list_pieces(problem.setting)
    columns = collect_columns(problem, base, pieces)
    alarms = calibrate_false_alarms(
        columns, problem, base, np.random.default_rng(seed), config["bootstrap_replicates"]
    )
    needed = alarms.threshold(config["false_alarm_probability"])
    search = search_effects(problem, base, needed, progress)
    posterior = weigh_models(base, search.candidates)
    findings = test_misfit(problem, search)
    invisible = find_invisible(columns, problem, base, needed)
    hidden = sorted({*refused, *invisible} - search.best.model.ids)
    verdict = conclude(problem, search, posterior, findings, angles, hidden)
    return Diagnosis(verdict, problem, search, posterior, alarms)
