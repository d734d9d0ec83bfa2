"""The protocol within limits that serves a purpose best."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.stats import qmc

from softfinger.faults import Fault
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.experiment.limits import RigLimits, scale_load
from softfinger.mismatch.experiment.protocols import PlannedProtocol
from softfinger.mismatch.experiment.shapes import build_protocol, list_generic, list_shapes

Purpose = Callable[[PlannedProtocol], float]
"""What a protocol is worth [nats]; larger is better."""
Reach = Callable[[PlannedProtocol], float]
"""Largest angle [rad] under a protocol."""


class Choice(NamedTuple):
    """A protocol, its kind and worth [nats]."""

    name: str
    protocol: PlannedProtocol
    worth: float


@dataclass
class _Trial:
    """Judges places of one kind of protocol."""

    limits: RigLimits
    purpose: Purpose
    reach: Reach
    seen: list[Choice] = field(default_factory=list)

    def judge(self, name: str, protocol: PlannedProtocol) -> float:
        held = hold_angle(protocol, self.limits, self.reach)
        worth = -np.inf if held is None else assess(held, self.purpose)
        if held is not None:
            self.seen.append(Choice(name, held, worth))
        return worth

    def best(self, name: str) -> Choice | None:
        mine = [choice for choice in self.seen if choice.name == name]
        return max(mine, key=lambda choice: choice.worth, default=None)


def assess(protocol: PlannedProtocol, purpose: Purpose) -> float:
    """Worth of a protocol; −inf where a model has no motion."""
    try:
        worth = purpose(protocol)
    except (ArithmeticError, Fault, np.linalg.LinAlgError):
        return -np.inf
    return worth if np.isfinite(worth) else -np.inf


def hold_angle(
    protocol: PlannedProtocol, limits: RigLimits, reach: Reach
) -> PlannedProtocol | None:
    """Lower a protocol's load until no joint goes too far.

    None where that takes nearly all of its load, or more knots than the rig stores.
    """
    if protocol.load_time.shape[1] > limits.knots:
        return None
    if not np.isfinite(limits.angle):
        return protocol
    for _ in range(BUDGET.angle_rounds):
        try:
            over = reach(protocol) / limits.angle
        except (ArithmeticError, Fault):
            return None
        if over <= 1.0:
            return protocol
        protocol = scale_load(protocol, 0.98 / over)
    return None


def choose_best(
    limits: RigLimits, purpose: Purpose, reach: Reach, *, short: bool = False
) -> list[Choice]:
    """Choose the best protocol of every kind, best first.

    Each kind is tried at a few places that fill its space evenly; the leading kinds are then
    improved by Nelder and Mead's simplex within the limits, unless it is to be `short`.

    Returns
    -------
    list
        Empty where no protocol is within the limits.
    """
    trial = _Trial(limits, purpose, reach)
    start: dict[str, NDArray] = {}
    for name, shape in list_shapes().items():
        size = len(shape.parameters)
        count = 1 if short else BUDGET.first_places
        spread = qmc.Halton(size, scramble=False).random(count + 1)[1:]
        spread[:, 0] = 1.0 - 0.3 * spread[:, 0]
        judged = [trial.judge(name, build_protocol(name, p, limits)) for p in spread]
        start[name] = spread[int(np.argmax(judged))]
    for name, protocol in list_generic(limits).items():
        trial.judge(name, protocol)
    leading = [] if short else _rank(trial)[: BUDGET.leading_shapes]
    for choice in leading:
        _improve(trial, choice.name, start[choice.name])
    return _rank(trial)


def _improve(trial: _Trial, name: str, start: NDArray) -> None:
    def lose(places: NDArray) -> float:
        worth = trial.judge(name, build_protocol(name, places, trial.limits))
        return -worth if np.isfinite(worth) else 1e9

    size = len(start)
    simplex = np.clip(np.vstack([start, start + np.where(start > 0.5, -0.25, 0.25) * np.eye(size)]),
                      0.0, 1.0)  # fmt: skip
    options = {
        "maxfev": BUDGET.simplex_tries,
        "initial_simplex": simplex,
        "xatol": 0.01,
        "fatol": 0.05,
    }
    minimize(lose, start, method="Nelder-Mead", bounds=[(0.0, 1.0)] * size, options=options)


def _rank(trial: _Trial) -> list[Choice]:
    names = dict.fromkeys(choice.name for choice in trial.seen)
    best = [choice for name in names if (choice := trial.best(name)) is not None]
    return sorted(best, key=lambda choice: -choice.worth)
