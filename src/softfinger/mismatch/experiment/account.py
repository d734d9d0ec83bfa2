"""A plan in words and numbers, and what its figure shows."""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.problem import Problem
from softfinger.mechanics import OWN
from softfinger.mismatch.experiment.outlook import PlannedTrials, linearise_motion, plan_trials
from softfinger.mismatch.experiment.plan import (
    PAIR,
    REPEATED,
    NextExperiment,
    list_open,
)
from softfinger.mismatch.experiment.purposes import Question
from softfinger.mismatch.experiment.survivors import Survivor
from softfinger.mismatch.priors import PRIORS
from softfinger.mismatch.tables.repair import compute_bin_noise

LIMIT_WORDS = {
    "trials": f"{PRIORS.limit_relaxed} times as many trials",
    "minutes": f"trials {PRIORS.limit_relaxed} times as long",
    "rate": "a load that jumps",
    "interval": f"a camera {PRIORS.camera_relaxed} times as fast",
    "load": f"a load {PRIORS.limit_relaxed} times as large",
    "angle": f"an angle {PRIORS.limit_relaxed} times as large",
}


def describe_plan(plan: NextExperiment, column: str, scale: float) -> dict[str, Any]:
    """Describe a plan, as in a verdict's `next_experiment`.

    Parameters
    ----------
    column, scale
        Of the load log, and its unit in N m.

    Returns
    -------
    dict
        protocol, tells_apart, expected_gain_nats, probability_sure, compared, cannot_show, narrows,
        n_trials, duration_s, largest_angle_rad, load_column, loads and a statement.
    """
    first = plan.expected[plan.best.name]
    gains = measure_gains(plan.question, first.ratio)
    told = [label for label, gain in gains.items() if gain >= plan.question.needed]
    narrowed = dict.fromkeys(plan.question.narrow, round(first.worth, 3))
    return {
        "protocol": plan.best.name,
        "tells_apart": told,
        "expected_gain_nats": {label: round(gain, 1) for label, gain in gains.items()},
        "probability_sure": _round(first.sure),
        "compared": {
            name: {"worth_nats": _round(part.worth), "probability_sure": _round(part.sure)}
            for name, part in plan.expected.items()
        },
        "cannot_show": plan.hidden,
        "narrows": narrowed,
        "n_trials": plan.limits.trials,
        "duration_s": round(plan.limits.duration, 3),
        "largest_angle_rad": round(plan.largest_angle, 4),
        "load_column": column,
        "loads": [
            {"time_s": time.tolist(), "load": (torque * scale).tolist()}
            for time, torque in zip(*plan.best.protocol, strict=True)
        ],
        "statement": state_plan(plan),
    }


def measure_gains(question: Question, ratio: NDArray[np.float64]) -> dict[str, float]:
    """Expected evidence [nats] for each asked survivor.

    Against the rival that stays nearest.

    Parameters
    ----------
    ratio
        (survivor, survivor) of the true one against the other.

    Returns
    -------
    dict
        By label.
    """
    gains = {}
    for a, survivor in enumerate(question.survivors):
        asked = question.weight[a] > 0.0
        if asked.any():
            gains[survivor.label] = float(ratio[a, asked].min())
    return gains


def state_plan(plan: NextExperiment) -> str:
    """A plan in plain sentences."""
    first, limits = plan.expected[plan.best.name], plan.limits
    what = f"{limits.trials} trials of {limits.duration:.3g} s of the protocol '{plan.best.name}'"
    said = [_state_aim(plan, what)]
    before = plan.expected.get(REPEATED)
    if np.isfinite(first.sure):
        said.append(f"A sure answer is expected with probability {first.sure:.2f}.")
        if before is not None and np.isfinite(before.sure):
            said[-1] = said[-1][:-1] + f"; with the old protocol it is {before.sure:.2f}."
    return " ".join([*said, state_obstacles(plan)]).strip()


def state_obstacles(plan: NextExperiment) -> str:
    """State what nothing within the limits shows, and why."""
    said = []
    for label, limit in plan.hidden.items():
        why = f"{LIMIT_WORDS[limit]} would" if limit else "no single limit is in the way"
        apart = label.replace(PAIR, " and ")
        what = f"shows {label}" if plan.question.supposes else f"separates {apart}"
        said.append(f"Nothing within the limits {what}: {why}.")
    return " ".join(said)


def _state_aim(plan: NextExperiment, what: str) -> str:
    question, first = plan.question, plan.expected[plan.best.name]
    if question.narrow:
        left = np.exp(-first.worth)
        return f"{what} narrow {', '.join(question.narrow)} to {left:.2f} of its sd."
    still = {k for pair in list_open(question, first.ratio) for k in pair}
    if question.supposes:
        shown = [s.label for k, s in enumerate(question.survivors) if k and k not in still]
        return f"{what} would show {', '.join(shown) or 'none of what is hidden'}."
    labels = [_name(s) for s in question.survivors]
    named = f"{', '.join(labels[:-1])} and {labels[-1]}"
    if still:
        return f"{what} are the best found to tell {named} apart."
    return f"{what} tell {named} apart."


def _name(survivor: Survivor) -> str:
    return "the base model" if survivor.label == "none" else survivor.label


def _round(value: float) -> float | None:
    return round(float(value), 3) if np.isfinite(value) else None


def tabulate_plan(problem: Problem, plan: NextExperiment, source: str) -> xr.Dataset:
    """Tabulate where survivors part under a plan.

    Of the trial and the joint where they part most. Each survivor's own parameters are adapted to
    the first one's motion, as a fit would.

    Returns
    -------
    Dataset
        load_time [s], load_torque [N m] (knot); angle (survivor, time) [rad]; apart
        (survivor, time), from the first survivor in sds of the noise.
    """
    survivors, limits = plan.question.survivors, plan.limits
    planned = plan_trials(problem, plan.best.protocol, limits.trials, limits.interval)
    noise = compute_bin_noise(planned.trials)
    motions = [adapt_motion(problem, s, survivors[0], planned, noise) for s in survivors]
    apart = np.stack([(motion - motions[0]) / noise for motion in motions])
    square = np.nanmean(apart[-1:] ** 2 if len(apart) < 2 else apart[1:] ** 2, axis=(0, 3))
    trial, joint = np.unravel_index(int(np.nanargmax(square)), square.shape)
    bins = planned.trials.bins[trial]
    return xr.Dataset(
        {
            "load_time": ("knot", planned.trials.load_time[trial]),
            "load_torque": ("knot", planned.trials.load_torque[trial]),
            "angle": (("survivor", "time"), np.stack(motions)[:, trial, joint, :bins]),
            "apart": (("survivor", "time"), apart[:, trial, joint, :bins]),
        },
        coords={
            "survivor": [_name(s) for s in survivors],
            "time": planned.trials.node[trial, :bins].mean(axis=1),
        },
        attrs={"source": source, "joint": int(joint) + 1, "protocol": plan.best.name},
    )


def adapt_motion(
    problem: Problem,
    survivor: Survivor,
    first: Survivor,
    planned: PlannedTrials,
    noise: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Motion (trial, joint, bin) [rad] of a survivor.

    Its own parameters are moved as far as the population allows, to follow the first survivor.
    """
    wanted, _ = linearise_motion(problem, first, planned)
    angle, slope = linearise_motion(problem, survivor, planned)
    d = problem.trials.joints * OWN
    inverse = np.linalg.inv(survivor.candidate.fit.omega)
    moved = angle.copy()
    for i in range(len(angle)):
        seen = np.isfinite(noise[i])
        rows = slope[i][seen][:, :d] / noise[i][seen][:, None]
        left = (wanted[i] - angle[i])[seen] / noise[i][seen]
        moved[i] += slope[i][..., :d] @ np.linalg.solve(rows.T @ rows + inverse, rows.T @ left)
    return moved
