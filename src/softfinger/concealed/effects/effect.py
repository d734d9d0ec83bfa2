"""An effect of the proof: a switch, own form."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from softfinger.concealed.arrays import Array
from softfinger.concealed.physics import Physics
from softfinger.concealed.protocols import Load
from softfinger.concealed.rig import Rig


@dataclass(frozen=True)
class Dose:
    """Strength, shape and place of an effect."""

    strength: float  # 0: absent
    shape: dict[str, float] = field(default_factory=dict)
    joints: tuple[int, ...] = ()  # from 0; empty where the effect is not tied to joints
    scatter: float = 0.0  # sd of the strength's logarithm between trials

    def spread(self, joints: int) -> Array:
        """Strength (joint,), zero where the effect does not act."""
        on = np.zeros(joints)
        on[list(self.joints)] = 1.0
        return self.strength * on


@dataclass(frozen=True)
class Circumstances:
    """What is special about one trial."""

    number: int  # from 0, in the order of recording
    count: int  # trials in the campaign
    load: Load
    duration: float  # [s]
    warmth: float  # [K] above the campaign's reference temperature
    rest: float  # [s] since the trial before
    luck: tuple[float, float, float]  # uniform on (0, 1): phases, times of slips


@dataclass(frozen=True)
class Shape:
    """A parameter that the strength does not scale.

    It is log-uniform from `low` to `high`.

    Where it is a `choice`, it is either of the two and known to the oracle.
    """

    low: float
    high: float
    choice: bool = False

    def draw(self, rng: np.random.Generator) -> float:
        """Draw a value."""
        if self.choice:
            return float(rng.choice([self.low, self.high]))
        return float(np.exp(rng.uniform(np.log(self.low), np.log(self.high))))


Move = Callable[[Physics, Dose, Circumstances], Physics]
Record = Callable[[Array, Array, Dose, Circumstances, Rig], Array]


@dataclass(frozen=True)
class Effect:
    """One piece of left-out physics.

    Attributes
    ----------
    id, sentence
        Name and what it is.
    level
        Where it shows: within a trial, between trials, or in the measurement.
    joints
        ``any``: on every joint or on one; ``one``: on one; ``pair``: on two neighbours; ``first``:
        on the first; ``chain``: not tied to joints.
    typical, largest
        Strength that is plain to see, and the largest that is believable.
    shape
        Its other parameters.
    move, clock, record
        Change of the physics of a trial, of the time at which the finger is seen, of the recorded
        angles (frame, joint); each of them where the effect has one.
    tell
        Keys and values of the verdict's effect parameters.
    trials
        Fewest trials in which it can show.
    law, why
        Of a foreign law: its name, and why no textbook form of the catalogue contains it.
    argument, curve
        Of a law that is a factor 1 + s · curve(argument, trials in the campaign): what it depends
        on, its unit as suffix, and the curve.
    """

    id: str
    sentence: str
    level: Literal["within_trial", "between_trials", "measurement"]
    joints: Literal["any", "one", "pair", "first", "chain"]
    typical: float
    largest: float
    shape: dict[str, Shape] = field(default_factory=dict)
    move: Move | None = None
    clock: Callable[[Array, Dose, Circumstances], Array] | None = None
    record: Record | None = None
    tell: Callable[[Dose, list[Circumstances]], dict[str, float]] = lambda dose, trials: {}
    covariate: str | None = None
    trials: int = 1
    law: str = ""
    why: str = ""
    argument: str = ""
    curve: Callable[[Array, int], Array] | None = None


def set_amount(field: str) -> Move:
    """Set an amount of the joints to the strength."""
    return lambda physics, dose, trial: physics._replace(**{field: dose.spread(physics.k_v.size)})
