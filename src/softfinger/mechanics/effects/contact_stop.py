"""A stop beyond an angle: hard, soft, Hertzian or free."""

import numpy as np

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import Effect, Form, Parameter, Setting, Values, positive
from softfinger.mechanics.effects.law import Law, free_form
from softfinger.mechanics.forward.curve import combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.ramp import softplus
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.work import Balance, Model, Nodes

WIDTHS_RAD = {"hard": 0.01, "soft": 0.05, "hertzian": 0.002}
HERTZ = 1.5  # torque against depth, of a sphere on a plane (Hertz 1881)


_ANGLE, _STIFFNESS, _WIDTH, _POWER, _LAW, _REACH = declare(
    stop_angle=Slot("joint", "rad", 1.0, "joint angle at which a stop is met"),
    stop_stiffness=Slot("joint", "N m/rad", 0.0, "stiffness of the stop", "nonnegative"),
    stop_width=Slot(
        "joint", "rad", 1e-3, "angle over which the contact sets in", "positive", constant=True
    ),
    stop_power=Slot(
        "joint",
        "1",
        1.0,
        "power of the depth that the torque grows with",
        "positive",
        constant=True,
    ),
    stop_law=Slot("law", "1", 0.0, "stiffness of the stop (1 + law), a law of the depth"),
    stop_reach=Slot("joint", "rad", 1.0, "depth at which that law ends", "positive", constant=True),
)


@compiled
def add_stop(model: Model, nodes: Nodes, balance: Balance, i: int, tangents: bool) -> None:
    """The stop's torque.

    It is −K depth (depth/reach)^(power − 1) (1 + law of the depth).

    The depth is the angle beyond the stop, softly rectified. K is the secant stiffness at a
    depth of `stop_reach`.
    """
    for j in range(model.joint.shape[0]):
        stiffness = model.joint[j, _STIFFNESS]
        beyond = nodes.angle[i, j] - model.joint[j, _ANGLE]
        depth, touch = softplus(beyond, model.joint[j, _WIDTH])
        reach, law = model.joint[j, _REACH], model.law[j, _LAW]
        power = model.joint[j, _POWER]
        grown = 1.0 if power == 1.0 else (depth / reach) ** (power - 1.0)
        value = 1.0 + combine(law, weigh_value(depth / reach))
        slope = combine(law, weigh_slope(depth / reach)) / reach
        harder, steep = grown * value, grown * (power * value + depth * slope)
        balance.torque[i, j] -= stiffness * depth * harder
        balance.by_angle[i, j, j] -= stiffness * touch * steep
        if tangents:
            for c in model.columns[j]:
                by_law = grown * combine(model.d_law[c, j, _LAW], weigh_value(depth / reach))
                balance.tangent[i, j, c] += (
                    stiffness * touch * steep * model.d_joint[c, j, _ANGLE]
                    - depth * harder * model.d_joint[c, j, _STIFFNESS]
                    - stiffness * depth * by_law
                )


def _build_form(kind: str, setting: Setting) -> Form:
    stiffness = float(np.median(setting.stiffness))
    spring = positive(
        "stop_stiffness_nm_per_rad",
        5 * stiffness,
        per="joint",
        floor=2e-3 * stiffness,
    )
    place = Parameter(
        "stop_share_of_reach",
        0.6,
        0.3,
        per="joint",
        low=0.05,
        high=1.0,
        starts=(0.3, 0.6, 0.8, 0.92),
        report={"stop_angle_rad": lambda share, joint: share * setting.reach[joint]},
    )

    def slots(values: Values) -> dict:
        return {
            "stop_stiffness": values["stop_stiffness_nm_per_rad"],
            "stop_angle": values["stop_share_of_reach"] * setting.reach,
            "stop_width": WIDTHS_RAD[kind],
            "stop_power": HERTZ if kind == "hertzian" else 1.0,
            "stop_reach": setting.reach,
        }

    return Form(kind, (spring, place), slots)


def _build_forms(setting: Setting) -> list[Form]:
    forms = {kind: _build_form(kind, setting) for kind in WIDTHS_RAD}
    law = Law("stop_law", "depth_rad", setting.reach, 0.7, terms=6, per="joint")
    return [*forms.values(), free_form(law, {}, forms["soft"])]


EFFECT = Effect(
    "contact_stop",
    "the joint meets a stop",
    "within_trial",
    _build_forms,
    hooks=(Hook("balance", add_stop, ("stop_stiffness",)),),
    of_motion=True,
)
