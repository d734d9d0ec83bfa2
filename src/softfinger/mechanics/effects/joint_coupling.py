"""A joint's deflection that feeds its neighbour's."""

import math

import numpy as np
from numpy.typing import NDArray

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
from softfinger.mechanics.effects.effect import time_constant as between
from softfinger.mechanics.effects.law import Law, free_form
from softfinger.mechanics.forward.curve import combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import LOG_K_V, Q_INI, Slot, declare
from softfinger.mechanics.forward.work import Balance, Model, Nodes

(
    _STIFFNESS,
    _SHARE,
    _SATURATION,
    _COUPLING_LAW,
    _COUPLING_REACH,
    _MEMBRANE,
    _MEMBRANE_SHARE,
    _LAW,
    _REACH,
    _KINEMATIC,
) = declare(
    coupling_stiffness=Slot("coupling", "N m/rad", 0.0, "torque from the other joint's motion"),
    coupling_share=Slot("coupling", "1", 0.0, "the same, as a share of the joint's k_v"),
    coupling_saturation=Slot(
        "coupling", "1/rad", 0.0, "1 / the motion that halves that torque", "nonnegative"
    ),
    coupling_law=Slot(
        "law", "1", 0.0, "torque from this joint's motion x on another: x e^law, a law of |x|"
    ),
    coupling_reach=Slot(
        "joint", "rad", 1.0, "|x| at which that law ends", "positive", constant=True
    ),
    membrane_stiffness=Slot(
        "coupling", "N m/rad", 0.0, "torque K (x_k - x_j), both ways where both are given"
    ),
    membrane_share=Slot("coupling", "1", 0.0, "the same, as a share of sqrt(k_v,j k_v,k)"),
    membrane_law=Slot(
        "law", "1", 0.0, "added to that share between a joint and the next, a law of |x_k - x_j|"
    ),
    membrane_reach=Slot(
        "joint", "rad", 1.0, "|x_k - x_j| at which that law ends", "positive", constant=True
    ),
    coupling_kinematic=Slot("coupling", "1", 0.0, "angle from the other joint's motion"),
)


@compiled
def add_coupling(model: Model, nodes: Nodes, balance: Balance, i: int, tangents: bool) -> None:
    """The torque from the other joints' motion.

    Motion is x = q − q_ini.

    Σ (K + c k_v) x e^{law of |x|} / (1 + b |x|); a membrane adds Σ (M + (m + law) √(k_v k_v,k))
    (x_k − x), its law one of |x_k − x| between neighbours.
    """
    joints = model.joint.shape[0]
    for j in range(joints):
        own = math.exp(model.joint[j, LOG_K_V])
        for k in range(joints):
            share = model.coupling[_SHARE, j, k]
            stiffness = model.coupling[_STIFFNESS, j, k] + share * own
            moved = nodes.angle[i, k] - model.joint[k, Q_INI]
            bent, steep, weights = _bend_coupling(model, j, k, abs(moved))
            slope = stiffness * bent * steep
            balance.torque[i, j] += stiffness * bent * moved
            balance.by_angle[i, j, k] += slope
            if tangents:
                eased = abs(moved) / (1.0 + model.coupling[_SATURATION, j, k] * abs(moved))
                for c in model.columns[j]:
                    change = model.d_coupling[c, _STIFFNESS, j, k]
                    change += own * model.d_coupling[c, _SHARE, j, k]
                    change += share * own * model.d_joint[c, j, LOG_K_V]
                    d_log = combine(model.d_law[c, k, _COUPLING_LAW], weights)
                    d_log -= eased * model.d_coupling[c, _SATURATION, j, k]
                    change = (change + stiffness * d_log) * bent * moved
                    balance.tangent[i, j, c] += change - slope * model.d_joint[c, k, Q_INI]
            if k != j:
                _add_membrane(model, nodes, balance, i, j, k, tangents)


@compiled
def _bend_coupling(model: Model, j: int, k: int, moved: float) -> tuple:
    """What |x| makes of a torque.

    A factor, d log(x factor)/d log x, and the law's weights.
    """
    law, ratio = model.law[k, _COUPLING_LAW], moved / model.joint[k, _COUPLING_REACH]
    weights = weigh_value(ratio)
    ease = 1.0 / (1.0 + model.coupling[_SATURATION, j, k] * moved)
    steep = ease + ratio * combine(law, weigh_slope(ratio))
    return math.exp(combine(law, weights)) * ease, steep, weights


@compiled
def _add_membrane(
    model: Model, nodes: Nodes, balance: Balance, i: int, j: int, k: int, tangents: bool
) -> None:
    """What joint k's relative motion adds to j's torque."""
    mean = math.exp(0.5 * (model.joint[j, LOG_K_V] + model.joint[k, LOG_K_V]))
    apart = nodes.angle[i, k] - model.joint[k, Q_INI] - nodes.angle[i, j] + model.joint[j, Q_INI]
    lower, bend = min(j, k), 0.0
    weights = weigh_value(abs(apart) / model.joint[lower, _REACH])
    share = model.coupling[_MEMBRANE_SHARE, j, k]
    if abs(j - k) == 1:
        law, reach = model.law[lower, _LAW], model.joint[lower, _REACH]
        share += combine(law, weights)
        bend = mean * combine(law, weigh_slope(abs(apart) / reach)) * abs(apart) / reach
    stiffness = model.coupling[_MEMBRANE, j, k] + share * mean
    balance.torque[i, j] += stiffness * apart
    balance.by_angle[i, j, k] += stiffness + bend
    balance.by_angle[i, j, j] -= stiffness + bend
    if tangents:
        for c in model.columns[j]:
            d_share = model.d_coupling[c, _MEMBRANE_SHARE, j, k]
            if abs(j - k) == 1:
                d_share += combine(model.d_law[c, lower, _LAW], weights)
            stiffer = model.d_joint[c, j, LOG_K_V] + model.d_joint[c, k, LOG_K_V]
            change = model.d_coupling[c, _MEMBRANE, j, k] + mean * d_share
            change = (change + 0.5 * share * mean * stiffer) * apart
            turned = model.d_joint[c, j, Q_INI] - model.d_joint[c, k, Q_INI]
            balance.tangent[i, j, c] += change + (stiffness + bend) * turned


@compiled
def turn_neighbours(
    model: Model, angle: NDArray, by: NDArray, seen: NDArray, gradient: NDArray
) -> None:
    """The angle a joint shows besides its own.

    Σ_k K_jk (q_k − q_ini,k).
    """
    joints, frames, columns = gradient.shape
    for j in range(joints):
        for k in range(joints):
            share = model.coupling[_KINEMATIC, j, k]
            for frame in range(frames):
                moved = angle[k, frame] - model.joint[k, Q_INI]
                seen[j, frame] += share * moved
                for c in range(columns):
                    change = share * (by[k, frame, c] - model.d_joint[c, k, Q_INI])
                    change += moved * model.d_coupling[c, _KINEMATIC, j, k]
                    gradient[j, frame, c] += change


def _build_forms(setting: Setting) -> list[Form] | str:
    if setting.joints < 2:
        return "there is only one joint"
    stiffness = float(np.median(setting.stiffness))
    share = signed("coupling", 0.1, per="pair", floor=1e-4)
    mutual = signed("coupling", 0.1, per="neighbours", floor=1e-4)
    reach = setting.reach.max()
    # faster would be a torque that is there at once and then constant: no coupling any more
    saturation = between("saturation_per_rad", 0.1 / reach, 3.0 / reach, starts=1)

    def torque(values: Values) -> dict:
        return {"coupling_stiffness": values["coupling"] * stiffness}

    def own_share(values: Values) -> dict:
        return {"coupling_share": values["coupling"]}

    def kinematic(values: Values) -> dict:
        return {"coupling_kinematic": values["coupling"]}

    def mutual_torque(values: Values) -> dict:
        both = values["coupling"] + values["coupling"].T
        return {"coupling_stiffness": both * stiffness}

    def slackening(values: Values) -> dict:
        return {**mutual_torque(values), "coupling_saturation": values["saturation_per_rad"]}

    both_ways = Form("mutual_torque", (mutual,), mutual_torque)
    law = Law("coupling_law", "neighbour_rad", reach, 0.5, terms=5, kind="exponential")
    return [
        both_ways,
        *_build_membranes(mutual, stiffness, reach),
        Form("slackening_torque", (mutual, saturation), slackening),
        free_form(law, {"coupling_reach": reach}, both_ways, name=f"{FREE}_of_neighbour"),
        Form("torque", (share,), torque),
        Form("share_of_stiffness", (share,), own_share),
        Form("kinematic", (share,), kinematic),
    ]


def _build_membranes(coupling: Parameter, stiffness: float, reach: float) -> list[Form]:
    """Build the forms of a torque by the difference of two motions."""

    def own(values: Values) -> dict:
        return {"membrane_stiffness": (values["coupling"] + values["coupling"].T) * stiffness}

    def share(values: Values) -> dict:
        return {"membrane_share": values["coupling"] + values["coupling"].T}

    law = Law("membrane_law", "difference_rad", reach, 0.1, terms=5, per="neighbours", kind="sum")
    in_share = Form("membrane_share", (coupling,), share)
    free = free_form(law, {"membrane_reach": reach}, in_share)
    return [Form("membrane", (coupling,), own), in_share, free]


EFFECT = Effect(
    "joint_coupling",
    "one joint's deflection feeds its neighbour's",
    "within_trial",
    _build_forms,
    "second joint",
    hooks=(
        Hook(
            "balance",
            add_coupling,
            (
                "coupling_stiffness",
                "coupling_share",
                "coupling_law",
                "membrane_stiffness",
                "membrane_share",
                "membrane_law",
            ),
            mixes=True,
        ),
        Hook("observe", turn_neighbours, ("coupling_kinematic",)),
    ),
)
