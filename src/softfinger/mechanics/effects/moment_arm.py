"""The wire's geometry.

The moment arm grows with the angle, as r sin(q/2 + a) or otherwise.
"""

import math
from dataclasses import replace

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.law import EACH, Law, free_form
from softfinger.mechanics.forward.curve import combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.work import Balance, Model, Nodes

_SCALE, _LAW, _REACH = declare(
    arm_scale=Slot(
        "joint", "1", 0.0, "change of the moment arm with the angle; 1 = the paper's",
        needs=("arm_ratio",),
    ),
    arm_law=Slot("law", "1", 0.0, "added to the factor on the moment arm, a law of q"),
    arm_reach=Slot(
        "joint", "rad", 1.0, "joint angle at which that law ends", "positive", constant=True
    ),
)  # fmt: skip


@compiled
def grow_arm(model: Model, nodes: Nodes, balance: Balance, i: int, tangents: bool) -> None:
    """The pull times the growth of its arm.

    1 + arm_scale (cos(q/2) + l/(2d) sin(q/2) − 1) + law of q
    """
    ratio = 0.0 if math.isnan(model.arm_ratio) else model.arm_ratio  # for the law alone
    for j in range(model.joint.shape[0]):
        half, x = nodes.angle[i, j] / 2, nodes.angle[i, j] / model.joint[j, _REACH]
        growth = math.cos(half) + ratio * math.sin(half) - 1.0
        steep = (ratio * math.cos(half) - math.sin(half)) / 2
        scale, law = model.joint[j, _SCALE], model.law[j, _LAW]
        arm = 1.0 + scale * growth + combine(law, weigh_value(x))
        slope = scale * steep + combine(law, weigh_slope(x)) / model.joint[j, _REACH]
        pull = balance.torque[i, j]
        balance.torque[i, j] *= arm
        balance.by_load[i, j] *= arm
        balance.by_direction[i, j] *= arm
        for k in range(model.joint.shape[0]):
            balance.by_angle[i, j, k] *= arm
        balance.by_angle[i, j, j] += pull * slope
        if tangents:
            for c in model.columns[j]:
                longer = growth * model.d_joint[c, j, _SCALE]
                longer += combine(model.d_law[c, j, _LAW], weigh_value(x))
                balance.tangent[i, j, c] = arm * balance.tangent[i, j, c] + pull * longer


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.tension:
        return "the load is not a wire tension"
    reach = float(setting.reach.max())
    law = Law("arm_law", "joint_angle_rad", reach, 0.5)
    free = [free_form(law, {"arm_reach": reach})]
    if setting.joints > 1:
        free.append(free_form(replace(law, per="joint"), {"arm_reach": reach}, name=EACH))
    if not setting.geometry:
        return free
    arm = positive("arm_scale", 1.0, floor=5e-3)

    def slots(values: Values) -> dict:
        return {"arm_scale": values["arm_scale"]}

    return [Form("paper_geometry", (arm,), slots), *free]


EFFECT = Effect(
    "moment_arm",
    "the wire's moment arm changes with the angle",
    "within_trial",
    _build_forms,
    "wire",
    hooks=(Hook("pull", grow_arm, ("arm_scale", "arm_law")),),
)
