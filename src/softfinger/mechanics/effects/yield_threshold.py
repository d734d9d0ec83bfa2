"""A dashpot that flows above a torque.

It flows by the excess (Bingham) or by the whole torque; free: by the excess times any law.

Under one constant load alone a threshold vanishes in c_p. It is tried all the same: beside a wire
whose moment arm changes, say, the joint's torque does not stay what it is.
"""

import math

from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.law import Law, free_form
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.ramp import softplus
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.spring import SLOPE, VALUE
from softfinger.mechanics.forward.work import Model

_YIELD, _WIDTH, _JUMP = declare(
    yield_torque=Slot(
        "joint", "N m", 0.0, "no flow below this torque, the excess above it", "nonnegative"
    ),
    yield_width=Slot("joint", "N m", 1e-3, "torque over which the yield sets in", "positive"),
    yield_jump=Slot(
        "joint", "1", 0.0, "1: above the threshold the whole torque flows", constant=True
    ),
)


@compiled
def hold_below(
    model: Model, j: int, time: float, torque: float, drive: NDArray, row: NDArray
) -> None:
    """The torque y beyond the threshold.

    S(y − τ_y) − S(−y − τ_y) with a soft ramp S.
    """
    threshold, slope, by_limit, by_width = _pass_threshold(
        drive[VALUE], model.joint[j, _YIELD], model.joint[j, _WIDTH], model.joint[j, _JUMP]
    )
    drive[VALUE], drive[SLOPE] = threshold, slope * drive[SLOPE]
    if row.size > 0:
        for c in model.columns[j]:
            change = model.d_joint[c, j]
            own = by_limit * change[_YIELD] + by_width * change[_WIDTH]
            row[c] = slope * row[c] + own


@compiled
def _pass_threshold(
    torque: float, limit: float, width: float, jump: float
) -> tuple[float, float, float, float]:
    """What passes; slopes by torque, threshold, width."""
    if limit == 0.0:
        return torque, 1.0, -math.tanh(torque / (2.0 * width)) * (1.0 - jump), 0.0
    above, rise = softplus(torque - limit, width)
    below, fall = softplus(-torque - limit, width)
    gate = jump * limit
    rise_slope, fall_slope = rise * (1.0 - rise) / width, fall * (1.0 - fall) / width
    drive = above - below + gate * (rise - fall)
    slope = rise + fall + gate * (rise_slope + fall_slope)
    by_limit = fall - rise + jump * (rise - fall) - gate * (rise_slope - fall_slope)
    up, down = (torque - limit) / width, (-torque - limit) / width
    by_width = (above - up * width * rise - below + down * width * fall) / width
    by_width -= gate * (up * rise_slope - down * fall_slope)
    return drive, slope, by_limit, by_width


def _build_form(kind: str, setting: Setting) -> Form:
    threshold = positive(
        "threshold_nm",
        0.5 * setting.torque,
        high=2 * setting.torque,
        floor=1e-3 * setting.torque,
    )

    def slots(values: Values) -> dict:
        return {
            "yield_torque": values["threshold_nm"],
            "yield_width": 0.02 * setting.torque,
            "yield_jump": float(kind == "whole_torque"),
        }

    return Form(kind, (threshold,), slots, local=True)


def _build_forms(setting: Setting) -> list[Form] | str:
    if setting.one_course:
        return "one trial under one load cannot separate a law of the load from another viscosity"
    excess, whole = (_build_form(kind, setting) for kind in ("excess", "whole_torque"))
    reach = 1.2 * float(setting.largest_torque.max())
    law = Law("flow_law", "torque_nm", reach, 1.0, terms=5, kind="exponential")
    return [excess, whole, free_form(law, {"flow_reach": reach}, excess, local=True)]


EFFECT = Effect(
    "yield_threshold",
    "the joint flows only above a torque",
    "within_trial",
    _build_forms,
    hooks=(Hook("flow", hold_below, ("yield_torque",)),),
)
