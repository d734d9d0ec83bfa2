"""The next experiment: what to record, and what it would show."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.inference.problem import Problem
from softfinger.measurement.decisions import DECISIONS as MEASURING
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.experiment.choice import Choice, assess, choose_best, hold_angle
from softfinger.mismatch.experiment.limits import RigLimits, check_limits, scale_load
from softfinger.mismatch.experiment.outlook import Foreseen, measure_largest_angle
from softfinger.mismatch.experiment.protocols import PlannedProtocol
from softfinger.mismatch.experiment.purposes import (
    Question,
    foresee_question,
    judge_answer,
)
from softfinger.mismatch.experiment.separation import expect_log_ratio, expect_sure
from softfinger.mismatch.experiment.shapes import list_generic
from softfinger.mismatch.priors import PRIORS

REPEATED = "as recorded"
PAIR = " / "
"""Between the labels of two survivors that stay alike."""


class Expected(NamedTuple):
    """What one protocol is expected to show.

    Attributes
    ----------
    worth
        [nats] for the question.
    ratio
        (survivor, survivor) expected evidence [nats] of the true one against the other.
    sure, right
        Probability of a sure answer, and of a right one; NaN where sizes are asked for.
    """

    worth: float
    ratio: NDArray[np.float64]
    sure: float
    right: float


class NextExperiment(NamedTuple):
    """A plan, and what it is compared with.

    Attributes
    ----------
    question, limits
        What it answers, and keeps within.
    best
        The protocol.
    expected
        Name → what it is expected to show: the plan's first, then others.
    largest_angle
        [rad] of trials drawn from all survivors.
    hidden
        Label of a survivor that stays open → the limit in its way, or None.
    """

    question: Question
    limits: RigLimits
    best: Choice
    expected: dict[str, Expected]
    largest_angle: float
    hidden: dict[str, str | None]


def plan_next(
    problem: Problem,
    question: Question,
    limits: RigLimits,
    rng: np.random.Generator,
    *,
    short: bool = False,
) -> NextExperiment:
    """Plan the recordings that answer a question best.

    Parameters
    ----------
    short
        Try few protocols, improve none, and do not ask which limit is in the way.

    Raises
    ------
    Fault
        The limits allow nothing.
    """
    rest = measure_reach_at_rest(problem, question)
    check_limits(limits, rest, MEASURING.least_frames)

    def foresee(protocol: PlannedProtocol) -> list[Foreseen]:
        return foresee_question(problem, question, protocol, limits.trials, limits.interval)

    def purpose(protocol: PlannedProtocol) -> float:
        return judge_answer(problem, question, foresee(protocol))

    def reach(protocol: PlannedProtocol) -> float:
        return measure_largest_angle(problem, question.survivors, protocol)

    seed = int(rng.integers(2**31))
    tried = choose_best(limits, purpose, reach, short=short)
    ranked = (choice for choice in tried if np.isfinite(choice.worth))
    safe = (_make_safe(problem, question, limits, choice, seed) for choice in ranked)
    tested = ((*one, expect(question, purpose, foresee, one[0].protocol, seed)) for one in safe)
    found = next((one for one in tested if np.isfinite(one[2].worth)), None)
    if found is None:
        raise Fault(
            "no protocol is within the limits: a larger --max-angle, --max-load or --max-rate, or "
            "more --minutes are needed"
        )
    best, largest, first = found
    others = {REPEATED: repeat_protocol(problem, limits.trials)}
    others |= {} if short else {f"plain {name}": p for name, p in list_generic(limits).items()}
    held = {name: hold_angle(protocol, limits, reach) for name, protocol in others.items()}
    compared = {
        name: expect(question, purpose, foresee, protocol, seed)
        for name, protocol in held.items()
        if protocol is not None
    }
    expected = {best.name: first}
    expected |= {name: part for name, part in compared.items() if np.isfinite(part.worth)}
    hidden = {} if short else find_obstacles(problem, question, limits, best, first)
    return NextExperiment(question, limits, best, expected, largest, hidden)


def expect(question: Question, purpose, foresee, protocol: PlannedProtocol, seed: int) -> Expected:  # noqa: ANN001
    """What a protocol is expected to show."""
    count = len(question.survivors)
    worth = assess(protocol, purpose)
    if not np.isfinite(worth):
        return Expected(worth, np.zeros((count, count)), np.nan, np.nan)
    foreseen = foresee(protocol)
    if question.narrow or count < 2:
        return Expected(worth, np.zeros((count, count)), np.nan, np.nan)
    probability = np.array([s.probability for s in question.survivors])
    rng = np.random.default_rng(seed)
    sure, right = expect_sure(foreseen, probability, rng, BUDGET.sure_draws)
    return Expected(worth, expect_log_ratio(foreseen), sure, right)


def measure_reach_at_rest(problem: Problem, question: Question) -> float:
    """Largest angle [rad] without load."""
    idle = PlannedProtocol(np.array([[0.0, 1.0]]), np.zeros((1, 2)))
    return measure_largest_angle(problem, question.survivors, idle)


def repeat_protocol(problem: Problem, count: int) -> PlannedProtocol:
    """Loads of the last trials, as one protocol."""
    trials = problem.trials
    rows = slice(-count, None)
    end = np.array([node[:b].max() for node, b in zip(trials.node, trials.bins, strict=True)])
    end = np.full(len(end[rows]), end.max())
    time, torque = trials.load_time[rows], trials.load_torque[rows]
    time = np.minimum(time, end[:, None])
    return PlannedProtocol(np.c_[time, end], np.c_[torque, torque[:, -1]])


def _make_safe(
    problem: Problem, question: Question, limits: RigLimits, best: Choice, seed: int
) -> tuple[Choice, float]:
    """Lower the load until drawn trials keep the angle.

    A recalled angle is no limit of the rig: there, trials like those recorded keep it already.
    """
    protocol = best.protocol
    if limits.recalled:
        return best, measure_largest_angle(problem, question.survivors, protocol)
    for _ in range(BUDGET.angle_rounds):
        rng = np.random.default_rng(seed)
        largest = max(
            measure_largest_angle(problem, question.survivors, protocol, rng)
            for _ in range(BUDGET.safety_draws)
        )
        if largest <= limits.angle:
            break
        protocol = scale_load(protocol, 0.97 * limits.angle / largest)
    return best._replace(protocol=protocol), largest


def list_open(question: Question, ratio: NDArray[np.float64]) -> list[tuple[int, int]]:
    """Pairs of survivors that stay too alike."""
    asked = np.argwhere((question.weight > 0.0) & (ratio < question.needed))
    return [(int(a), int(b)) for a, b in asked]


def find_obstacles(
    problem: Problem, question: Question, limits: RigLimits, best: Choice, expected: Expected
) -> dict[str, str | None]:
    """Which limit keeps survivors from being separated.

    A limit is in the way where a few protocols beyond it would separate the pair.
    """
    left = list_open(question, expected.ratio)
    found: dict[str, str | None] = {}
    for a, b in left:
        found.setdefault(_name_pair(question, a, b), None)
    if not left:
        return {}
    for name, wider in _relax(limits).items():
        ratio = _try_limits(problem, question, wider, best)
        for a, b in left:
            if ratio[a, b] >= question.needed and found[_name_pair(question, a, b)] is None:
                found[_name_pair(question, a, b)] = name
    return found


def _name_pair(question: Question, a: int, b: int) -> str:
    labels = [question.survivors[k].label for k in (a, b)]
    return labels[0] if question.supposes else PAIR.join(sorted(labels))


def _relax(limits: RigLimits) -> dict[str, RigLimits]:
    """One limit wider at a time, the cheapest first."""
    more = PRIORS.limit_relaxed
    wider = {
        "trials": limits._replace(trials=more * limits.trials, minutes=more * limits.minutes),
        "minutes": limits._replace(minutes=more * limits.minutes),
        "rate": limits._replace(rate=np.inf),
        "interval": limits._replace(interval=limits.interval / PRIORS.camera_relaxed),
        "load": limits._replace(load=more * limits.load),
        "angle": limits._replace(angle=more * limits.angle),
    }
    return {name: value for name, value in wider.items() if np.isfinite(getattr(limits, name))}


def _try_limits(
    problem: Problem, question: Question, limits: RigLimits, best: Choice
) -> NDArray[np.float64]:
    """Largest expected evidence of each pair under a few protocols."""
    share = limits.load / max(float(best.protocol.load_torque.max()), 1e-300)
    tried: Sequence[PlannedProtocol] = [
        scale_load(best.protocol, share),
        *list_generic(limits).values(),
    ]
    largest = np.zeros_like(question.weight)

    def reach(protocol: PlannedProtocol) -> float:
        return measure_largest_angle(problem, question.survivors, protocol)

    for protocol in tried:
        held = hold_angle(protocol, limits, reach)
        if held is None:
            continue
        try:
            foreseen = foresee_question(problem, question, held, limits.trials, limits.interval)
            largest = np.maximum(largest, expect_log_ratio(foreseen))
        except (ArithmeticError, Fault, np.linalg.LinAlgError):
            continue
    return largest
