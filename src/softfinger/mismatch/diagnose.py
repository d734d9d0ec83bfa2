"""The diagnosis: one call from angles to verdict.

It also returns the artifacts behind the verdict.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from softfinger.inference.problem import Candidate, Problem, pose_problem
from softfinger.measurement.measure import add_components
from softfinger.measurement.steady import steady_log
from softfinger.mechanics.effects.model_file import ModelFile
from softfinger.mismatch.candidates.columns import ScoreColumns, collect_columns
from softfinger.mismatch.candidates.rank import Score, list_pieces, rank_pieces
from softfinger.mismatch.checks.findings import Findings, examine
from softfinger.mismatch.config import MismatchSettings
from softfinger.mismatch.experiment.masking import list_invisible, tabulate_masking
from softfinger.mismatch.search.calibrate import FalseAlarms, calibrate_false_alarms
from softfinger.mismatch.search.judge import judge_finalists, settle_measurement, weigh_log
from softfinger.mismatch.search.settle import (
    Posterior,
    drop_negligible,
    settle_search,
    weigh_models,
)
from softfinger.mismatch.search.stepwise import (
    Search,
    hold_against_shape,
    search_effects,
    shape_rest,
)
from softfinger.mismatch.verdict.conclude import conclude
from softfinger.mismatch.verdict.schema import Verdict
from softfinger.progress import track_progress
from softfinger.settings import read_settings

Progress = Callable[[Iterable, str], Iterable]


class Diagnosis(NamedTuple):
    """A verdict and everything behind it."""

    verdict: Verdict
    problem: Problem
    search: Search
    posterior: Posterior
    false_alarms: FalseAlarms
    masking: xr.Dataset
    findings: Findings


class Survey(NamedTuple):
    """Every effect alone.

    Its columns, what chance gains, what is needed, and the ranking.
    """

    columns: ScoreColumns
    alarms: FalseAlarms
    needed: float
    ranked: tuple[list[Candidate], list[Score]]


def diagnose(
    angles: xr.Dataset,
    config: Mapping[str, Any],
    seed: int,
    progress: Progress = track_progress,
    content: ModelFile | None = None,
    *,
    priors: bool = True,
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
    content
        A model file whose model takes the place of the base.
    priors
        Whether the file's priors count; they do not where they come from these recordings.
    """
    settings = read_settings(MismatchSettings, config, "mismatch")
    plain, fit = pose_problem(angles, content, priors=priors)
    base = Candidate(plain.base, fit, fit.log_evidence)
    pieces, refused = list_pieces(plain.setting)
    pieces = [piece for piece in pieces if piece.effect.id not in base.model.ids]

    def survey(problem: Problem, base: Candidate) -> Survey:
        columns = collect_columns(problem, base, progress(pieces, "trying effects"))
        rng = np.random.default_rng(seed)
        alarms = calibrate_false_alarms(columns, problem, base, rng, settings.bootstrap_replicates)
        needed = alarms.threshold(settings.false_alarm_probability)
        return Survey(columns, alarms, needed, rank_pieces(problem, base, columns, progress))

    columns, alarms, needed, ranked = survey(plain, base)
    steady, error = steady_log(angles)
    known = plain.setting.load_known and error > 0.0
    nats = weigh_log(plain, base, ranked[0], steady, needed) if known else 0.0
    if nats > 0.0:  # that the log scatters is seen in the log
        angles = steady
        plain, fit = pose_problem(angles, content, priors=priors)
        found = {"noisy_load": error}, {"noisy_load": nats}
        plain = replace(plain, noise=add_components(plain.noise, *found))
        base = Candidate(plain.base, fit, fit.log_evidence)
        columns, alarms, needed, ranked = survey(plain, base)
    problem, base = settle_measurement(plain, base, ranked[0], needed)
    if problem is not plain:
        columns, alarms, needed, ranked = survey(problem, base)
    search = search_effects(problem, base, (pieces, refused), columns, needed, progress, ranked)
    if search.best is not search.base:
        problem, search = judge_finalists(plain, problem, search, angles, needed)
    search = shape_rest(problem, settle_search(search))
    findings = examine(problem, search, angles, needed=needed)
    found = drop_negligible(search)
    search = hold_against_shape(problem, found)
    if search.best is not found.best:
        findings = examine(problem, search, angles, needed=needed)
    posterior = weigh_models(search.base, search.candidates)
    masking = tabulate_masking(columns, problem, base)
    hidden = {*refused, *list_invisible(masking, needed)}
    verdict = conclude(problem, search, posterior, findings, angles, hidden, needed)
    return Diagnosis(verdict, problem, search, posterior, alarms, masking, findings)
