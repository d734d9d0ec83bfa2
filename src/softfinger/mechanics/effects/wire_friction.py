"""Friction along the wire.

Distal joints get less, and loading differs from unloading.

The wire slides past a joint by what that joint and those beyond it bend: where it passes the tip's
joint it may still be pulled while it is let go at the base.

Capstan over the bend (tension · exp(−μ · bend)) up to the middle of the joint that is pulled, or
over all that the wire wraps, whole bends and guides; a constant loss for each joint passed, or a
Coulomb force. Free: each joint that is passed adds its guides and any law of its own bend. The
direction turns over a small motion of the wire (Dahl) or with the load.

Dahl (1968), Aerospace Corp. TOR-0158(3107-18)-1.
"""

import math
from dataclasses import replace

import numpy as np

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import (
    Effect,
    Form,
    Parameter,
    Setting,
    Values,
    positive,
)
from softfinger.mechanics.effects.law import Law, free_form
from softfinger.mechanics.forward.curve import combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.work import START, Balance, Model, Nodes, Work

_BEND, _CONSTANT, _FORCE, _LAW, _REACH, _WIDTH, _DRIVER, _OWN = declare(
    friction_bend=Slot("chain", "1/rad", 0.0, "capstan exponent for each radian of bend"),
    friction_constant=Slot("chain", "1", 0.0, "capstan exponent for each joint passed"),
    friction_force=Slot("chain", "N m", 0.0, "Coulomb loss for each joint passed"),
    friction_law=Slot(
        "law", "1", 0.0, "added to the capstan exponent by each joint passed, a law of its bend"
    ),
    friction_reach=Slot(
        "chain", "rad", 1.0, "bend at which that law ends", "positive", constant=True
    ),
    friction_width=Slot(
        "chain", "rad or N m", 0.05, "motion (driver 1) or load (driver 0) that turns the friction",
        "positive",
    ),
    friction_driver=Slot(
        "chain", "1", 1.0, "friction turns with the wire's slide at each joint (1) or the load (0)",
        constant=True,
    ),
    friction_own=Slot(
        "chain", "1", 0.5, "share of a joint's own friction that its own torque suffers"
    ),
)  # fmt: skip
_AMPLITUDES = ("friction_bend", "friction_constant", "friction_force", "friction_law")


@compiled
def lose_pull(model: Model, nodes: Nodes, balance: Balance, i: int, tangents: bool) -> None:
    """The pull that is left.

    u e^{−Σ s B} less the Coulomb loss.

    B is of a joint that the wire has passed, s the direction of its slide there (1 = pulled).
    """
    load, force, own = nodes.load[i], model.chain[_FORCE], model.chain[_OWN]
    size, sign, way = abs(load), math.copysign(1.0, load), nodes.direction[i]
    exponent, passed = 0.0, 0.0  # Σ s B and Σ s of the joints before
    for j in range(model.joint.shape[0]):
        whole, _ = _wrap(model, j, abs(nodes.angle[i, j]))
        kept = math.exp(-sign * (exponent + own * way[j] * whole))
        ways, drag = passed + own * way[j], force * (j + own)
        held = size / (size + drag) if drag > 0.0 else 1.0
        lost = size * kept  # −d(pull)/d(s B)
        balance.torque[i, j] = load * kept - force * ways * held
        less = force * ways / (size + drag) if drag > 0.0 else 0.0
        balance.by_load[i, j] = kept - less * (1.0 - held) * sign
        for k in range(j + 1):
            counted = own if k == j else 1.0
            bend, steep = _wrap(model, k, abs(nodes.angle[i, k]))
            balance.by_direction[i, j, k] = -counted * (lost * bend + force * held)
            lean = math.copysign(counted, nodes.angle[i, k])
            balance.by_angle[i, j, k] -= lost * way[k] * steep * lean
        if tangents:
            for c in model.columns[j]:
                d_force, d_own = model.d_chain[c, _FORCE], model.d_chain[c, _OWN]
                change = way[j] * whole * d_own + _wrap_more(model, nodes, i, j, c)
                d_drag = (j + own) * d_force + force * d_own
                d_lost = held * (ways * d_force + force * way[j] * d_own) - less * held * d_drag
                balance.tangent[i, j, c] = -lost * change - d_lost
        exponent += way[j] * whole
        passed += way[j]


@compiled
def _wrap(model: Model, j: int, bend: float) -> tuple[float, float]:
    """A joint's part of the exponent, and its slope."""
    x, law = bend / model.chain[_REACH], model.law[j, _LAW]
    whole = model.chain[_BEND] * bend + model.chain[_CONSTANT] + combine(law, weigh_value(x))
    return whole, model.chain[_BEND] + combine(law, weigh_slope(x)) / model.chain[_REACH]


@compiled
def _wrap_more(model: Model, nodes: Nodes, i: int, j: int, c: int) -> float:
    """Change of joint j's Σ s B with a parameter."""
    change = 0.0
    for k in range(j + 1):
        bend = abs(nodes.angle[i, k])
        more = bend * model.d_chain[c, _BEND] + model.d_chain[c, _CONSTANT]
        more += combine(model.d_law[c, k, _LAW], weigh_value(bend / model.chain[_REACH]))
        change += more * nodes.direction[i, k] * (model.chain[_OWN] if k == j else 1.0)
    return change


@compiled
def turn_direction(way: float, motion: float, width: float) -> tuple[float, float, float, float]:
    """Dahl's friction state after a motion.

    It nears the motion's sign as 1 − (1 − s) e^{−|x|/w}.
    Returns the state and its derivatives by the state before, the motion and the width.
    """
    sign = math.copysign(1.0, motion)
    decay = math.exp(-abs(motion) / width)
    by_motion = (1.0 - sign * way) * decay / width
    after = sign + (way - sign) * decay
    return after, decay, by_motion, -by_motion * motion / width


@compiled
def turn_at_nodes(model: Model, nodes: Nodes) -> None:
    """Each node's directions, from the one before."""
    width, by_wire = model.chain[_WIDTH], model.chain[_DRIVER] > 0.5
    nodes.by_motion[:] = 0.0
    for i in range(3):
        before = i - 1 if i > 0 else START
        for j in range(model.joint.shape[0]):
            motion = nodes.load[i] - nodes.load[before]
            if by_wire:
                motion = nodes.angle[i, j:].sum() - nodes.angle[before, j:].sum()
            nodes.direction[i, j], by_way, by_motion, by_width = turn_direction(
                nodes.direction[before, j], motion, width
            )
            for c in range(model.d_chain.shape[0]):
                change = by_way * nodes.d_direction[before, j, c]
                change += by_width * model.d_chain[c, _WIDTH]
                if not by_wire:
                    change += by_motion * (nodes.d_load[i, c] - nodes.d_load[before, c])
                nodes.d_direction[i, j, c] = change
            if by_wire:
                if i > 0:
                    nodes.by_motion[i, :, j] = by_way * nodes.by_motion[before, :, j]
                nodes.by_motion[i, i, j] += by_motion
                nodes.by_motion[i, before, j] -= by_motion


@compiled
def turn_in_jump(model: Model, work: Work, jump: float) -> None:
    """The directions after a jump of the load.

    They turn only where the load turns them, not the motion.
    """
    if not model.chain[_DRIVER] > 0.5:
        state = work.state
        for j in range(model.joint.shape[0]):
            state.direction[j], by_way, _, by_width = turn_direction(
                state.direction[j], jump, model.chain[_WIDTH]
            )
            for c in range(model.d_chain.shape[0]):
                state.d_direction[j, c] *= by_way
                state.d_direction[j, c] += by_width * model.d_chain[c, _WIDTH]


def _build_form(law: str, driver: str, setting: Setting) -> Form:
    force = law == "force"
    name = "friction_torque_nm" if force else "friction_coefficient"
    amplitude = positive(
        name,
        0.1 * setting.torque if force else 0.2,
        floor=1e-4 * (setting.torque if force else 1.0),
    )
    middle = np.log(0.02 if driver == "motion" else 0.02 * setting.torque)
    width = Parameter("turning_width", middle, 1.0, log=True, low=middle - 3, high=middle + 3)
    guide = Parameter("guide_rad", np.log(0.3), 1.0, log=True, low=np.log(0.01), high=np.log(3.0))

    def slots(values: Values) -> dict:
        motion = float(driver == "motion")
        turn = {"friction_width": values["turning_width"], "friction_driver": motion}
        if law != "wrap":
            return {f"friction_{law}": values[name]} | turn
        bend, guides = values[name], values[name] * values["guide_rad"]
        whole = {"friction_bend": bend, "friction_constant": guides, "friction_own": 1.0}
        return whole | turn

    parameters = (amplitude, guide, width) if law == "wrap" else (amplitude, width)
    return Form(f"{law}_by_{driver}", parameters, slots)


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.tension:
        return "the load is not a wire tension"
    if not setting.reversals and setting.joints < 2:
        return "friction shows where the load turns back or along several joints"
    laws = ("bend", "wrap", "constant", "force")
    drivers = ("motion", "load") if setting.reversals else ("load",)
    forms = [_build_form(law, driver, setting) for law in laws for driver in drivers]
    return [*forms, _build_free_form(drivers[0], setting)]


def _build_free_form(driver: str, setting: Setting) -> Form:
    """Build the free form.

    It has guides, any law of each joint's bend, and any share of a joint's own.
    """
    wrap, reach = _build_form("wrap", driver, setting), float(setting.reach.max())
    share = Parameter("own_share", 0.75, 0.25, low=0.0, high=1.0)

    def slots(values: Values) -> dict:
        return wrap.slots(values) | {"friction_own": values["own_share"]}

    any_wrap = replace(wrap, parameters=(*wrap.parameters, share), slots=slots)
    bend = Law("friction_law", "joint_bend_rad", reach, 0.2, terms=4, kind="sum")
    return free_form(bend, {"friction_reach": reach}, any_wrap)


EFFECT = Effect(
    "wire_friction",
    "the wire loses tension to friction on its way",
    "within_trial",
    _build_forms,
    "wire",
    hooks=(
        Hook("pull", lose_pull, _AMPLITUDES, mixes=True),
        Hook("turn", turn_at_nodes, _AMPLITUDES),
        Hook("jump", turn_in_jump, _AMPLITUDES),
    ),
)
