"""The load that is logged is not reached: it saturates, or rises no faster than at some rate.

Limit and rate are shares of the largest load. Free: what acts is any smooth function of the load.
"""

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.law import Law, free_form

POWER = 8.0  # of the saturation


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.load_known:
        return "there is no load log to compare with"
    largest = float(setting.largest_torque.max())
    most = positive(
        "saturation",
        3.0,
        high=1e4,
        floor=2e-3,
        report={"limit": lambda b, _: max(b, 1e-6) ** (-1.0 / POWER)},
    )
    rise = positive(
        "rise_time_s",
        0.05 * setting.duration,
        high=setting.duration,
        floor=setting.time_floor,
        report={"rate_per_s": lambda time, _: 1.0 / max(time, 1e-3 * setting.time_floor)},
    )

    def saturate(values: Values) -> dict:
        return {"load_saturation": values["saturation"], "load_reference": largest}

    def slow(values: Values) -> dict:
        return {"load_slowness": values["rise_time_s"] / largest}

    law = Law("load_law", "load_nm", largest, 0.3, terms=5)
    return [
        Form("saturation", (most,), saturate),
        Form("rate", (rise,), slow),
        free_form(law, {"load_reference": largest}),
    ]


EFFECT = Effect("load_limit", "the logged load is not reached", "within_trial", _build_forms)
