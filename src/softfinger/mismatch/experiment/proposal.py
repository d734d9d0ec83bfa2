"""What to record next, for what is open."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from softfinger.faults import Fault
from softfinger.inference.problem import Problem
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.rank import list_pieces
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.diagnose import Diagnosis
from softfinger.mismatch.experiment.account import describe_plan, state_obstacles
from softfinger.mismatch.experiment.limits import RigLimits
from softfinger.mismatch.experiment.plan import plan_next
from softfinger.mismatch.experiment.purposes import Question, ask_whether, ask_which
from softfinger.mismatch.experiment.survivors import Survivor, list_survivors, suppose_effects
from softfinger.mismatch.priors import PRIORS


def propose_experiment(
    found: Diagnosis, angles: xr.Dataset, seed: int = 0
) -> dict[str, Any] | None:
    """Propose the recordings for a verdict's open questions.

    That is what its equivalent sets differ in, else what these recordings could not show. It keeps
    within the largest load and angle, the frame rate and the trials' length that were recorded.

    Parameters
    ----------
    angles
        The `angles` artifact that it is of.

    Returns
    -------
    dict
        As of `describe_plan`; without loads where only another limit would help. None where nothing
        is open, or nothing would help.
    """
    wanted = list_open_questions(found)
    if not wanted:
        return None
    survivors = list_survivors(found.problem, found.posterior)
    question = pose_open_question(found.problem, survivors, found.verdict.decision, wanted)
    if question is None:
        return None
    limits = recall_limits(found.problem, angles, DECISIONS.design_trials)
    rng = np.random.default_rng(seed)
    column = choose_column(angles.sel(trial=found.problem.trials.name))
    # what is open is worth the full search; what is only hidden is not
    for short in (True,) if question.supposes else (True, False):
        try:
            plan = plan_next(found.problem, question, limits, rng, short=short)
        except Fault:
            return None
        said = describe_plan(plan, *column)
        if said["tells_apart"]:
            return said
    in_the_way = {label: limit for label, limit in plan.hidden.items() if limit}
    statement = state_obstacles(plan._replace(hidden=in_the_way))
    return said | {"loads": [], "statement": statement} if in_the_way else None


def pose_open_question(
    problem: Problem, survivors: Sequence[Survivor], decision: str, hidden: Sequence[str]
) -> Question | None:
    """Ask which survivor is right, or what is hidden.

    Which one, where the decision is `ambiguous`. None where nothing of what is hidden can be
    supposed beside the most probable one.
    """
    if decision == "ambiguous" and len(survivors) > 1:
        return ask_which(survivors)
    only = survivors[0]
    known = only.candidate.model.ids
    pieces, _ = list_pieces(problem.setting)
    there = [piece for piece in pieces if piece.effect.id in set(hidden) - known]
    if not there:
        return None
    return ask_whether(suppose_effects(problem, only, there, hidden))


def recall_limits(problem: Problem, angles: xr.Dataset, trials: int) -> RigLimits:
    """Limits within which recordings were made.

    Where the rest between trials is not known, it is a minute.
    """
    chosen = angles.sel(trial=problem.trials.name)
    known = problem.setting.rest_time[np.isfinite(problem.setting.rest_time)]
    rest = float(np.median(known)) if known.size else PRIORS.rest_s
    return RigLimits(
        load=float(np.abs(chosen["load_torque"].values).max()),
        angle=float(np.nanmax(np.abs(chosen["joint_angle"].values))),
        rate=np.inf,
        minutes=trials * (problem.setting.duration + rest) / 60.0,
        trials=trials,
        rest=rest,
        interval=problem.trials.interval,
        knots=BUDGET.knots,
        recalled=True,
    )


def list_open_questions(found: Diagnosis) -> list[str]:
    """Ids of effects that a verdict leaves open."""
    sets = [set(ids) for ids in found.posterior.equivalent]
    if found.verdict.decision == "ambiguous" and len(sets) > 1:
        return sorted(set.union(*sets) - set.intersection(*sets))
    return list(found.verdict.not_testable)


def choose_column(angles: xr.Dataset) -> tuple[str, float]:
    """Log column of this rig, and its factor."""
    kinds = angles["load_kind"].values.astype(str)
    if (kinds == "tension_n").all():
        return "tension_n", 1.0 / float(angles["wire_offset"])
    return ("torque_nm" if (kinds == "torque_nm").all() else "command"), 1.0
