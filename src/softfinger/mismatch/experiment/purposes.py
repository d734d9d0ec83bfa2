"""What the next recordings are for."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.inference.budget import BUDGET as INFERENCE
from softfinger.inference.problem import Problem
from softfinger.mechanics import LOG_PARAMETERS, OWN, PARAMETERS
from softfinger.mechanics.forward.simulate import simulate_joint_angle_array
from softfinger.mechanics.forward.slots import SlotArrays
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.experiment.outlook import Foreseen, foresee, plan_trials
from softfinger.mismatch.experiment.protocols import PlannedProtocol
from softfinger.mismatch.experiment.separation import (
    TrialsDensity,
    bound_gain,
    expect_log_ratio,
)
from softfinger.mismatch.experiment.survivors import Survivor

SPREAD, ANGLE = "spread_", "angle_at_"


class Question(NamedTuple):
    """What a plan has to answer.

    Attributes
    ----------
    survivors
        Models; of effects that are supposed, the base model first.
    weight
        (survivor, survivor) of pairs that are to be separated.
    needed
        Expected evidence [nats] that separates a pair.
    narrow
        Quantities of the first survivor to narrow, in place of that.
    """

    survivors: list[Survivor]
    weight: NDArray[np.float64]
    needed: float
    narrow: tuple[str, ...] = ()

    @property
    def supposes(self) -> bool:
        """Whether it asks if effects are there."""
        return bool(self.weight.any() and not self.weight[:, 1:].any())


def ask_which(survivors: Sequence[Survivor]) -> Question:
    """Ask which of the survivors is right."""
    probability = np.array([s.probability for s in survivors])
    weight = np.outer(probability, probability)
    np.fill_diagonal(weight, 0.0)
    return Question(list(survivors), weight, DECISIONS.rival_nats)


def ask_whether(supposed: Sequence[Survivor]) -> Question:
    """Ask whether effects are there; the first is the base."""
    weight = np.zeros((len(supposed), len(supposed)))
    weight[1:, 0] = 1.0
    return Question(list(supposed), weight, DECISIONS.shows)


def ask_how_much(problem: Problem, survivor: Survivor, narrow: Sequence[str]) -> Question:
    """Ask for the size of quantities.

    Raises
    ------
    Fault
        A quantity that the model does not have.
    """
    for name in narrow:
        list_directions(problem, survivor, name)
    alone = survivor._replace(probability=1.0)
    return Question([alone], np.zeros((1, 1)), DECISIONS.rival_nats, tuple(narrow))


def foresee_question(
    problem: Problem, question: Question, protocol: PlannedProtocol, count: int, interval: float
) -> list[Foreseen]:
    """Predict a protocol's trials by all survivors."""
    planned = plan_trials(problem, protocol, count, interval)
    return foresee(problem, question.survivors, planned)


def judge_answer(problem: Problem, question: Question, foreseen: Sequence[Foreseen]) -> float:
    """Worth [nats] of recordings for a question."""
    if question.narrow:
        gains = [
            measure_narrowing(problem, question.survivors[0], foreseen[0], name)
            for name in question.narrow
        ]
        return float(np.mean(gains))
    return bound_gain(expect_log_ratio(foreseen), question.weight, question.needed)


def measure_narrowing(problem: Problem, survivor: Survivor, foreseen: Foreseen, name: str) -> float:
    """Expected fall of the log sd [nats] of a quantity.

    Mean over joints; variances are those of Laplace's posterior, before and after.
    """
    density = TrialsDensity(foreseen)
    if name.startswith(SPREAD):
        return _narrow_spread(problem, survivor, foreseen, density, name)
    directions = list_directions(problem, survivor, name)
    before = np.einsum("ks,sr,kr->k", directions, foreseen.covariance, directions)
    after = np.einsum("ks,sr,kr->k", directions, density.inside, directions)
    return float(np.mean(0.5 * np.log(before / np.maximum(after, 1e-300))))


def _narrow_spread(
    problem: Problem, survivor: Survivor, foreseen: Foreseen, density: TrialsDensity, name: str
) -> float:
    """The same of a log sd between trials: information ½ tr (V⁻¹ ∂V)²."""
    place = PARAMETERS.index(name.removeprefix(SPREAD))
    recorded, gains = len(problem.trials.name), []
    gram = survivor.candidate.fit.gram
    d, omega = len(foreseen.omega), foreseen.omega
    for k in range(place, d, OWN):
        old = gram[:, :d, :d]
        kept = np.linalg.inv(np.linalg.inv(omega) + old)
        seen = omega[k, k] * (old - old @ kept @ old)[:, k, k]
        column = foreseen.own[..., k]
        new = omega[k, k] * np.einsum("tc,tce,te->t", column, density.precision, column)
        before = 1.0 + 2.0 * np.sum(seen**2) * recorded / max(len(seen), 1)
        gains.append(0.5 * np.log1p(2.0 * np.sum(new**2) / before))
    return float(np.mean(gains))


def list_directions(problem: Problem, survivor: Survivor, name: str) -> NDArray[np.float64]:
    """Directions (k, d + p) of θ in which a quantity changes.

    Raises
    ------
    Fault
        The model has no such quantity.
    """
    model, fit = survivor.candidate.model, survivor.candidate.fit
    size, d = len(survivor.covariance), len(fit.mean)
    unit = np.eye(size)
    if name.startswith(ANGLE):
        return _slope_angle(problem, survivor, _read_time(name))
    plain = name.removeprefix(SPREAD).removeprefix("log_")
    if plain in PARAMETERS:
        return unit[PARAMETERS.index(plain) : d : OWN]
    entries = [entry.name for entry in model.entries]
    if name in entries:
        return unit[[d + entries.index(name)]]
    choices = [*PARAMETERS, *(SPREAD + p for p in PARAMETERS), *entries, ANGLE + "10"]
    raise Fault(
        f"--narrow {name}: the model has no such quantity; choose from {', '.join(choices)}, where "
        "10 is any time [s]"
    )


def _read_time(name: str) -> float:
    try:
        time = float(name.removeprefix(ANGLE))
    except ValueError:
        time = -1.0
    if not time > 0.0:
        raise Fault(f"--narrow {name}: expected a time [s] above 0, as in {ANGLE}10")
    return time


def _slope_angle(problem: Problem, survivor: Survivor, time: float) -> NDArray[np.float64]:
    """∂(angle at a time)/∂θ (joint, d + p) under the first trial's load."""
    model, fit = survivor.candidate.model, survivor.candidate.fit
    first = np.array([0])
    slots = [model.fill_slots(fit.shared), *model.fill_tangents(fit.shared)]
    own, *tangents = (SlotArrays(*(a[first] for a in part)) for part in slots)
    _, slope = simulate_joint_angle_array(
        fit.mean.reshape(1, problem.trials.joints, len(LOG_PARAMETERS)),
        own,
        tangents,
        problem.finger,
        np.array([time]),
        problem.trials.load_time[:1],
        problem.trials.load_torque[:1],
        tolerance=INFERENCE.angle_error,
    )
    return slope[0, :, 0]
