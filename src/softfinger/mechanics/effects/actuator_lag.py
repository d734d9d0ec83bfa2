"""The load that acts follows the logged one with a lag of first order."""

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.load_known:
        return "there is no load log to lag behind"
    lag = positive("lag_s", 5 * setting.interval, floor=setting.time_floor)  # fmt: skip

    def slots(values: Values) -> dict:
        return {"lag": values["lag_s"]}

    return [Form("first_order", (lag,), slots)]


EFFECT = Effect(
    "actuator_lag", "the load that acts lags the logged one", "within_trial", _build_forms
)
