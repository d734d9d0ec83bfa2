"""Viscosities or stiffness that follow a covariate.

It is logged: log c = log c₀ − s (x − x̄), or free.
"""

import numpy as np

from softfinger.mechanics.effects.effect import FREE, Effect, Form, Setting, Values, signed
from softfinger.mechanics.effects.law import Law

LEAST_TRIALS = 4
TARGETS = {
    "viscosities": ("log_c_v", "log_c_p"),
    "flow_viscosity": ("log_c_p",),
    "retardation_viscosity": ("log_c_v",),
    "stiffness": ("log_k_v",),
    "everything": ("log_k_v", "log_c_v", "log_c_p"),
}


def _build_form(name: str, target: str, setting: Setting) -> Form:
    centred = setting.covariates[name] - setting.covariates[name].mean()
    unit = name.rsplit("_", 1)[-1]
    slope = signed(
        f"sensitivity_per_{unit}",
        0.3 / centred.std(),
        floor=1e-4 / centred.std(),
    )

    def slots(values: Values) -> dict:
        shift = -values[slope.name] * centred[:, None] * np.ones(setting.joints)
        return dict.fromkeys(TARGETS[target], shift)

    return Form(f"{target}_with_{name}", (slope,), slots, covariate=name, local=True)


def _build_free_form(name: str, target: str, setting: Setting) -> Form:
    covariate = setting.covariates[name]
    law = Law(name, name, float(np.ptp(covariate)), 0.3, terms=4, kind="exponential")

    def slots(values: Values) -> dict:
        shift = law.evaluate(values, covariate - covariate.min())
        return dict.fromkeys(TARGETS[target], shift[:, None] * np.ones(setting.joints))

    more = {"covariate": name, "law": law, "linear": True}
    return Form(f"{FREE}_{target}_with_{name}", law.parameters, slots, **more)


def _build_forms(setting: Setting) -> list[Form] | str:
    moving = [name for name, x in setting.covariates.items() if np.ptp(x) > 0 and name != "session"]
    if not moving:
        return "no covariate was logged, or none changed"
    if setting.trials < LEAST_TRIALS:
        return "a dependence on a covariate needs several trials"
    builders = (_build_form, _build_free_form)
    return [
        build(name, target, setting) for build in builders for name in moving for target in TARGETS
    ]


EFFECT = Effect(
    "temperature",
    "viscosity or stiffness follows a logged covariate",
    "between_trials",
    _build_forms,
)
