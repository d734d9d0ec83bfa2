"""The kernel against integrators, closed forms and models that know nothing of it."""

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.interpolate import BSpline

from softfinger.faults import Fault
from softfinger.mechanics.dynamics import simulate_full_dynamics
from softfinger.mechanics.forward.curve import KNOTS
from softfinger.mechanics.forward.simulate import (
    describe_finger,
    describe_unknown_finger,
    simulate_joint_angle,
    simulate_joint_angle_array,
)
from softfinger.mechanics.forward.slots import build_slots, build_tangent
from softfinger.mechanics.three_element import compute_joint_angle_gradient_array
from softfinger.mechanics.viscoelastic.elements import (
    Dashpot,
    Spring,
    Springpot,
    kelvin_voigt,
    parallel,
    series,
    three_element,
)
from softfinger.mechanics.viscoelastic.response import (
    compute_creep_compliance_array,
    compute_network_response_array,
)

LOAD = (np.array([0.0, 3.0, 3.0, 5.0, 8.0]), np.array([0.04, 0.04, 0.015, 0.05, 0.05]))
TIME = np.linspace(-0.5, 12.0, 26)
NAMES = ("k_v", "c_v", "c_p", "q_ini")


def natural(parameters):
    values = [parameters[name].to_numpy() for name in NAMES]
    return np.stack([*np.log(values[:3]), values[3]], axis=-1)


def test_without_left_out_physics_it_is_the_papers_joint_to_rounding(parameters):
    time = np.linspace(-1.0, 30.0, 400)
    angle, gradient = simulate_joint_angle_array(
        natural(parameters), build_slots(5, 3, {}), [], describe_unknown_finger(3), time, *LOAD,
        route="general",
    )  # fmt: skip
    values = [parameters[name].to_numpy() for name in NAMES]
    exact, exact_gradient = compute_joint_angle_gradient_array(*values, time, *LOAD)
    np.testing.assert_allclose(angle, exact, rtol=0, atol=1e-14)
    for joint in range(3):
        own = gradient[:, joint, :, 4 * joint : 4 * joint + 4]
        np.testing.assert_allclose(own, exact_gradient[:, joint], rtol=0, atol=1e-13)


def test_the_closed_form_is_the_general_kernel_without_effects(parameters):
    """Also along directions that move the joints' own parameters, and where times are missing."""
    time = np.tile(np.linspace(0.0, 9.0, 31), (5, 1))
    time[2, 20:] = np.nan
    slots = build_slots(5, 3, {"log_k_v": np.full((5, 3), 0.1)})
    rng = np.random.default_rng(2)
    ways = [build_tangent(5, 3, {name: rng.normal(size=(5, 3))}) for name in ("log_c_p", "log_c_v")]
    finger = describe_unknown_finger(3)
    for by_own in (True, False):
        general, closed = (
            simulate_joint_angle_array(
                natural(parameters), slots, ways, finger, time, *LOAD, by_own=by_own, route=route
            )
            for route in ("general", "closed_form")
        )
        for one, other in zip(general, closed, strict=True):
            np.testing.assert_allclose(one, other, rtol=0, atol=1e-13)


def test_a_closed_form_that_does_not_apply_is_refused(parameters):
    slots = build_slots(5, 3, {"second_compliance": np.full((5, 3), 0.5)})
    with pytest.raises(Fault, match="the closed form has no second_compliance"):
        simulate_joint_angle_array(
            natural(parameters), slots, [], describe_unknown_finger(3), np.ones(1), *LOAD,
            route="closed_form",
        )  # fmt: skip


def test_linear_extensions_are_exact_too(parameters):
    """A second Voigt element, and a springpot to the accuracy of its sum of exponentials."""
    time = np.linspace(0.1, 60.0, 50)
    one = parameters.isel(trial=[0], joint=[0])
    values = natural(one)
    joint = three_element(*(float(one[name][0, 0]) for name in NAMES[:3]))
    offset = float(one.q_ini[0, 0])

    def simulate(**slots):
        finger = describe_unknown_finger(1)
        return simulate_joint_angle_array(
            values, build_slots(1, 1, slots), [], finger, time, *LOAD, by_own=False
        )[0][0, 0]

    second = simulate(second_compliance=2.0, second_time=4.0)
    expected = compute_network_response_array(series(joint, kelvin_voigt(0.5, 2.0)), time, *LOAD)
    np.testing.assert_allclose(second, expected + offset, rtol=0, atol=1e-14)
    for exponent in (0.2, 0.5, 0.8):
        pot = simulate(springpot_compliance=2.0, springpot_exponent=exponent)
        expected = compute_network_response_array(
            series(joint, Springpot(0.5, exponent)), time, *LOAD
        )
        np.testing.assert_allclose(pot, expected + offset, rtol=3e-5)


@pytest.mark.parametrize("exponent", [0.05, 0.3, 0.7, 0.95])
def test_springpot_creeps_as_stated(exponent):
    """6e-5 relatively from 5 ms to 200 s, beside a joint that is nearly rigid."""
    time = np.geomspace(5e-3, 200.0, 40)
    angle, _ = simulate_joint_angle_array(
        np.array([[[30.0, 0.0, 30.0, 0.0]]]),
        build_slots(1, 1, {"springpot_compliance": 1.0, "springpot_exponent": exponent}),
        [], describe_unknown_finger(1), time, [0.0], [1.0], by_own=False,
    )  # fmt: skip
    expected = compute_creep_compliance_array(Springpot(1.0, exponent), time)
    np.testing.assert_allclose(angle[0, 0], expected, rtol=6e-5)


@pytest.mark.parametrize("exponent", [0.3, 0.5, 0.6, 0.7])
def test_a_springpot_instead_of_the_damper_creeps_as_stated(parameters, exponent):
    """0.2 % of the angle from 10 ms on, of a spring and a springpot side by side."""
    time = np.geomspace(1e-2, 60.0, 50)
    one = parameters.isel(trial=[0], joint=[0])
    k_v, c_v, c_p = (float(one[name][0, 0]) for name in NAMES[:3])
    angle, _ = simulate_joint_angle_array(
        natural(one),
        build_slots(1, 1, {"broad_voigt_share": 1.0, "broad_voigt_exponent": exponent}),
        [], describe_unknown_finger(1), time, [0.0], [0.04], by_own=False,
    )  # fmt: skip
    pot = Springpot(k_v * (c_v / k_v) ** exponent, exponent)
    network = series(parallel(Spring(k_v), pot), Dashpot(c_p))
    expected = 0.04 * compute_creep_compliance_array(network, time) + float(one.q_ini[0, 0])
    np.testing.assert_allclose(angle[0, 0], expected, rtol=2e-3)


@pytest.mark.parametrize("exponent", [0.0, 1.0])
def test_springpot_ends_as_spring_and_as_dashpot(exponent):
    time = np.geomspace(5e-3, 200.0, 10)
    angle, _ = simulate_joint_angle_array(
        np.array([[[30.0, 0.0, 30.0, 0.0]]]),
        build_slots(1, 1, {"springpot_compliance": 2.0, "springpot_exponent": exponent}),
        [], describe_unknown_finger(1), time, [0.0], [1.0], by_own=False,
    )  # fmt: skip
    np.testing.assert_allclose(angle[0, 0], 2.0 * time**exponent, rtol=1e-9)


def softplus(x, width):
    return width * np.logaddexp(0.0, x / width)


BUMPY = 0.3 * np.sin(1.7 * np.arange(KNOTS))  # coefficients of a law that is no textbook's
BUMPY[:3] = 0.0


def evaluate_bumpy(x):
    """That law by another library; inside its reach only."""
    knots = np.arange(-3, KNOTS + 1) / (KNOTS - 3)
    return BSpline(knots, BUMPY, 3)(x)


def follow_slowly(load, rate):
    """A log that is followed no faster than a rate, in very short steps."""
    step = 2e-5
    time = step * np.arange(610_000) + 1e-12
    jump = np.searchsorted(load[0], time, side="right") - 1
    ahead = np.minimum(jump + 1, load[0].size - 1)
    span = np.where(ahead > jump, load[0][ahead] - load[0][jump], 1.0)
    share = np.where(ahead > jump, (time - load[0][jump]) / np.where(span > 0, span, 1.0), 0.0)
    goal = load[1][jump] + share * (load[1][ahead] - load[1][jump])
    value, most = [0.0], rate * step
    for wanted in goal[:-1].tolist():
        value.append(value[-1] + min(max(wanted - value[-1], -most), most))
    return time, np.array(value)


RESPONSE = np.array([0.1, 0.2, 0.0, 0.3])  # shares that arrive between delays of 0.1 s units


def arrive_late(load):
    """What arrives late of a log, by sums in short steps."""
    time = 1e-3 * np.arange(-1000, 14_000)
    middle = time[:-1] + 0.5e-3
    value = np.where(middle < load[0][0], 0.0, np.interp(middle, *load))
    total = np.append(0.0, 1e-3 * np.cumsum(value))
    late, edges = np.zeros(time.size), 0.1 * np.array([0.0, 0.5, 1.0, 2.0, 4.0])
    for share, near, far in zip(RESPONSE, edges, edges[1:], strict=False):
        passed = [np.interp(time - delay, time, total) for delay in (near, far)]
        late += share * (passed[0] - passed[1]) / (far - near)
    return time, late


def integrate(parameters, slots, load):
    """The same physics, written out anew, stepped by LSODA with a tight tolerance."""
    k_v, c_v, c_p, q_ini = (parameters[name].to_numpy()[0] for name in NAMES)
    get = {
        "stiff": 0.0, "stop": 0.0, "sinh": 0.0, "arm": 0.0, "along": 0.0, "across": 0.0,
        "couple": 0.0, "couple_law": 0.0, "lag": 0.0, "second": 0.0, "friction": 0.0, "held": 0.0,
        "friction_own": 0.5,
        "spring_law": 0.0, "arm_law": 0.0, "flow_law": 0.0, "stop_law": 0.0, "friction_law": 0.0,
        "stop_power": 1.0,
        "damper": 0.0, "damper_law": 0.0, "softer": 0.0, "thinner": 0.0, "play": 0.0, "edges": 0.0,
        "membrane": 0.0, "share": 0.0, "saturation": 0.0, "load_law": 0.0, "payload": 0.0,
        "slow": 0.0, "membrane_law": 0.0, "response": 0.0, "softer_law": 0.0, "thinner_law": 0.0,
        "thin_both": 0.0, "by_rate": 0.0, "taken": 0.0,
        "placed": 0.0, "ring": 0.0, "backlash": 0.0, "narrow": 0.0, "fade": 0.0, "sag": 0.0,
        **slots,
    }  # fmt: skip
    moment = 0.005 * np.array([0.0125 + 0.05, 0.0125 + 0.025, 0.0125])
    moment = moment * (1 + get["payload"] * np.array([0.2, 0.5, 1.0]))
    mean = np.sqrt(k_v[:-1] * k_v[1:])
    slowly = follow_slowly(load, get["slow"]) if get["slow"] else None

    late = arrive_late(load) if get["response"] else None

    def find_load(t, log, acting):
        u = find_reached(t, log, acting)
        return u * (1.0 - (get["fade"] + get["sag"] * abs(u) / 0.05) * min(t / 12.0, 1.0))

    def find_reached(t, log, acting):
        if get["response"]:
            return log(t) * (1 - RESPONSE.sum()) + np.interp(t, *late)
        return acting if get["lag"] else np.interp(t, *slowly) if get["slow"] else log(t)

    def soften(t):
        return 1 - np.exp(-max(t, 0.0) / 3.0)

    def bend_course(name, t):
        return np.exp(get[name] * evaluate_bumpy(max(t, 0.0) / 12.0)) if get[name] else 1.0

    def limit(force):
        x = abs(force) / 0.05
        force = force * (1 + get["saturation"] * x**8) ** -0.125
        return force * (1 + (evaluate_bumpy(x) if get["load_law"] else 0.0))

    def statics(q, force, way):
        arm = 1 + get["arm"] * (np.cos(q / 2) + 0.8 * np.sin(q / 2) - 1)
        arm += evaluate_bumpy(q / 2.0) if get["arm_law"] else 0.0
        bend = np.abs(q)
        wrapped = get["friction"] * bend
        wrapped += get["friction_law"] * evaluate_bumpy(bend / 2.0) if get["friction_law"] else 0.0
        lost = way * wrapped
        torque = force * np.exp((1 - get["friction_own"]) * lost - np.cumsum(lost)) * arm
        depth = softplus(q - 0.3, 0.02)
        harder = 1 + (evaluate_bumpy(depth / 1.0) if get["stop_law"] else 0.0)
        harder *= depth ** (get["stop_power"] - 1.0)
        torque -= get["stop"] * depth * harder
        direction = np.cumsum(q)
        weight = (
            9.80665
            * moment
            * (np.sin(get["across"]) * np.cos(direction) - np.sin(get["along"]) * np.sin(direction))
        )
        torque += np.cumsum(weight[::-1])[::-1]
        beside = np.r_[0.0, (q - q_ini)[:-1]]
        bend = np.exp(get["couple_law"] * evaluate_bumpy(np.abs(beside) / 1.2))
        torque += get["couple"] * beside * bend
        apart = np.diff(q - q_ini)
        law = evaluate_bumpy(np.abs(apart) / 1.2) if get["membrane_law"] else 0.0
        pull = (get["membrane"] + (get["share"] + law) * mean) * apart
        return torque + np.r_[pull, 0.0] - np.r_[0.0, pull]

    def spring(x, t):
        taut = softplus(x - get["play"], 0.01) - softplus(-x - get["play"], 0.01)
        if n := get["edges"]:
            at = n * x / (get["play"] * np.tanh(n))
            loose = np.log(np.cosh(at + n) / np.cosh(at - n))
            taut = x - 0.999 * get["play"] * loose / (2 * n)
        law = evaluate_bumpy(np.abs(x) / 1.5) if get["spring_law"] else 0.0
        softer = (1 - get["softer"] * soften(t)) * bend_course("softer_law", t)
        return k_v * taut * (1 + get["stiff"] * x**2 + law) * softer

    rest, q_rest = statics(q_ini, 0.0, 0.0), np.zeros(3)
    for _ in range(60):
        q_rest -= (spring(q_rest, 0.0) - rest) / (k_v * (1 + 3 * get["stiff"] * q_rest**2))

    def rate(t, state, log):
        q_v, q_p, acting, way = state[:3], state[3:6], state[6], state[8:]
        force = limit(find_load(t, log, acting))
        torque = statics(q_ini + q_v - q_rest + q_p, force, way)
        flow = np.sinh(get["sinh"] * torque) / get["sinh"] if get["sinh"] else torque
        flow = flow * np.exp(evaluate_bumpy(np.abs(torque) / 0.1) if get["flow_law"] else 0.0)
        flow = flow / (1 - get["thinner"] * soften(t)) / bend_course("thinner_law", t)
        damper = torque - spring(q_v, t)
        if get["thin_both"]:
            damper /= (1 - get["thinner"] * soften(t)) * bend_course("thinner_law", t)
        whole = np.abs(torque - spring(q_v, t)) / (c_v if get["by_rate"] else 1.0)
        reference = 0.5 if get["by_rate"] else 0.02
        damper = damper * (1 + (whole / reference) ** 2) ** (get["damper"] / 2)
        if get["damper_law"]:
            damper = damper * np.exp(evaluate_bumpy(whole / (8.0 if get["by_rate"] else 0.1)))
        moves = damper / c_v, flow / c_p
        wire = np.cumsum(sum(moves)[::-1])[::-1]  # what slides past each joint
        before = state[7] if get["second"] else log(t)  # of the last stage
        slow = (before - acting) / (get["second"] or get["lag"]) if get["lag"] else 0.0
        first = (log(t) - state[7]) / (get["lag"] - get["second"]) if get["second"] else 0.0
        if get["ring"]:  # as position and speed of a drive
            slow = state[7]
            first = (log(t) - acting - get["lag"] * slow) / (get["ring"] * get["lag"] ** 2)
        return np.r_[moves[0], moves[1], slow, first, (wire - abs(wire) * way) / 0.05]

    state, angles = np.r_[q_rest + get["held"] / k_v, np.zeros(8)], []
    knots, torques = load
    pieces = [(-0.5, 0.0, 0.0, 0.0)]
    pieces += zip(knots[:-1], knots[1:], torques[:-1], torques[1:], strict=True)
    pieces.append((knots[-1], 12.1, torques[-1], torques[-1]))
    ended = 0.0
    for start, end, first, last in pieces:
        if start == end:
            continue
        inside = TIME[(start <= TIME) & (end > TIME)]
        line = np.array([start, end]), np.array([first, last])
        solution = solve_ivp(
            rate, (start, end), state, "LSODA", np.r_[inside, end],
            args=(lambda t, line=line: np.interp(t, *line),), rtol=1e-9, atol=1e-11,
        )  # fmt: skip
        q_v, q_p = solution.y[:3, : inside.size], solution.y[3:6, : inside.size]
        angle = (q_ini - q_rest)[:, None] + q_v + q_p
        if (get["taken"] or get["placed"]) and inside.size:
            force = np.interp(inside, *line)
            force[inside == start] = ended  # a frame at a step sees what was before it
            each = [statics(q, now, 0.0) for q, now in zip(angle.T, force, strict=True)]
            pulled = np.transpose(each)
            power = np.abs(pulled / 0.02) ** 1.5
            placed = get["placed"] * np.sign(pulled) * power / (1.0 + power)
            angle = angle + get["taken"] * np.tanh(pulled / 0.01) + placed
        angles.append(angle)
        state, ended = solution.y[:, -1], last
    angle = np.concatenate(angles, axis=1)
    if get["backlash"]:
        wide, narrow = (follow_late(angle, q_ini, r * get["backlash"]) for r in (1.0, 0.3))
        return wide + get["narrow"] * (narrow - wide)
    return angle


def follow_late(angle, middle, gap):
    """Angles (joint, n) of links that follow theirs within a gap."""
    late = []
    for now in angle.T:
        middle = np.clip(middle, now - 0.5 * gap, now + 0.5 * gap)
        late.append(middle)
    return np.transpose(late)


PHYSICS = {
    "stiffening": ({"stiffening_square": 2.0}, {"stiff": 2.0}),
    "stop": ({"stop_angle": 0.3, "stop_stiffness": 0.5, "stop_width": 0.02}, {"stop": 0.5}),
    "hertzian stop": (
        {"stop_angle": 0.3, "stop_stiffness": 0.5, "stop_width": 0.02, "stop_power": 1.5},
        {"stop": 0.5, "stop_power": 1.5},
    ),
    "flow": ({"flow_sinh": 40.0}, {"sinh": 40.0}),
    "moment_arm": ({"arm_scale": 1.0}, {"arm": 1.0}),
    "gravity": ({"tilt_along": 0.2, "tilt_across": -0.3}, {"along": 0.2, "across": -0.3}),
    "coupling": ({"coupling_stiffness": 0.02 * np.eye(3, k=-1)}, {"couple": 0.02}),
    "coupling_law": (
        {
            "coupling_stiffness": 0.02 * np.eye(3, k=-1),
            "coupling_law": BUMPY,
            "coupling_reach": 1.2,
        },
        {"couple": 0.02, "couple_law": 1.0},
    ),
    "preload": ({"initial_torque": 0.01}, {"held": 0.01}),
    "lag": ({"lag": 0.3}, {"lag": 0.3}),
    "response": (
        {"response": np.r_[RESPONSE, np.zeros(KNOTS - 4)], "response_unit": 0.1},
        {"response": 1.0},
    ),
    "two_lags": ({"lag": 0.3, "lag_product": 0.16}, {"lag": 0.3, "second": 0.06}),
    "critical_lag": ({"lag": 0.3, "lag_product": 0.25}, {"lag": 0.3, "ring": 0.25}),
    "ringing_lag": ({"lag": 0.1, "lag_product": 1.5}, {"lag": 0.1, "ring": 1.5}),
    "friction": ({"friction_bend": 0.4, "friction_width": 0.05}, {"friction": 0.4}),
    "spring_law": ({"spring_law": BUMPY, "spring_reach": 1.5}, {"spring_law": 1.0}),
    "arm_law": ({"arm_law": BUMPY, "arm_reach": 2.0}, {"arm_law": 1.0}),
    "flow_law": ({"flow_law": BUMPY, "flow_reach": 0.1}, {"flow_law": 1.0}),
    "stop_law": (
        {"stop_angle": 0.3, "stop_stiffness": 0.5, "stop_width": 0.02, "stop_law": BUMPY},
        {"stop": 0.5, "stop_law": 1.0},
    ),
    "friction_law": (
        {
            "friction_law": 0.2 * BUMPY,
            "friction_reach": 2.0,
            "friction_width": 0.05,
            "friction_own": 0.8,
        },
        {"friction_law": 0.2, "friction_own": 0.8},
    ),
    "thinning": ({"damper_power": 0.8, "damper_reference": 0.02}, {"damper": 0.8}),
    "damper_law": ({"damper_law": BUMPY, "damper_reference": 0.1}, {"damper_law": 1.0}),
    "thinning_by_rate": (
        {"damper_power": 0.8, "damper_reference": 0.5, "damper_by_rate": 1.0},
        {"damper": 0.8, "by_rate": 1.0},
    ),
    "damper_law_by_rate": (
        {"damper_law": BUMPY, "damper_reference": 8.0, "damper_by_rate": 1.0},
        {"damper_law": 1.0, "by_rate": 1.0},
    ),
    "softening": ({"softening_elastic": 0.3, "softening_time": 3.0}, {"softer": 0.3}),
    "softening_flow": ({"softening_flow": 0.5, "softening_time": 3.0}, {"thinner": 0.5}),
    "softening_law": (
        {
            "softening_elastic": 0.3,
            "softening_time": 3.0,
            "softening_elastic_law": 0.3 * BUMPY,
            "softening_reach": 12.0,
        },
        {"softer": 0.3, "softer_law": 0.3},
    ),
    "softening_flow_law": (
        {
            "softening_flow": 0.5,
            "softening_time": 3.0,
            "softening_flow_law": 0.3 * BUMPY,
            "softening_reach": 12.0,
        },
        {"thinner": 0.5, "thinner_law": 0.3},
    ),
    "softening_both": (
        {
            "softening_flow": 0.5,
            "softening_time": 3.0,
            "softening_damper": 1.0,
            "softening_flow_law": 0.3 * BUMPY,
            "softening_reach": 12.0,
        },
        {"thinner": 0.5, "thinner_law": 0.3, "thin_both": 1.0},
    ),
    "play": ({"play": 0.05, "play_width": 0.01}, {"play": 0.05}),
    "soft_play": ({"play": 0.05, "play_hardness": 0.6}, {"play": 0.05, "edges": 0.6}),
    "taken_up": ({"play_taken": 0.05, "play_needed": 0.01}, {"taken": 0.05}),
    "taken_up_steeply": (
        {"play_taken": 0.05, "play_needed": 0.02, "play_steepness": 1.5},
        {"placed": 0.05},
    ),
    "backlash": ({"play_backlash": 0.1}, {"backlash": 0.1}),
    "soft_edges": (
        {"play_backlash": 0.1, "play_narrow_share": 0.4, "play_narrow_ratio": 0.3},
        {"backlash": 0.1, "narrow": 0.4},
    ),
    "membrane": (
        {
            "membrane_stiffness": 0.02 * (np.eye(3, k=1) + np.eye(3, k=-1)),
            "membrane_share": 0.1 * (np.eye(3, k=1) + np.eye(3, k=-1)),
        },
        {"membrane": 0.02, "share": 0.1},
    ),
    "membrane_law": (
        {
            "membrane_share": 0.3 * (np.eye(3, k=1) + np.eye(3, k=-1)),
            "membrane_law": BUMPY,
            "membrane_reach": 1.2,
        },
        {"share": 0.3, "membrane_law": 1.0},
    ),
    "saturation": ({"load_saturation": 3.0, "load_reference": 0.05}, {"saturation": 3.0}),
    "load_law": ({"load_law": BUMPY, "load_reference": 0.05}, {"load_law": 1.0}),
    "slow": ({"load_slowness": 20.0}, {"slow": 0.05}),
    "fading": (
        {"load_fade": 0.2, "load_sag": 0.3, "load_fade_reference": 0.05, "load_fade_time": 12.0},
        {"fade": 0.2, "sag": 0.3},
    ),
    "payload": (
        {"tilt_along": 0.2, "tilt_across": -0.3, "moment_share": np.array([0.2, 0.5, 1.0])},
        {"along": 0.2, "across": -0.3, "payload": 1.0},
    ),
}
PAIRS = [
    ("moment_arm", "friction"),
    ("stiffening", "gravity"),
    ("lag", "stop"),
    ("two_lags", "friction"),
    ("flow", "coupling"),
    ("friction", "lag"),
    ("preload", "stiffening"),
    ("arm_law", "thinning"),
    ("damper_law", "play"),
    ("softening", "spring_law"),
    ("slow", "saturation"),
    ("slow", "fading"),
    ("moment_arm", "taken_up"),
    ("softening", "backlash"),
]


@pytest.mark.parametrize("names", [*((name,) for name in PHYSICS), *PAIRS], ids="+".join)
def test_left_out_physics_agrees_with_an_independent_integrator(parameters, geometry, names):
    one = parameters.isel(trial=[1])
    slots, plain = {}, {}
    for name in names:
        slots |= PHYSICS[name][0]
        plain |= PHYSICS[name][1]
    angles = simulate_joint_angle(one, describe_finger(geometry), TIME, *LOAD, slots).joint_angle
    bent = {"response", "fading"} & set(names)
    error = 2e-4 if bent else 1e-5  # of a ramp's parabolas, met at knots
    error = 2e-5 if "friction" in names else error  # slides that turn back between nodes
    np.testing.assert_allclose(angles[0], integrate(one, plain, LOAD), rtol=0, atol=error)


def test_a_response_spreads_steps_exactly(parameters, geometry):
    one = parameters.isel(trial=[1])
    steps = np.array([0.0, 3.0, 3.0, 8.0]), np.array([0.04, 0.04, 0.01, 0.01])
    slots, plain = PHYSICS["response"]
    angles = simulate_joint_angle(one, describe_finger(geometry), TIME, *steps, slots).joint_angle
    np.testing.assert_allclose(angles[0], integrate(one, plain, steps), rtol=0, atol=1e-5)


def test_a_spectrum_of_retardation_times_creeps_as_its_integral(parameters):
    one = parameters.isel(trial=[0], joint=[0])
    time = np.geomspace(0.05, 100.0, 20)
    law = 0.1 * np.exp(-(((np.arange(KNOTS) - 7.5) / 2.5) ** 2))
    reach = {"spectrum_shortest": 0.05, "spectrum_longest": 50.0}
    load, knots = ([0.0], [0.04]), np.arange(-3, KNOTS + 1) / (KNOTS - 3)
    finger = describe_unknown_finger(1)
    values = [
        simulate_joint_angle(one, finger, time, *load, slots).joint_angle.to_numpy()[0, 0]
        for slots in ({}, {"spectrum": law, **reach})
    ]
    curve = BSpline(knots, law, 3)

    def creep(t):
        def rate(x):
            return curve(x) * -np.expm1(-t / (0.05 * 1000.0**x))

        return np.log(1000.0) * quad(rate, 0.0, 1.0)[0]

    expected = 0.04 / float(one.k_v[0, 0]) * np.array([creep(t) for t in time])
    np.testing.assert_allclose(values[1] - values[0], expected, rtol=0, atol=2e-3 * expected.max())


def test_optics_turn_each_link_by_a_law_of_its_direction(parameters):
    one = parameters.isel(trial=[1])
    finger = describe_unknown_finger(one.sizes["joint"])
    true, seen = (
        simulate_joint_angle(one, finger, TIME, *LOAD, slots).joint_angle.to_numpy()[0]
        for slots in ({}, {"direction_law": BUMPY, "direction_reach": 4.0})
    )
    direction = np.cumsum(true, axis=0)
    turned = direction * (1.0 + evaluate_bumpy(np.abs(direction) / 4.0))
    np.testing.assert_allclose(np.cumsum(seen, axis=0), turned, rtol=0, atol=1e-9)
    assert np.abs(turned - direction).max() > 0.01


LUMP = 0.1 * np.exp(-(((np.arange(KNOTS) - 7.5) / 2.5) ** 2))


@pytest.mark.parametrize(
    ("name", "own", "plain"),
    [
        (
            "second_own_time",
            {"second_share": 0.2, "second_time": 6.0},
            lambda unit: {"second_share": 0.2, "second_time": 6.0 * unit},
        ),
        (
            "springpot_own_time",
            {"springpot_elastic_share": 0.2, "springpot_exponent": 0.3},
            lambda unit: {
                "springpot_elastic_share": 0.2 * unit**-0.3, "springpot_exponent": 0.3
            },
        ),
        (
            "spectrum_own_time",
            {"spectrum": LUMP, "spectrum_shortest": 0.2, "spectrum_longest": 300.0},
            lambda unit: {
                "spectrum": LUMP, "spectrum_shortest": 0.2 * unit, "spectrum_longest": 300.0 * unit
            },
        ),
    ],
    ids=["second", "springpot", "spectrum"],
)  # fmt: skip
def test_creep_in_own_time_is_creep_in_units_of_the_retardation_time(parameters, name, own, plain):
    one = parameters.isel(trial=[1])
    finger = describe_unknown_finger(one.sizes["joint"])
    unit = (one.c_v / one.k_v).to_numpy()
    assert np.ptp(unit) > 0.05 * unit.mean()
    angles = [
        simulate_joint_angle(one, finger, TIME, *LOAD, slots).joint_angle
        for slots in ({}, {**own, name: 1.0}, plain(unit))
    ]
    assert float(abs(angles[1] - angles[0]).max()) > 0.01
    np.testing.assert_allclose(angles[1], angles[2], rtol=0, atol=1e-9)


@pytest.mark.parametrize(("arm", "wires"), [(0.0, "constant_arm"), (1.0, "paper")])
def test_with_inertia_it_is_the_full_dynamics(parameters, geometry, arm, wires):
    time = np.r_[0.0, np.geomspace(1e-3, 10.0, 60)]
    load = (np.array([0.0, 3.0, 3.0]), np.array([0.04, 0.04, 0.01]))
    slots = {"inertia_scale": 1.0, "arm_scale": arm}
    angles = simulate_joint_angle(parameters, describe_finger(geometry), time, *load, slots)
    motion = simulate_full_dynamics(parameters, geometry, time, load[0], load[1] / 0.005, wires)
    np.testing.assert_allclose(angles.joint_angle, motion.joint_angle, rtol=0, atol=5e-6)


def test_steps_converge_with_order_five_and_four_within(parameters, geometry):
    """Nonlinear spring, flow and moment arm at fixed steps, against very short ones."""
    values = natural(parameters.isel(trial=[0]))
    slots = build_slots(
        1, 3, {"arm_scale": 1.0, "stiffening_square": 2.0, "flow_sinh": 40.0, "lag": 0.4}
    )
    tangents = [build_tangent(1, 3, {"arm_scale": 1.0})]

    def simulate(step, time):
        return simulate_joint_angle_array(
            values, slots, tangents, describe_finger(geometry), time, [0.0], [0.04],
            tolerance=np.inf, longest_step=step,
        )  # fmt: skip

    steps = np.array([0.02, 0.01, 0.005])
    shares = {5: [1.0], 4: [0.3, 0.5, 0.8]}
    for order, share in shares.items():
        errors = []
        for step in steps:
            time = np.add.outer(step * np.arange(round(1.6 / step)), step * np.array(share)).ravel()
            pairs = zip(simulate(step, time), simulate(step / 20, time), strict=True)
            errors.append([np.abs(found - exact).max() for found, exact in pairs])
        found = np.log2(np.divide(errors[:-1], errors[1:]))  # (pair of steps, angles and tangents)
        assert (np.abs(found - order) < 0.4).all(), (order, found)


def test_tolerance_bounds_the_error(parameters, geometry):
    slots = {"arm_scale": 1.0, "stiffening_square": 2.0, "flow_sinh": 40.0}
    arguments = (
        natural(parameters), build_slots(5, 3, slots), [], describe_finger(geometry), TIME, *LOAD
    )  # fmt: skip
    usual, _ = simulate_joint_angle_array(*arguments)
    tight, _ = simulate_joint_angle_array(*arguments, tolerance=1e-11)
    assert np.abs(usual - tight).max() < 5e-6
