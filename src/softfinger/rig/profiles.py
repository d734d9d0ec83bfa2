"""Tension profiles: named shapes that become knots.

Knots are the one form that is sent and stored.

Knots are (time [s], tension [N]): straight lines between, two knots of one time are a step. A
profile begins at time 0, from a slack wire, and its last tension lasts until the wire is released.
"""

from abc import abstractmethod
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from softfinger.settings import Settings

Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
Levels = Annotated[list[NotNegative], Field(min_length=1)]
Count = Annotated[int, Field(ge=1)]
Knots = tuple[NDArray[np.float64], NDArray[np.float64]]
SINE_KNOTS_PER_PERIOD = 32  # chords leave the sine by at most 0.5 % of the amplitude


class _Profile(Settings):
    name: Annotated[str, Field(pattern=r"^[a-z0-9_]+$")]

    @abstractmethod
    def _list_knots(self) -> list[tuple[float, float]]: ...

    def build_knots(self) -> Knots:
        """Times (knot,) [s] and tensions (knot,) [N].

        Times start at 0 and do not decrease.
        """
        time, tension = np.array(self._list_knots()).T
        return time, tension


class Steps(_Profile):
    """Jumps to each level and stays there.

    >>> time, tension = Steps(name="a", shape="steps", levels_n=[8, 2], hold_s=3).build_knots()
    >>> time, tension
    (array([0., 3., 3., 6.]), array([8., 8., 2., 2.]))
    """

    shape: Literal["steps"]
    levels_n: Levels
    hold_s: Positive

    def _list_knots(self) -> list[tuple[float, float]]:
        return _hold(self.levels_n, self.hold_s)


class Staircase(_Profile):
    """Equal stairs up and down, the peak once."""

    shape: Literal["staircase"]
    peak_n: Positive
    stairs: Count
    hold_s: Positive

    def _list_knots(self) -> list[tuple[float, float]]:
        up = [self.peak_n * stair / self.stairs for stair in range(1, self.stairs + 1)]
        return _hold([*up, *up[-2::-1], 0.0], self.hold_s)


class Ramps(_Profile):
    """Straight line to each level, then a hold."""

    shape: Literal["ramps"]
    levels_n: Levels
    ramp_s: Positive
    hold_s: Positive

    def _list_knots(self) -> list[tuple[float, float]]:
        knots = [(0.0, 0.0)]
        for level in self.levels_n:
            arrived = knots[-1][0] + self.ramp_s
            knots += [(arrived, level), (arrived + self.hold_s, level)]
        return knots


class Triangle(_Profile):
    """Rises to the peak and back to 0, repeatedly."""

    shape: Literal["triangle"]
    peak_n: Positive
    rise_s: Positive
    cycles: Count

    def _list_knots(self) -> list[tuple[float, float]]:
        return [(k * self.rise_s, self.peak_n * (k % 2)) for k in range(2 * self.cycles + 1)]


class Sine(_Profile):
    """Tension mean − amplitude cos(2π t / period)."""

    shape: Literal["sine"]
    mean_n: Positive
    amplitude_n: Positive
    period_s: Positive
    cycles: Count

    @model_validator(mode="after")
    def _stay_taut(self) -> Self:
        if self.amplitude_n > self.mean_n:
            raise ValueError(
                f"amplitude_n is {self.amplitude_n:g} and mean_n {self.mean_n:g}; a wire cannot "
                "push, so the amplitude is at most the mean"
            )
        return self

    def _list_knots(self) -> list[tuple[float, float]]:
        turns = np.arange(self.cycles * SINE_KNOTS_PER_PERIOD + 1) / SINE_KNOTS_PER_PERIOD
        tension = self.mean_n - self.amplitude_n * np.cos(2 * np.pi * turns)
        return list(zip(turns * self.period_s, tension, strict=True))


class LoadPath(_Profile):
    """Straight lines between given knots.

    >>> path = LoadPath(name="a", shape="path", time_s=[0, 2, 2, 5], tension_n=[0, 4, 1, 1])
    >>> path.build_knots()
    (array([0., 2., 2., 5.]), array([0., 4., 1., 1.]))
    """

    shape: Literal["path"]
    time_s: Levels
    tension_n: Levels

    @model_validator(mode="after")
    def _go_forward(self) -> Self:
        if len(self.time_s) != len(self.tension_n):
            raise ValueError(
                f"time_s has {len(self.time_s)} numbers and tension_n {len(self.tension_n)}; give "
                "one tension for each time"
            )
        pairs = zip(self.time_s, self.time_s[1:], strict=False)
        if self.time_s[0] != 0.0 or any(after < before for before, after in pairs):
            raise ValueError("time_s must start at 0 and never run backwards")
        return self

    def _list_knots(self) -> list[tuple[float, float]]:
        return list(zip(self.time_s, self.tension_n, strict=True))


Profile = Annotated[
    Steps | Staircase | Ramps | Triangle | Sine | LoadPath, Field(discriminator="shape")
]


def _hold(levels: list[float], hold: float) -> list[tuple[float, float]]:
    return [(k * hold, level) for n, level in enumerate(levels) for k in (n, n + 1)]
