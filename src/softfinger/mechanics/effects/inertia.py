"""Mass that the step solution ignores.

It is of the declared links, or of even links of unknown mass.

Where nothing is declared the unit of inertia is that with which a joint of usual stiffness would
swing once in ten frames.

Free: the masses lie elsewhere than declared, or are others, as with a payload. Of a chain only the
inertia of each link about its joint, and the first moment of each link and what it carries, can be
seen. What no masses make has no motion.
"""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.chain import fill_inertia_and_nonlinear_term, fill_slopes
from softfinger.mechanics.effects.effect import (
    FREE,
    Effect,
    Form,
    Parameter,
    Setting,
    Values,
    positive,
)
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.work import Balance, Model, Nodes, Work

_SCALE, _OWN, _CARRIED = declare(
    inertia_scale=Slot(
        "chain", "1", 0.0, "inertia of the links; 1 = the declared masses", needs=("inertia",)
    ),
    inertia_own_share=Slot("joint", "1", 0.0, "that of a link about its joint: (1 + b)"),
    inertia_moment_share=Slot("joint", "1", 0.0, "first moment of a link and its load: (1 + b)"),
)


@compiled
def add_inertia(model: Model, nodes: Nodes, balance: Balance, i: int, tangents: bool) -> None:
    """What acceleration takes: −scale (M(q) q̈ + h(q, q̇))."""
    joints = model.joint.shape[0]
    scale, taken = model.chain[_SCALE], balance.taken
    coefficients, matrix, by_angle, by_velocity = balance.inertia
    angle, velocity, acceleration = nodes.angle[i], nodes.velocity[i], nodes.acceleration[i]
    _fill_coefficients(model, coefficients)
    _take(angle, velocity, acceleration, coefficients, matrix, taken)
    fill_slopes(angle, velocity, acceleration, coefficients, by_angle, by_velocity)
    for j in range(joints):
        for k in range(joints):
            balance.by_angle[i, j, k] -= scale * by_angle[j, k]
            balance.by_velocity[i, j, k] -= scale * by_velocity[j, k]
            balance.by_acceleration[i, j, k] -= scale * matrix[j, k]
        balance.torque[i, j] -= scale * taken[j]
        if tangents:
            for c in model.columns[j]:
                balance.tangent[i, j, c] -= taken[j] * model.d_chain[c, _SCALE]
    if tangents:
        for c in range(model.d_joint.shape[0]):
            if not (model.d_joint[c, :, _OWN].any() or model.d_joint[c, :, _CARRIED].any()):
                continue
            for j in range(joints):
                for k in range(joints):
                    change = model.d_joint[c, max(j, k), _OWN if j == k else _CARRIED]
                    coefficients[j, k] = model.inertia[j, k] * change
            _take(angle, velocity, acceleration, coefficients, matrix, taken)
            for j in range(joints):
                balance.tangent[i, j, c] -= scale * taken[j]


@compiled
def _fill_coefficients(model: Model, coefficients: NDArray) -> None:
    """Write the kinetic energy's constants, in units of the scale."""
    for j in range(model.joint.shape[0]):
        for k in range(model.joint.shape[0]):
            share = model.joint[j, _OWN] if j == k else model.joint[max(j, k), _CARRIED]
            coefficients[j, k] = model.inertia[j, k] * (1.0 + share)


@compiled
def refuse_impossible_masses(model: Model, work: Work, j: int) -> None:
    """Give links that no masses make no state.

    Their kinetic energy could fall below 0, and their motion would end within a moment. It cannot,
    in any posture, where the constants' matrix is positive definite (Schur's product theorem).
    """
    matrix = work.balance.inertia[0]
    _fill_coefficients(model, matrix)
    for a in range(j + 1):  # Cholesky's factor, as far as joint j
        for b in range(a + 1):
            for k in range(b):
                matrix[a, b] -= matrix[a, k] * matrix[b, k]
            if b < a:
                matrix[a, b] /= matrix[b, b]
            elif matrix[a, a] > 0.0:
                matrix[a, a] = math.sqrt(matrix[a, a])
            else:
                work.state.offset[j] = np.nan
                return


@compiled
def _take(
    angle: NDArray, velocity: NDArray, acceleration: NDArray, coefficients: NDArray,
    matrix: NDArray, taken: NDArray,
) -> None:  # fmt: skip
    """M(q), and what the motion takes: M(q) q̈ + h(q, q̇)."""
    fill_inertia_and_nonlinear_term(angle, velocity, coefficients, matrix, taken)
    for j in range(taken.size):
        for k in range(taken.size):
            taken[j] += matrix[j, k] * acceleration[k]


def _build_forms(setting: Setting) -> list[Form]:
    declared = positive("inertia_scale", 5.0, floor=2e-3)  # tubes and wires weigh too
    unknown = positive("inertia_in_units_of_ten_frames", 3.0, floor=5e-4)

    def slots(values: Values) -> dict:
        return {"inertia_scale": next(iter(values.values()))}

    def elsewhere(values: Values) -> dict:
        shares = {f"inertia_{of}_share": values[f"{of}_ratio"] - 1.0 for of in ("own", "moment")}
        return {"inertia_scale": values["inertia_scale"], **shares}

    # by the declared masses, as far as the scale leaves them; the first link's moment has no part
    own = Parameter("own_ratio", 0.0, 0.7, per="joint", log=True, low=-2.0, high=2.5)
    moment = replace(own, name="moment_ratio")
    if setting.masses:
        free = Form(FREE, (declared, own, moment), elsewhere)
        return [Form("declared_masses", (declared,), slots), free]
    return [Form("even_links", (unknown,), slots)]


EFFECT = Effect(
    "inertia",
    "the links have mass",
    "within_trial",
    _build_forms,
    hooks=(
        Hook("balance", add_inertia, ("inertia_scale",), mixes=True, inertial=True),
        Hook("rest", refuse_impossible_masses, ("inertia_own_share", "inertia_moment_share")),
    ),
)
