"""Creep that outgrows its torque.

Its rate is Eyring's sinh, a power or a free law.

The sinh is fitted by the square of 1/scale torque, in which a small one is linear. Under one
constant load alone any law of flow vanishes in c_p, yet not beside a torque that changes.

Eyring (1936), J. Chem. Phys. 4, 283.
"""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.law import Law, free_form
from softfinger.mechanics.forward.curve import combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.spring import SLOPE, VALUE
from softfinger.mechanics.forward.work import Model

_SINH, _POWER, _REFERENCE, _LAW, _REACH = declare(
    flow_sinh=Slot("joint", "1/(N m)", 0.0, "flow ∝ sinh(b τ)/b; b = 1/scale torque"),
    flow_power=Slot("joint", "1", 0.0, "flow ∝ τ |τ/reference|^b", "nonnegative"),
    flow_reference=Slot(
        "joint", "N m", 1.0, "reference torque of the power", "positive", constant=True
    ),
    flow_law=Slot("law", "1", 0.0, "flow ∝ τ exp(law), a law of |τ|"),
    flow_reach=Slot("joint", "N m", 1.0, "|τ| at which that law ends", "positive", constant=True),
)


@compiled
def bend_flow(
    model: Model, j: int, time: float, torque: float, drive: NDArray, row: NDArray
) -> None:
    """The flow of a torque y.

    x |x/reference|^b with x = sinh(b y)/b, times exp(law of |τ|).
    """
    value, law = model.joint[j], model.law[j, _LAW]
    sheared, steep, by_b = _shear(value[_SINH], drive[VALUE])
    power, ratio = value[_POWER], abs(sheared) / value[_REFERENCE]
    factor = ratio**power if ratio > 0.0 or power == 0.0 else 0.0
    x = abs(torque) / value[_REACH]
    weights = weigh_value(x)
    thin = math.exp(combine(law, weights))
    climb = combine(law, weigh_slope(x)) * math.copysign(1.0 / value[_REACH], torque)
    chain = (1.0 + power) * factor * thin
    drive[VALUE] = sheared * factor * thin
    drive[SLOPE] = chain * steep * drive[SLOPE] + drive[VALUE] * climb
    if row.size > 0:
        by_power = drive[VALUE] * math.log(ratio) if ratio > 0.0 else 0.0
        for c in model.columns[j]:
            change = model.d_joint[c, j]
            own = chain * by_b * change[_SINH] + by_power * change[_POWER]
            own += drive[VALUE] * combine(model.d_law[c, j, _LAW], weights)
            row[c] = chain * steep * row[c] + own


@compiled
def _shear(b: float, torque: float) -> tuple[float, float, float]:
    """sinh(b y)/b, its slope, and its derivative by b."""
    bent = b * torque
    if abs(bent) < 1e-3:  # by its series: exact to rounding, and regular at b = 0
        square = bent * bent
        sheared = torque * (1.0 + square / 6.0 * (1.0 + square / 20.0))
        steep = 1.0 + square / 2.0 * (1.0 + square / 12.0)
        return sheared, steep, torque * torque * bent / 3.0 * (1.0 + square / 10.0)
    sheared, steep = math.sinh(bent) / b, math.cosh(bent)
    return sheared, steep, (torque * steep - sheared) / b


def _build_forms(setting: Setting) -> list[Form] | str:
    if setting.one_course:
        return "one trial under one load cannot separate a law of the load from another viscosity"
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
    hooks=(Hook("flow", bend_flow, ("flow_sinh", "flow_power", "flow_law")),),
)
