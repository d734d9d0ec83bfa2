"""A joint that snaps into places: a torque −a sin(2π q/pitch) beside its spring."""

import math
from collections.abc import Mapping

from softfinger.api import Effect, Form, Setting, signed, time_constant
from softfinger.compiled import compiled
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.work import Balance, Model, Nodes

_TORQUE, _PITCH = declare(
    detent_torque=Slot("joint", "N m", 0.0, "largest torque of the places"),
    detent_pitch=Slot("joint", "rad", 1.0, "angle from place to place", "positive"),
)


@compiled
def add_detent(model: Model, nodes: Nodes, balance: Balance, i: int, tangents: bool) -> None:
    """The torque, its slope by the angle, and its changes along the columns."""
    for j in range(model.joint.shape[0]):
        height, pitch = model.joint[j, _TORQUE], model.joint[j, _PITCH]
        turn = 2.0 * math.pi * nodes.angle[i, j] / pitch
        sine, slope = math.sin(turn), height * math.cos(turn) * 2.0 * math.pi / pitch
        balance.torque[i, j] -= height * sine
        balance.by_angle[i, j, j] -= slope
        if tangents:
            for c in model.columns[j]:
                change = model.d_joint[c, j]
                wider = slope * nodes.angle[i, j] / pitch * change[_PITCH]
                balance.tangent[i, j, c] += wider - sine * change[_TORQUE]


def _build_forms(setting: Setting) -> list[Form]:
    torque = signed("detent_torque_nm", 0.1 * setting.torque, floor=1e-3 * setting.torque)
    pitch = time_constant("detent_pitch_rad", 0.05, 1.0)  # log-normal between two values

    def slots(values: Mapping) -> dict:
        return {
            "detent_torque": values["detent_torque_nm"],
            "detent_pitch": values["detent_pitch_rad"],
        }

    return [Form("sine", (torque, pitch), slots)]


EFFECT = Effect(
    "detent",
    "the joint snaps into places",
    "within_trial",
    _build_forms,
    hooks=(Hook("balance", add_detent, ("detent_torque",)),),
)
