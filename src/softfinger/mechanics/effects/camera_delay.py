"""The recording is shifted in time against the load log."""

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, signed


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
)
