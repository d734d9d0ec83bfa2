"""A plane that is not horizontal.

Its torque depends on the configuration.

Free: what the links weigh beyond each joint is not what their masses say, as with a payload.
"""

import math
from dataclasses import replace

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import (
    FREE,
    Effect,
    Form,
    Parameter,
    Setting,
    Values,
    signed,
)
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.work import Balance, Model, Nodes

GRAVITY = 9.80665  # [m/s²]
_ALONG, _ACROSS, _MOMENT = declare(
    tilt_along=Slot(
        "chain", "rad", 0.0, "tilt of the plane: gravity towards the tip", needs=("moment",)
    ),
    tilt_across=Slot(
        "chain", "rad", 0.0, "tilt of the plane: gravity counter-clockwise", needs=("moment",)
    ),
    moment_share=Slot("joint", "1", 0.0, "first moment of a link and what it carries: (1 + b)"),
)


@compiled
def add_weight(model: Model, nodes: Nodes, balance: Balance, i: int, tangents: bool) -> None:
    """The weight of the links beyond each joint.

    Σ g μ_k (−sin α sin θ_k + sin β cos θ_k), where μ_k are the first moments of the declared
    masses, times 1 + moment_share.
    """
    along, across = math.sin(model.chain[_ALONG]), math.sin(model.chain[_ACROSS])
    turn_along, turn_across = math.cos(model.chain[_ALONG]), math.cos(model.chain[_ACROSS])
    direction = 0.0
    for k in range(model.joint.shape[0]):
        direction += nodes.angle[i, k]
        unit = GRAVITY * model.moment[k]
        weight = unit * (1.0 + model.joint[k, _MOMENT])
        push = unit * (across * math.cos(direction) - along * math.sin(direction))
        sine, cosine = weight * math.sin(direction), weight * math.cos(direction)
        for j in range(k + 1):
            balance.torque[i, j] += across * cosine - along * sine
            for other in range(k + 1):
                balance.by_angle[i, j, other] -= across * sine + along * cosine
            if tangents:
                for c in model.columns[j]:
                    balance.tangent[i, j, c] += (
                        push * model.d_joint[c, k, _MOMENT]
                        + turn_across * cosine * model.d_chain[c, _ACROSS]
                        - turn_along * sine * model.d_chain[c, _ALONG]
                    )


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.masses:
        return "link masses and lengths are not declared"
    along = signed("tilt_along_rad", 0.2, low=-1.6, high=1.6, floor=2e-4)
    across = signed("tilt_across_rad", 0.2, low=-1.6, high=1.6, floor=2e-4)

    def slots(values: Values) -> dict:
        return {name.removesuffix("_rad"): value for name, value in values.items()}

    def alone(tilt: Parameter) -> tuple[Parameter]:
        """Give the plane's angle, beside how it tilts."""
        return (replace(tilt, report={"tilt_rad": lambda x, _: abs(x), tilt.name: lambda x, _: x}),)

    ratio = Parameter("moment_ratio", 0.0, 0.7, per="joint", log=True, low=-2.0, high=2.5)

    def loaded(values: Values) -> dict:
        tilt = {f"tilt_{way}": values[f"tilt_{way}_rad"] for way in ("across", "along")}
        return {**tilt, "moment_share": values["moment_ratio"] - 1.0}

    return [
        Form("across", alone(across), slots),
        Form("along", alone(along), slots),
        Form("both", (across, along), slots),
        Form(FREE, (across, along, ratio), loaded),
    ]


EFFECT = Effect(
    "gravity",
    "gravity pulls: the plane is tilted",
    "within_trial",
    _build_forms,
    "plane",
    hooks=(Hook("balance", add_weight, ("tilt_along", "tilt_across"), mixes=True),),
)
