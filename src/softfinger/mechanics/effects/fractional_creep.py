"""Power-law creep: a springpot, creep ∝ t^a / Γ(1 + a), beside or instead of the dashpot c_p.

Bagley, Torvik (1983), J. Rheol. 27, 201.
"""

from math import gamma

import numpy as np

from softfinger.mechanics.effects.effect import Effect, Form, Parameter, Setting, Values, positive

LEAST_LOSS = 1e-4  # an exponent of exactly 1 is the dashpot and no springpot


def _build_forms(setting: Setting) -> list[Form]:
    middle = np.sqrt(setting.interval * setting.duration)  # where share and exponent are untied
    exponent = Parameter("exponent", 0.5, 0.2, low=0.05, high=0.95, starts=(0.25, 0.5, 0.75))
    share = positive("springpot_share", 0.3, per="joint", floor=5e-4)
    bent = Parameter(
        "exponent_loss", 0.0, 0.3, low=0.0, high=0.9, amplitude=True, floor=1e-3, starts=(0.003,),
        report={"exponent": lambda loss, _: 1.0 - loss},
    )  # fmt: skip

    def scale(values: Values) -> float:
        a = float(values["exponent"])
        return gamma(1 + a) * middle**-a

    def beside(values: Values) -> dict:
        return {
            "springpot_elastic_share": values["springpot_share"] * scale(values),
            "springpot_exponent": values["exponent"],
        }

    def own_compliance(values: Values) -> dict:
        return {
            "springpot_compliance": values["springpot_share"] / setting.stiffness * scale(values),
            "springpot_exponent": values["exponent"],
        }

    def instead(values: Values) -> dict:
        a = 1.0 - max(float(values["exponent_loss"]), LEAST_LOSS)
        rate = gamma(1 + a) * (setting.duration / 2) ** (1 - a)
        return {"flow_share": 0.0, "springpot_flow_share": rate, "springpot_exponent": a}

    return [
        Form("beside", (share, exponent), beside),
        Form("own_compliance", (share, exponent), own_compliance),
        Form("instead_of_dashpot", (bent,), instead),
    ]


EFFECT = Effect(
    "fractional_creep",
    "creep follows a power of time instead of discrete times",
    "within_trial",
    _build_forms,
)
