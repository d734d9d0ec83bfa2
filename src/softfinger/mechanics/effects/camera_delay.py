"""The recording comes later than the load log."""

from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, signed
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.work import Model

(_DELAY,) = declare(
    delay=Slot("chain", "s", 0.0, "the recording shows the angle of this much earlier"),
)


@compiled
def show_past(model: Model, time: NDArray, late: NDArray) -> None:
    """The moments that the frames show."""
    time -= model.chain[_DELAY]
    late -= model.d_chain[:, _DELAY]


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.load_known:
        return "there is no load log to compare with"
    delay = signed("delay_s", 3 * setting.interval, floor=setting.time_floor,
                   low=-20 * setting.interval, high=20 * setting.interval)  # fmt: skip

    def slots(values: Values) -> dict:
        return {"delay": values["delay_s"]}

    return [Form("constant", (delay,), slots)]


EFFECT = Effect(
    "camera_delay",
    "the recording is shifted in time against the load log",
    "measurement",
    _build_forms,
    hooks=(Hook("clock", show_past, ("delay",)),),
)
