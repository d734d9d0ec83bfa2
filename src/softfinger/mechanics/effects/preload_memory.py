"""A joint not yet at rest.

When the trial starts, an elastic angle is still relaxing.

Constant (a share of the elastic angle of a usual load), or what the trial before has left after the
rest between them: of a usual elastic angle, of that trial's, or of what the trial's own load gives
at its own stiffness, which is then part of the angle at the start as well.
"""

import math
from dataclasses import replace

import numpy as np

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import (
    Effect,
    Form,
    Setting,
    Values,
    signed,
    time_constant,
)
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.modes import VOIGT
from softfinger.mechanics.forward.slot import LOG_K_V, Slot, declare
from softfinger.mechanics.forward.work import Model, Work

REMAINS = 0.01  # of the usual elastic angle: what a trial before must leave to be remembered


_ANGLE, _TORQUE = declare(
    initial_angle=Slot("joint", "rad", 0.0, "elastic angle that has not yet relaxed at the start"),
    initial_torque=Slot(
        "joint", "N m", 0.0, "torque whose elastic angle is still there at the start, on q_ini"
    ),
)


@compiled
def remember(model: Model, work: Work, j: int) -> None:
    """What the Voigt element still has of before.

    An angle is part of q_ini, what a torque has left is on it.
    """
    state, soft = work.state, math.exp(-model.joint[j, LOG_K_V])
    angle, torque = model.joint[j, _ANGLE], model.joint[j, _TORQUE]
    state.offset[j] -= angle
    state.mode[j, VOIGT] += angle + torque * soft
    for c in model.columns[j]:
        change = model.d_joint[c, j]
        d_held = (change[_TORQUE] - torque * change[LOG_K_V]) * soft
        state.d_offset[j, c] -= change[_ANGLE]
        state.d_mode[j, VOIGT, c] += change[_ANGLE] + d_held


def _build_forms(setting: Setting) -> list[Form]:
    share = signed("residual_strain_share", 0.1, per="joint", floor=1e-4)
    common = replace(share, per="chain")
    usual = setting.torque / setting.stiffness
    before = setting.memory

    def constant(values: Values) -> dict:
        return {"initial_angle": values["residual_strain_share"] * usual}

    def kept(values: Values) -> dict:
        return {"initial_angle": values["residual_strain_share"] * before}

    def fade(values: Values) -> np.ndarray:
        return np.exp(-setting.rest_time / float(values["memory_time_s"]))[:, None]

    def fading(values: Values) -> dict:
        return {"initial_angle": values["residual_strain_share"] * before * fade(values)}

    def fading_usual(values: Values) -> dict:
        return {"initial_angle": values["residual_strain_share"] * usual * fade(values)}

    def fading_own(values: Values) -> dict:
        load = setting.largest_torque[:, None] * np.ones(setting.joints)
        return {"initial_torque": values["residual_strain_share"] * load * fade(values)}

    forms = [Form("same_in_all_joints", (common,), constant), Form("constant", (share,), constant)]
    remembered = setting.trials > 1 and bool(np.any(np.abs(before) > REMAINS * usual))
    if remembered:
        forms.append(Form("kept_from_trial_before", (share,), kept))
    rest = setting.rest_time[1:]
    if rest.size > 1 and np.isfinite(rest).all() and np.ptp(rest) > 0:
        longest = 5 * max(rest.max(), setting.duration)
        memory = time_constant("memory_time_s", setting.duration / 10, longest, starts=2)
        forms.append(Form("usual_fading_with_rest", (share, memory), fading_usual))
        forms.append(Form("own_fading_with_rest", (share, memory), fading_own))
        if remembered:
            forms.append(Form("fading_with_rest", (share, memory), fading))
    return forms


EFFECT = Effect(
    "preload_memory",
    "the joint is not yet at rest when the trial starts",
    "within_trial",
    _build_forms,
    hooks=(Hook("rest", remember, ("initial_angle", "initial_torque")),),
)
