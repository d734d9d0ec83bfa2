"""Mass that the step solution ignores.

It is of the declared links, or of even links of unknown mass.

Where nothing is declared the unit of inertia is that with which a joint of usual stiffness would
swing once in ten frames.
"""

import numpy as np

from softfinger.compiled import compiled
from softfinger.mechanics.chain import fill_inertia_and_nonlinear_term, fill_slopes
from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.work import Balance, Model, Nodes

(_SCALE,) = declare(
    inertia_scale=Slot(
        "chain", "1", 0.0, "inertia of the links; 1 = the declared masses", needs=("inertia",)
    ),
)


@compiled
def add_inertia(model: Model, nodes: Nodes, balance: Balance, i: int, tangents: bool) -> None:
    """What acceleration takes: −scale (M(q) q̈ + h(q, q̇))."""
    joints = model.joint.shape[0]
    scale = model.chain[_SCALE]
    matrix, term = np.empty((joints, joints)), np.empty(joints)
    by_angle, by_velocity = np.empty((joints, joints)), np.empty((joints, joints))
    angle, velocity, acceleration = nodes.angle[i], nodes.velocity[i], nodes.acceleration[i]
    fill_inertia_and_nonlinear_term(angle, velocity, model.inertia, matrix, term)
    fill_slopes(angle, velocity, acceleration, model.inertia, by_angle, by_velocity)
    for j in range(joints):
        taken = term[j]
        for k in range(joints):
            taken += matrix[j, k] * acceleration[k]
            balance.by_angle[i, j, k] -= scale * by_angle[j, k]
            balance.by_velocity[i, j, k] -= scale * by_velocity[j, k]
            balance.by_acceleration[i, j, k] -= scale * matrix[j, k]
        balance.torque[i, j] -= scale * taken
        if tangents:
            for c in model.columns[j]:
                balance.tangent[i, j, c] -= taken * model.d_chain[c, _SCALE]


def _build_forms(setting: Setting) -> list[Form]:
    declared = positive("inertia_scale", 5.0, floor=2e-3)  # tubes and wires weigh too
    unknown = positive("inertia_in_units_of_ten_frames", 3.0, floor=5e-4)

    def slots(values: Values) -> dict:
        return {"inertia_scale": next(iter(values.values()))}

    if setting.masses:
        return [Form("declared_masses", (declared,), slots)]
    return [Form("even_links", (unknown,), slots)]


EFFECT = Effect(
    "inertia",
    "the links have mass",
    "within_trial",
    _build_forms,
    hooks=(Hook("balance", add_inertia, ("inertia_scale",), mixes=True, inertial=True),),
)
