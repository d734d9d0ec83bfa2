"""An effect: forms that fill slots of the forward model.

A form turns a few parameters into values of slots; with its amplitudes at zero it is the base
model. Priors are normal on the internal scale (the logarithm, for a parameter marked log), cut at
the bounds.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from softfinger.mechanics.forward.hooks import Hook

if TYPE_CHECKING:
    from softfinger.mechanics.effects.law import Law

FREE = "free"
"""First word of the name of a free form."""
SMALL = 0.01  # of the prior sd: amplitudes start almost absent, where the fit is nearly linear

Values = Mapping[str, NDArray[np.float64]]


@dataclass(frozen=True)
class Parameter:
    """One parameter of a form.

    Attributes
    ----------
    name
        With its unit as suffix; `_J` or `_JK` is added for each joint or pair of neighbours.
    mean, sd
        Prior on the internal scale.
    per
        One for the chain, for each joint, for each ordered pair of neighbouring joints, or for each
        two neighbours alike.
    log
        The internal scale is the natural logarithm.
    low, high
        Bounds on the internal scale.
    amplitude
        The effect is absent where all amplitudes are 0.
    floor
        Amplitudes (or exp of a log parameter) below this are never claimed: systematic errors of
        a good rig are taken to reach that far.
    starts, far
        Internal values from which a fit begins, in every combination; and those from which another
        mode may be met, tried where much is left out.
    report
        Names under which a verdict gives it, each with its value there from the physical one and
        the joint (0-based; −1 for the chain); empty: as it is.
    term
        It is a term of a free law, of which the curve is the result and not the number.
    """

    name: str
    mean: float = 0.0
    sd: float = 1.0
    per: Literal["chain", "joint", "pair", "neighbours"] = "chain"
    log: bool = False
    low: float = -np.inf
    high: float = np.inf
    amplitude: bool = False
    floor: float = 0.0
    starts: tuple[float, ...] = ()
    report: Mapping[str, Callable[[float, int], float]] = field(default_factory=dict)
    term: bool = False
    far: tuple[float, ...] = ()


def positive(name: str, sd: float, **more: object) -> Parameter:
    """Build an amplitude ≥ 0: half-normal, scale `sd`."""
    return Parameter(name, 0.0, sd, low=0.0, amplitude=True, starts=(SMALL * sd,), **more)


def signed(name: str, sd: float, **more: object) -> Parameter:
    """Build an amplitude, normal of scale `sd`."""
    return Parameter(name, 0.0, sd, amplitude=True, starts=(SMALL * sd,), **more)


def time_constant(name: str, shortest: float, longest: float, starts: int = 3) -> Parameter:
    """Build a time: log-normal, ± 2 sd given."""
    low, high = np.log(shortest), np.log(longest)
    middle, sd = (low + high) / 2, (high - low) / 4
    places = tuple(np.linspace(low, high, starts + 2)[1:-1])
    return Parameter(name, middle, sd, log=True, low=low, high=high, starts=places)


@dataclass(frozen=True)
class Setting:
    """What is known before an effect is fitted.

    Attributes
    ----------
    trials, joints
        How many.
    interval, duration
        [s], median frame interval, longest trial.
    torque
        [N m], median over trials of the largest load.
    reversals
        Whether the load falls after it has risen.
    levels
        Whether some trial's load takes more than one level.
    rests
        Whether the load returns to a tenth or less after it has risen.
    load_known
        Whether there is a load log; `tension` whether it is the wire's tension.
    stiffness
        (joint,) [N m/rad], k_v of the base model, median over trials.
    reach
        (joint,) [rad], largest angle seen, q_ini included.
    number
        (trial,) trials done before.
    memory
        (trial, joint) [rad], elastic angle of the base model at the end of the trial before;
        0 for the first.
    largest_torque
        (trial,) [N m], largest load of each.
    rest_time
        (trial,) [s] since the end of the trial before; NaN = unknown.
    covariates
        Name → (trial,), as logged.
    geometry, masses
        Whether wire geometry and link masses are declared.
    step_gap
        [s], the widest gap between the two rows of the load log that state a step: when within it
        the load changed is not known.
    camera
        Whether the motion was filmed, or a camera is declared.
    drift
        (trial, joint, 3) log k_v, c_v, c_p of the base model in each trial; None before it is
        fitted.
    specimen
        Whether it is a specimen, without wire, links, lens or plane.
    first_seen
        [s] from the first load to the second frame after it, median over trials; 0 = unknown.
    own_time
        (joint,) [s], c_v/k_v of the base model, median over trials; where it is not given, between
        the shortest and the longest time.
    """

    trials: int
    joints: int
    interval: float
    duration: float
    torque: float
    reversals: bool
    levels: bool
    rests: bool
    load_known: bool
    tension: bool
    stiffness: NDArray[np.float64]
    reach: NDArray[np.float64]
    number: NDArray[np.float64]
    memory: NDArray[np.float64]
    largest_torque: NDArray[np.float64]
    rest_time: NDArray[np.float64]
    covariates: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    geometry: bool = False
    masses: bool = False
    step_gap: float = 0.0
    camera: bool = False
    drift: NDArray[np.float64] | None = None
    specimen: bool = False
    first_seen: float = 0.0
    own_time: NDArray[np.float64] | None = None

    def __post_init__(self) -> None:
        """Give joints a time of their own."""
        if self.own_time is None:
            middle = float(np.sqrt(self.shortest * self.duration))
            object.__setattr__(self, "own_time", np.full(self.joints, middle))

    @property
    def shortest(self) -> float:
        """The shortest time [s] that frames resolve, where they are densest."""
        return min(self.interval, self.first_seen or self.interval)

    @property
    def one_course(self) -> bool:
        """Whether all that moves is one function of time."""
        return self.trials == 1 and not self.levels

    @property
    def time_floor(self) -> float:
        """The shortest lag worth a name [s].

        It is 1/200 to 1/50 frame, as the log leaves it; the same for a delay.
        """
        return self.interval * min(0.02, max(0.005, self.step_gap / self.interval))


@dataclass(frozen=True)
class Form:
    """One form of an effect: textbook or free.

    Attributes
    ----------
    name
        Unique within the effect.
    parameters
        In the order in which they are fitted.
    slots
        Physical values → slots: a chain parameter comes as (), a joint parameter as (joint,), a
        pair parameter as (joint, other joint), one of neighbours with the lower joint first; joints
        outside the fitted set hold 0.
    covariate
        The covariate it depends on.
    local
        Chain parameters that may act on a single joint instead of all alike.
    law
        The free law among its parameters.
    kin
        Names a free law that several effects share: what they are is told by its shape.
    finer
        The same law with more terms, which a further effect has to beat.
    lent
        Whether the law is another effect's: where the form's own amplitudes vanish, it is that one.
    linear
        Whether the slots are linear in the law's terms, by slopes that depend on nothing else.
    """

    name: str
    parameters: tuple[Parameter, ...]
    slots: Callable[[Values], dict[str, NDArray[np.float64]]]
    covariate: str | None = None
    local: bool = False
    law: "Law | None" = None
    kin: str = ""
    finer: "Form | None" = None
    lent: bool = False
    linear: bool = False

    @property
    def is_free(self) -> bool:
        """Whether it is the free law, no textbook's."""
        return self.name.split("_")[0] == FREE


@dataclass(frozen=True)
class Effect:
    """A piece of physics that may be missing.

    Attributes
    ----------
    id
        As in the verdict.
    sentence
        What happens, in plain words.
    level
        Where it shows.
    build_forms
        The forms that a campaign allows, or a sentence that states why there are none.
    part
        The part of a finger that it needs and a specimen lacks; empty where it needs none.
    hooks
        Its physics in the forward model (`forward.hooks`); empty where it moves slots of others.
    of_motion
        Whether its law is of the motion: angle, rate, or torque of the spring. One trial under one
        load shows it as a course in time, and creep may have any.
    place
        Of several effects: two are not claimed together, for one freer law is both.
    place_in_time
        The same under one load in each trial, where its law is a course in time.
    place_of_one
        The same where there is but one joint besides: what all joints share is that joint's own.
    course
        Filled slots, times in the trial (n,) → (joint, n), the log of what must fall; or None.
    """

    id: str
    sentence: str
    level: Literal["within_trial", "between_trials", "measurement"]
    build_forms: Callable[[Setting], list[Form] | str]
    part: str = ""
    hooks: tuple[Hook, ...] = ()
    of_motion: bool = False
    place: str = ""
    place_in_time: str = ""
    place_of_one: str = ""
    course: Callable[[Values, NDArray[np.float64]], NDArray[np.float64]] | None = None

    def find_place(self, setting: Setting) -> str:
        """The place that it shares with others; else its id."""
        if self.place or setting.levels:
            return self.place or self.id
        return self.place_in_time or (setting.joints == 1 and self.place_of_one) or self.id

    def list_forms(self, setting: Setting) -> list[Form] | str:
        """Forms that a campaign allows, or why none."""
        if setting.specimen and self.part:
            return f"the campaign is of a specimen, which has no {self.part}"
        if self.of_motion and setting.one_course:
            return "one trial under one load cannot separate a law of the motion from creep in time"
        return self.build_forms(setting)
