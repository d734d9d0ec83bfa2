"""What the recordings of a model file suffer from."""

from typing import Annotated, Any, Literal

from pydantic import Field

from softfinger.mechanics.effects.prior_file import Part, Positive

LINK_TURN = "link_turn_"  # and the link's number, from 1
Disturbance = Literal[
    "noisy_load",
    "load_drift",
    "timing_jitter",
    "clock_offset",
    "clock_rate",
    "step_scatter",
    "drift",
    "gain_drift",
    "lasting_noise",
    "flicker_noise",
    "picture_turn",
]
LinkTurn = Annotated[str, Field(pattern=f"^{LINK_TURN}[1-9][0-9]*$")]
DIGITS = 7
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Amplitudes = dict[str, list[float]]


class HumEntry(Part):
    """A wave that goes on whatever the load does.

    `cosine_rad` and `sine_rad`: trial → amplitude of each joint.
    """

    frequency_hz: Positive
    cosine_rad: Amplitudes
    sine_rad: Amplitudes


class MeasurementEntry(Part):
    """What recordings suffer from, found together with the physics.

    `steady_load`: readings count as levels and straight ramps; `ramps_held`: each row of a ramp
    stays until the next one; `load_tared`: what the log reads at the start is its zero;
    `clock_rate`: how slow the camera's clock runs, as a share;
    `clock_offsets_s`: trial → by how much its frames are later than stated; `steps_early`: how much
    sooner than at its later row a step of the load comes, as a share of the gap between the two
    rows that state it; `steps_open`: it comes at any moment of that gap; `step_shares`: trial →
    share of its gap by which each of its steps comes sooner, one after the other;
    `disturbances`: their sds, each in its own unit.
    """

    steady_load: bool = False
    ramps_held: bool = False
    load_tared: bool = False
    steps_early: Share = 0.0
    steps_open: bool = False
    step_shares: dict[str, list[Share]] = Field(default_factory=dict)
    clock_rate: Annotated[float, Field(gt=-0.5, lt=0.5)] = 0.0
    clock_offsets_s: dict[str, float] = Field(default_factory=dict)
    hums: list[HumEntry] = Field(default_factory=list)
    disturbances: dict[Disturbance | LinkTurn, Positive] = Field(default_factory=dict)

    def shorten(self) -> "MeasurementEntry | None":
        """Keep as many digits as files have; None if nothing is wrong."""
        if self == MeasurementEntry():
            return None
        return MeasurementEntry.model_validate(_shorten(self.model_dump()))


def _shorten(content: Any) -> Any:  # noqa: ANN401 (a document's parts have any type)
    if isinstance(content, dict):
        return {key: _shorten(value) for key, value in content.items()}
    if isinstance(content, list):
        return [_shorten(value) for value in content]
    return float(f"{content:.{DIGITS}g}") if isinstance(content, float) else content
