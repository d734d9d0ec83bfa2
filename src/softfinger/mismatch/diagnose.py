"""The diagnosis: one call from angles to verdict."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from softfinger.artifacts.verdict import Verdict
from softfinger.inference.disturbances import find_kind
from softfinger.inference.problem import Candidate, Problem, pose_problem
from softfinger.inference.tails import list_freedom
from softfinger.measurement.measure import add_components
from softfinger.measurement.mend import mend_recordings
from softfinger.mechanics.effects.measurement_file import MeasurementEntry
from softfinger.mechanics.effects.model_file import ModelFile
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.columns import collect_columns
from softfinger.mismatch.candidates.rank import Progress, list_pieces, rank_pieces
from softfinger.mismatch.checks.findings import Findings, examine
from softfinger.mismatch.checks.hums import hear_hums, note_hums
from softfinger.mismatch.config import MismatchSettings
from softfinger.mismatch.experiment.masking import list_invisible, tabulate_masking
from softfinger.mismatch.posed import (
    Posed,
    Survey,
    add_hums,
    mend_clock,
    mend_hums,
    mend_offsets,
    pose_load,
)
from softfinger.mismatch.search.beyond import go_beyond
from softfinger.mismatch.search.calibrate import FalseAlarms, calibrate_false_alarms
from softfinger.mismatch.search.demand import list_free
from softfinger.mismatch.search.eliminate import fit_less
from softfinger.mismatch.search.finalists import list_best, list_leaders
from softfinger.mismatch.search.judge import (
    compare_levels,
    judge_finalists,
    needs_disturbance,
    settle_measurement,
)
from softfinger.mismatch.search.one_load import share_with_creep
from softfinger.mismatch.search.patience import Patience
from softfinger.mismatch.search.settle import (
    Posterior,
    drop_lent,
    drop_negligible,
    settle_search,
    weigh_models,
)
from softfinger.mismatch.search.species import name_species
from softfinger.mismatch.search.stepwise import (
    Search,
    hold_against_shape,
    shape_rest,
)
from softfinger.mismatch.verdict.conclude import choose_decision, conclude
from softfinger.progress import track_progress
from softfinger.settings import read_settings


class Diagnosis(NamedTuple):
    """A verdict and everything behind it.

    `angles` are the recordings set right by `mended`; all else is of these.
    """

    verdict: Verdict
    problem: Problem
    search: Search
    posterior: Posterior
    false_alarms: FalseAlarms
    masking: xr.Dataset
    findings: Findings
    cut_short: bool
    angles: xr.Dataset
    mended: MeasurementEntry


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
    progress
        Wraps the long loops: (items, description) → items.
    content
        A model file whose model takes the place of the base.
    priors
        Whether the file's priors count; they do not where they come from these recordings.
    """
    settings = read_settings(MismatchSettings, config, "mismatch")

    alarms: dict[bytes, FalseAlarms] = {}  # of one load, chance gains alike however it is mended

    def survey(problem: Problem, base: Candidate) -> Survey:
        pieces, refused = list_pieces(problem.setting)
        pieces = [piece for piece in pieces if piece.effect.id not in base.model.ids]
        load = problem.trials.load_torque.tobytes()
        freedom = () if load in alarms else list_freedom(problem)
        columns = collect_columns(problem, base, progress(pieces, "trying effects"), freedom)
        if load not in alarms:
            rng, draws = np.random.default_rng(seed), settings.bootstrap_replicates
            alarms[load] = calibrate_false_alarms(columns, problem, base, rng, draws)
        needed = alarms[load].threshold(settings.false_alarm_probability)
        ranked = rank_pieces(problem, base, columns, progress)
        return Survey((pieces, refused), columns, alarms[load], needed, ranked)

    def pose(mended: MeasurementEntry, known: Mapping[str, tuple[float, float]]) -> Posed:
        right = mend_recordings(angles, mended)
        plain, fit = pose_problem(right, content, priors=priors)
        if known:
            size, nats = ({name: pair[k] for name, pair in known.items()} for k in (0, 1))
            plain = replace(plain, noise=add_components(plain.noise, size, nats))
        base = Candidate(plain.base, fit, fit.log_evidence)
        return Posed(right, plain, base, survey(plain, base), known, mended)

    posed = mend_offsets(mend_clock(pose_load(angles, pose), pose), pose)
    posed, hums = mend_hums(posed, pose)
    patience = Patience(settings.longest_search_s, progress)
    problem, found, search = search_jointly(posed, survey, patience)
    right, mended = posed.angles, posed.mended
    more = hear_hums(problem, search.best, right)
    mended = add_hums(mended, more, problem.trials.name)
    problem = replace(problem, noise=note_hums(problem.noise, hums + more))
    right = mend_recordings(angles, mended) if more else right
    return _close(problem, search, found, right, mended, patience)


def search_jointly(
    posed: Posed, survey: Callable[[Problem, Candidate], Survey], patience: Patience
) -> tuple[Problem, Survey, Search]:
    """Search with the measurement that leads, and without any disturbance.

    A disturbance that one effect needs may be what a second effect does. So where what the search
    finds with it needs one, what it finds without is judged beside it. Only what comes near that is
    sought.
    """
    right, plain, base, found, _, _ = posed
    leaders = list_leaders(base, found.ranked[0], found.needed)
    problem, start = settle_measurement(plain, base, leaders)
    rivals: list[Candidate] = []
    if problem is plain:
        search = found.search(plain, base, patience)
    else:
        bare, found = found, survey(problem, start).join_leaders(problem, start, leaders)
        search = found.search(problem, start, patience)
        if needs_disturbance(plain, search.best):
            known = compare_levels(problem, plain) + search.best.log_evidence - base.log_evidence
            worth = max(known - BUDGET.reach_nats, 0.0)
            rivals = list_best(bare.search(plain, base, patience, worth))
    if search.best is not search.base or rivals:
        asked = found.demand, found.catalogue[0], patience
        problem, search = judge_finalists(plain, problem, search, rivals, right, *asked)
    return problem, found, search


def _close(
    problem: Problem,
    search: Search,
    found: Survey,
    angles: xr.Dataset,
    mended: MeasurementEntry,
    patience: Patience,
) -> Diagnosis:
    """Examine what is left, weigh all sets, and conclude."""
    needed, free, cut_short = found.needed, list_free(found.catalogue[0]), patience.was_lost
    if search.best is not search.base:
        search = share_with_creep(problem, name_species(problem, search))
    search = shape_rest(problem, settle_search(drop_lent(search), free))
    findings = examine(problem, search, angles, needed=needed)
    kept = drop_negligible(search, partial(fit_less, problem))
    if kept.best is not search.best and kept.best is not kept.base:
        kept = share_with_creep(problem, name_species(problem, kept))
    search = hold_against_shape(problem, kept)
    if search.best is not kept.best:
        findings = examine(problem, search, angles, needed=needed)
    posterior = weigh_models(search.base, search.candidates, free)
    decision = choose_decision(search, posterior, findings.is_unlisted(needed))
    if decision == "unlisted" and not findings.turned:
        task = found.build_task(problem, search.base, patience)
        search = go_beyond(task, search, found.demand)
    masking = tabulate_masking(found.columns, problem, search.base)
    hidden, refused = set(list_invisible(masking, needed)), found.catalogue[1]
    verdict = conclude(problem, search, posterior, findings, angles, hidden, refused, needed)
    sizes = {name: sd for name, sd in problem.disturbed.items() if find_kind(name)}
    mended = mended.model_copy(update={"disturbances": sizes})
    rest = found.alarms, masking, findings, cut_short, angles, mended
    return Diagnosis(verdict, problem, search, posterior, *rest)
