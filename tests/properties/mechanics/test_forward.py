"""Any two effects combine, and their tangents are the limits of differences."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from softfinger.mechanics.forward.curve import KNOTS
from softfinger.mechanics.forward.simulate import describe_finger, simulate_joint_angle_array
from softfinger.mechanics.forward.slots import SLOTS, build_slots, build_tangent
from softfinger.mechanics.geometry import FingerGeometry

FINGER = describe_finger(
    FingerGeometry.uniform([0.025, 0.02], [0.005, 0.004], 0.008, 0.005), optical_centre=(0.03, 0.02)
)
PARAMETERS = np.array([[[-2.4, -3.7, 2.9, 0.03], [-1.9, -3.9, 3.3, 0.01]]])
TIME = np.linspace(-0.3, 12.0, 21)
LOAD = ([0.0, 4.0, 4.0, 6.0, 9.0], [0.04, 0.04, 0.02, 0.05, 0.01])
PAIR = np.array([[0.0, 0.0], [1.0, 0.0]])
EFFECTS = {
    "second_retardation": {"second_compliance": 2.0, "second_share": 0.1, "second_time": 4.0},
    "fractional_creep": {
        "springpot_elastic_share": 0.1, "springpot_flow_share": 0.7,
        "springpot_exponent": 0.4, "flow_share": 0.5,
    },
    "second_retardation in own time": {
        "second_share": 0.1, "second_time": 4.0, "second_own_time": 1.0,
    },
    "second_retardation of two elements": {
        "second_share": 0.1, "second_time": 4.0, "second_slow_share": 0.3, "second_slower": 6.0,
        "second_own_time": 1.0,
    },
    "fractional_creep in own time": {
        "springpot_elastic_share": 0.1, "springpot_exponent": 0.4, "springpot_own_time": 1.0,
    },
    "fractional_creep instead of the damper": {
        "broad_voigt_share": 0.6, "broad_voigt_exponent": 0.55,
    },
    "creep spectrum in own time": {
        "spectrum": 0.05 * np.exp(-(((np.arange(KNOTS) - 7.5) / 2.5) ** 2)),
        "spectrum_shortest": 0.1, "spectrum_longest": 200.0, "spectrum_own_time": 1.0,
    },
    "strain_stiffening": {
        "stiffening_square": 2.0, "stiffening_linear": 0.5, "stiffening_exponential": 0.3,
        "stiffening_measure": 1.0,
    },
    "wire_friction_by_load": {
        "friction_bend": 0.3, "friction_force": 0.001, "friction_constant": 0.02,
        "friction_width": 0.005, "friction_driver": 0.0,
    },
    "wire_friction_by_motion": {
        "friction_bend": 0.3, "friction_force": 0.001, "friction_width": 0.05, "friction_own": 0.8,
    },
    "moment_arm": {"arm_scale": 1.0},
    "load_limit that fades": {
        "load_fade": 0.2, "load_sag": 0.3, "load_fade_reference": 0.05, "load_fade_time": 8.0,
    },
    "actuator_lag": {"lag": 0.2},
    "actuator_lag of two stages": {"lag": 0.2, "lag_product": 0.21},
    "actuator_lag that rings": {"lag": 0.2, "lag_product": 1.5},
    "actuator_lag by a response": {
        "response": np.r_[0.1, 0.2, 0.0, 0.3, np.zeros(KNOTS - 4)], "response_unit": 0.1,
    },
    "softening": {"log_k_v": 0.1, "log_c_v": 0.2, "log_c_p": -0.2, "q_ini": 0.01},
    "preload_memory": {"initial_angle": 0.05},
    "preload_memory at the start": {"initial_torque": 0.01},
    "contact_stop": {
        "stop_angle": 0.3, "stop_stiffness": 0.5, "stop_width": 0.02, "stop_power": 1.5,
    },
    "yield_threshold": {"yield_torque": 0.02, "yield_width": 0.004},
    "yield_with_a_jump": {"yield_torque": 0.02, "yield_width": 0.004, "yield_jump": 1.0},
    "stress_nonlinear_flow": {"flow_sinh": 30.0, "flow_power": 0.5, "flow_reference": 0.03},
    "coupling": {
        "coupling_stiffness": 0.01 * PAIR,
        "coupling_share": 0.1 * PAIR.T,
        "coupling_saturation": 2.0,
        "coupling_law": 0.1 * np.sin(np.arange(KNOTS)), "coupling_reach": 0.5,
    },
    "membrane": {
        "membrane_stiffness": 0.01 * (PAIR + PAIR.T), "membrane_share": 0.2 * (PAIR + PAIR.T),
        "membrane_law": 0.1 * np.sin(np.arange(KNOTS)), "membrane_reach": 0.5,
    },
    "thinning_damper": {
        "damper_power": 0.5, "damper_reference": 0.5, "damper_by_rate": 1.0,
        "damper_law": 0.1 * np.sin(np.arange(KNOTS)),
    },
    "softening_within_trial": {
        "softening_elastic": 0.2, "softening_flow": 0.3, "softening_time": 2.0,
        "softening_elastic_law": 0.1 * np.sin(np.arange(KNOTS)),
        "softening_flow_law": 0.1 * np.cos(np.arange(KNOTS)),
        "softening_damper": 1.0, "softening_reach": 5.0,
    },
    "joint_play taken up": {"play_taken": 0.05, "play_needed": 0.01},
    "joint_play taken up steeply": {
        "play_taken": 0.05, "play_needed": 0.02, "play_steepness": 1.5,
    },
    "joint_play with backlash": {"play_backlash": 0.05},
    "joint_play with soft edges": {
        "play_backlash": 0.05,
        "play_narrow_share": 0.4,
        "play_narrow_ratio": 0.3,
    },
    "kinematic_coupling": {"coupling_kinematic": 0.1 * PAIR},
    "gravity": {"tilt_along": 0.2, "tilt_across": -0.3},
    "inertia": {"inertia_scale": 1.0},
    "inertia of other masses": {
        "inertia_scale": 1.0, "inertia_own_share": 0.5, "inertia_moment_share": -0.3,
    },
    "camera_delay": {"delay": 0.05},
    "lens_distortion by direction": {
        "direction_law": 0.1 * np.sin(np.arange(KNOTS)), "direction_reach": 1.5,
    },
    "lens_distortion aslant": {"slant_along": 1.5, "slant_across": -0.8},
    "lens_distortion of any place": {
        "lens_radial": 10.0, "lens_fifth": 800.0, "decentring_along": 0.3,
        "decentring_across": -0.2, "slant_along": -0.5, "slant_across": 0.4,
        "lens_along": 0.01, "lens_across": -0.02,
    },
    "lens_distortion": {
        "lens_radial": 10.0, "angle_cubic": 0.05, "lens_along": 0.01, "lens_across": -0.02,
    },
}  # fmt: skip


def simulate(parameters, values, tangents=(), by_own=False):
    return simulate_joint_angle_array(
        parameters, build_slots(1, 2, values), tangents, FINGER, TIME, *LOAD,
        by_own=by_own, tolerance=1e-10,
    )  # fmt: skip


def check_tangents(names, slack):
    values = {}
    for name in names:
        values |= EFFECTS[name]
    free = [name for name in values if not SLOTS[name].constant]
    seeds = {name: PAIR + PAIR.T if SLOTS[name].kind == "coupling" else 1.0 for name in free}
    tangents = [build_tangent(1, 2, {name: seeds[name]}) for name in free]
    angle, gradient = simulate(PARAMETERS, values, tangents, by_own=True)
    assert np.isfinite(angle).all()
    alone = simulate(PARAMETERS, values, tangents)[1]  # along the directions, in steps of its own
    assert np.abs(alone - gradient[..., 8:]).max() < slack * np.abs(gradient).max() + 1e-9, names
    for column in range(8 + len(free)):
        if column < 8:
            step = 1e-4
            change = step * np.eye(8)[column].reshape(1, 2, 4)
            up, down = (simulate(PARAMETERS + sign * change, values)[0] for sign in (1, -1))
        else:
            name = free[column - 8]
            step = 1e-4 * max(0.01, np.abs(values[name]).max())
            ends = ({**values, name: values[name] + s * step * seeds[name]} for s in (1, -1))
            up, down = (simulate(PARAMETERS, end)[0] for end in ends)
        difference = (up - down) / (2 * step)
        error = np.abs(gradient[..., column] - difference).max()
        assert error < slack * np.abs(difference).max() + 1e-9, (names, column)


@pytest.mark.parametrize("name", EFFECTS)
def test_tangents_of_each_effect(name):
    check_tangents([name], 5e-3 if "motion" in name else 2e-4)


@settings(deadline=None, max_examples=12, derandomize=True)
@given(st.sampled_from(list(combinations(EFFECTS, 2))))
def test_any_two_effects_combine(names):
    check_tangents(names, 2e-2 if "wire_friction_by_motion" in names else 2e-3)


@settings(deadline=None, max_examples=10, derandomize=True)
@given(st.sampled_from(sorted(EFFECTS)), st.permutations(range(4)))
def test_the_order_of_trials_does_not_matter(name, order):
    rng = np.random.default_rng(3)
    parameters = PARAMETERS + 0.1 * rng.normal(size=(4, 2, 4))
    slots = build_slots(4, 2, EFFECTS[name])
    order = np.array(order)
    series = FINGER, TIME, *LOAD
    straight, _ = simulate_joint_angle_array(parameters, slots, [], *series, by_own=False)
    mixed, _ = simulate_joint_angle_array(parameters[order], slots, [], *series, by_own=False)
    np.testing.assert_array_equal(mixed, straight[order])
