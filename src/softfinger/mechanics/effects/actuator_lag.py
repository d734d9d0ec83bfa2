"""The load that acts follows the logged one with a lag: one stage, or two in a row."""

from softfinger.mechanics.effects.effect import Effect, Form, Parameter, Setting, Values, positive


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.load_known:
        return "there is no load log to lag behind"
    lag = positive("lag_s", 5 * setting.interval, floor=setting.time_floor)
    share = Parameter("second_stage_share", 0.25, 0.12, low=0.02, high=0.48, starts=(0.25,))

    def slots(values: Values) -> dict:
        return {"lag": values["lag_s"]}

    def slots_of_two(values: Values) -> dict:
        return {"lag": values["lag_s"], "lag_second_share": values["second_stage_share"]}

    return [Form("first_order", (lag,), slots), Form("two_stages", (lag, share), slots_of_two)]


EFFECT = Effect(
    "actuator_lag", "the load that acts lags the logged one", "within_trial", _build_forms
)
