"""A nuisance of the proof: a measurement's fault."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from softfinger.concealed.arrays import Array, Flags
from softfinger.concealed.effects.effect import Circumstances, Shape
from softfinger.concealed.noise import Noise
from softfinger.concealed.population import Population
from softfinger.concealed.protocols import Load


@dataclass(frozen=True)
class Fault:
    """How much of a nuisance a campaign has."""

    size: float
    shape: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Scene:
    """One trial as a nuisance finds it.

    Attributes
    ----------
    time, motion
        (frame,) [s] that the recording states and (frame, joint) [rad] of the finger then.
    noise
        Of the campaign.
    rows
        (row, 2) of the load log: time [s], tension [N].
    respond
        Deflection (frame, joint) [rad] of this trial's three elements under a load.
    """

    time: Array
    motion: Array
    noise: Noise
    trial: Circumstances
    rows: Array
    respond: Callable[[Load], Array]

    @property
    def speed(self) -> Array:
        """Speed of the motion (frame, joint) [rad/s]."""
        return np.gradient(self.motion, self.time, axis=0)


@dataclass(frozen=True)
class Mark:
    """What a nuisance leaves in one trial's angles.

    Attributes
    ----------
    offset
        (frame, joint) [rad], added to the angles.
    columns
        (frame, joint, k) [rad]: to the oracle the error is their sum, each times a standard normal
        number.
    scale, shock
        Factors of the noise (frame, joint) and of its innovations (frame,).
    left_out
        (frame,) that are of no use to the oracle.
    nats
        Log probability of all that this mark settles and the angles that are kept do not contain.
    rounding
        Sd of a white error of each angle's own, over that of the noise.
    tails
        Degrees of freedom of innovations with heavy tails; 0: normal ones.
    """

    offset: Array | float = 0.0
    columns: Array | None = None
    scale: Array | float = 1.0
    shock: Array | float = 1.0
    left_out: Flags | None = None
    nats: float = 0.0
    rounding: float = 0.0
    tails: float = 0.0


Random = np.random.Generator


@dataclass(frozen=True)
class Nuisance:
    """One fault of the measurement.

    Each hook gets the fault and random numbers of this nuisance and trial, the same in every hook.

    Attributes
    ----------
    id, sentence
        Name and what it is.
    finding
        Id of the verdict's finding that it should produce; empty: no id describes it.
    also
        Ids that are no false finding where it acts.
    low, high
        Sizes, log-uniform between them.
    shape
        Its other parameters.
    trials
        Fewest trials in which it can act.
    people
        Change of every trial's own parameters (trial, parameter, joint).
    clock
        Times at which the frames were taken, from those that the recording states.
    clock_known
        Whether the oracle knows these times; if not, a mark's columns describe them.
    log
        Rows of the load log, with its errors.
    write
        Rows as they are written; the oracle knows those before.
    mark
        What is left in the angles.
    finish
        Change of the recorded angles (frame, joint), the noise included.
    """

    id: str
    sentence: str
    finding: str
    low: float
    high: float
    also: tuple[str, ...] = ()
    shape: dict[str, Shape] = field(default_factory=dict)
    trials: int = 1
    people: Callable[[Array, Population, Fault, Random], Array] | None = None
    clock: Callable[[Array, Fault, Circumstances, Random], Array] | None = None
    clock_known: bool = False
    log: Callable[[Array, Fault, Circumstances, Random], Array] | None = None
    write: Callable[[Array, Fault, Circumstances, Random], Array] | None = None
    mark: Callable[[Scene, Fault, Random], Mark] | None = None
    finish: Callable[[Array, Fault, Random], Array] | None = None

    def draw(self, rng: np.random.Generator) -> Fault:
        """Draw a size and the other parameters."""
        size = float(np.exp(rng.uniform(np.log(self.low), np.log(self.high))))
        return Fault(size, {key: shape.draw(rng) for key, shape in self.shape.items()})
