"""Creep rate more than proportional to torque: Eyring's sinh, a power or a free law.

The sinh is fitted by the square of 1/scale torque, in which a small one is linear. Under one
constant load alone any law of flow vanishes in c_p, yet not beside a torque that changes.

Eyring (1936), J. Chem. Phys. 4, 283.
"""

from dataclasses import replace

import numpy as np

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.law import Law, free_form


def _build_forms(setting: Setting) -> list[Form]:
    square = positive("inverse_scale_torque_squared_per_nm2", (2 / setting.torque) ** 2)
    bend = replace(
        square,
        low=1e-6 * square.sd,
        floor=(0.02 / setting.torque) ** 2,
        report={"scale_torque_nm": lambda x, _: max(x, 1e-6 * square.sd) ** -0.5},
    )
    power = positive("extra_power", 1.0, floor=1e-3)

    def sinh(values: Values) -> dict:
        return {"flow_sinh": np.sqrt(np.maximum(values[bend.name], bend.low))}

    def power_law(values: Values) -> dict:
        return {"flow_power": values["extra_power"], "flow_reference": setting.torque}

    reach = 1.2 * float(setting.largest_torque.max())
    law = Law("flow_law", "torque_nm", reach, 1.0, terms=5, kind="exponential")
    return [
        Form("sinh", (bend,), sinh, local=True),
        Form("power", (power,), power_law, local=True),
        free_form(law, {"flow_reach": reach}, local=True),
    ]


EFFECT = Effect(
    "stress_nonlinear_flow",
    "the joint creeps more than in proportion to the torque",
    "within_trial",
    _build_forms,
)
