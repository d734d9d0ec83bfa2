"""A second Voigt element in series: relaxation on a second time scale."""

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.effect import time_constant as between


def _build_forms(setting: Setting) -> list[Form]:
    share = positive("compliance_share", 0.3, per="joint", floor=5e-4)
    time = between("retardation_time_s", 5 * setting.interval, 2 * setting.duration, starts=4)

    def own_compliance(values: Values) -> dict:
        compliance = values["compliance_share"] / setting.stiffness
        return {"second_compliance": compliance, "second_time": values["retardation_time_s"]}

    def proportional(values: Values) -> dict:
        return {
            "second_share": values["compliance_share"],
            "second_time": values["retardation_time_s"],
        }

    return [
        Form("proportional", (share, time), proportional),
        Form("own_compliance", (share, time), own_compliance),
    ]


EFFECT = Effect(
    "second_retardation",
    "the joint relaxes on a second, longer time scale",
    "within_trial",
    _build_forms,
)
