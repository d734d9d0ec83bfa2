from dataclasses import replace

import numpy as np
import pytest

from softfinger.concealed.effects import CATALOGUES, OUTSIDERS, Dose
from softfinger.concealed.forward import simulate_trial
from softfinger.concealed.protocols import Load
from softfinger.concealed.registry import EFFECTS

CATALOGUE = """second_retardation fractional_creep strain_stiffening wire_friction moment_arm
actuator_lag fatigue_softening temperature preload_memory contact_stop yield_threshold
stress_nonlinear_flow joint_coupling gravity inertia camera_delay lens_distortion"""
ALL_JOINTS = {"any": (0, 1, 2), "one": (1,), "pair": (1, 2), "first": (0,), "chain": ()}


def _dose(name, strength, joints=None):
    effect = EFFECTS[name]
    shape = {k: s.high if s.choice else np.sqrt(s.low * s.high) for k, s in effect.shape.items()}
    return {name: Dose(strength, shape, ALL_JOINTS[effect.joints] if joints is None else joints)}


PLAIN: dict[bytes, np.ndarray] = {}  # motions without effects, which most tests compare with


@pytest.fixture
def move(individual, rig, circumstances, time):
    def simulate(doses, **changes):
        trial = replace(circumstances, **changes)
        if doses or changes:
            return simulate_trial(individual, doses, trial, rig, time)
        if individual.tobytes() not in PLAIN:
            PLAIN[individual.tobytes()] = simulate_trial(individual, {}, trial, rig, time)
        return PLAIN[individual.tobytes()].copy()

    return simulate


def test_every_id_of_the_catalogue_is_there_and_some_from_outside():
    assert set(CATALOGUES["first"]) == set(CATALOGUE.split())
    for name, listed in CATALOGUES.items():
        assert set(listed) <= set(EFFECTS)
        assert set(OUTSIDERS[name]) <= set(EFFECTS)
        assert not set(OUTSIDERS[name]) & set(listed)


@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_changes_the_motion_and_vanishes_with_its_strength(name, move):
    effect, plain = EFFECTS[name], move({})
    strong = np.abs(move(_dose(name, effect.typical)) - plain).max()
    weak = np.abs(move(_dose(name, 0.05 * effect.typical)) - plain).max()
    assert strong > 5e-4
    assert weak < 0.3 * strong
    np.testing.assert_allclose(move(_dose(name, 0.0)), plain, rtol=0, atol=3e-8)


@pytest.mark.parametrize("name", [n for n, e in EFFECTS.items() if e.joints in ("any", "one")])
@pytest.mark.parametrize("joint", [0, 2])
def test_an_effect_on_one_joint_leaves_the_others_alone(name, joint, move):
    moved = np.abs(move(_dose(name, EFFECTS[name].typical, (joint,))) - move({})).max(axis=0)
    assert moved[joint] > 3e-4
    others = [j for j in range(3) if j != joint]
    if name == "marker_slip" and joint == 0:  # what a link's own joint gains, the next one loses
        assert moved[1] == pytest.approx(moved[0])
        others = [2]
    assert moved[others].max() < 1e-7


def test_what_a_trial_left_relaxes_before_the_next_load(move, time):
    waits = Load(np.array([0.0, 5.0, 5.0]), np.array([0.0, 0.0, 8.0]))
    left = np.abs(move(_dose("preload_memory", 0.1), load=waits) - move({}, load=waits))
    assert left[0].min() > 1e-3
    assert left[time < 5.0][-1].max() < 1e-3 * left[0].min()


def test_coupling_acts_on_its_pair(move):
    moved = np.abs(move(_dose("joint_coupling", 0.008)) - move({})).max(axis=0)
    assert moved[0] < 1e-7
    assert moved[1:].min() > 1e-3


def test_second_retardation_adds_its_share_of_the_compliance(individual, rig, circumstances):
    individual[2] = 30.0  # no flow
    step = Load(np.zeros(2), np.array([0.0, 8.0]))
    dose = {"second_retardation": Dose(0.2, {"retardation_time_s": 3.0, "own": 1.0}, (1,))}
    time = np.array([2.9, 100.0])
    trial = replace(circumstances, load=step)
    angle = simulate_trial(individual, dose, trial, rig, time) - individual[3]
    plain = 0.04 / np.exp(individual[0])
    np.testing.assert_allclose(angle[1], plain * [1.0, 1.2, 1.0], rtol=1e-6)
    assert 0.5 < (angle[0, 1] - plain[1]) / (0.2 * plain[1]) < 0.75


def test_fractional_creep_is_a_power_of_time(individual, rig, circumstances):
    individual[2] = 30.0
    individual[1] = individual[0] - 6.0  # elastic at once
    step = Load(np.zeros(2), np.array([0.0, 8.0]))
    dose = {"fractional_creep": Dose(0.3, {"exponent": 0.4}, (0, 1, 2))}
    time = np.geomspace(0.3, 20.0, 9)
    angle = simulate_trial(individual, dose, replace(circumstances, load=step), rig, time)
    crept = (angle - individual[3]) * np.exp(individual[0]) / 0.04 - 1.0
    np.testing.assert_allclose(crept, 0.3 * time[:, None] ** 0.4 * np.ones(3), rtol=0.1)


def test_friction_holds_back_the_distal_joints_and_turns_with_the_load(move, time):
    plain = move({})
    change = move(_dose("wire_friction", 0.2)) / plain - 1.0
    loading, unloading = time.searchsorted([5.9, 8.9])
    assert np.all(change[loading] < 0)
    assert np.all(np.diff(change[loading]) < 0)
    # after part of the load was let go, the wire slides back and friction holds the joints bent
    assert np.all(change[unloading] > change[loading] + 0.01)


@pytest.mark.parametrize("power", [0.67, 0.95, 1.0])
@pytest.mark.parametrize("peak", [3.0, 9.0])
def test_friction_grows_to_a_power_of_the_pressure(power, peak, individual, rig, circumstances):
    individual[2] = 30.0  # no flow: at rest a spring tells the tension
    dose = {"wire_friction": Dose(0.2, {"pressure_power": power, "width_rad": 0.001}, ())}
    step = replace(circumstances, load=Load(np.zeros(2), np.array([0.0, peak])))
    angle = simulate_trial(individual, dose, step, rig, np.array([200.0]))[0]
    tension = (angle - individual[3]) * np.exp(individual[0]) / 0.005
    left = [peak]
    for bend in angle[:2]:  # Euler along the wire; at the last joint it slides back a little
        left.append(left[-1])
        for part in np.full(10000, (0.2 + bend) / 10000):
            left[-1] -= 0.2 * 6.0 * (left[-1] / 6.0) ** power * part
    np.testing.assert_allclose(tension[:2], left[1:], rtol=2e-4)


def test_the_wires_chord_is_the_papers_moment_arm(individual, rig, circumstances):
    individual[0] = 6.0  # so stiff that the angle stays where it is
    individual[2] = 30.0
    individual[3] = 0.6
    step = replace(circumstances, load=Load(np.zeros(2), np.array([0.0, 8.0])))
    time = np.array([10.0])
    bare = simulate_trial(individual, {}, step, rig, time) - 0.6
    bent = simulate_trial(individual, _dose("moment_arm", 1.0), step, rig, time) - 0.6
    reach = np.hypot(0.004, 0.005)
    arm = reach * np.sin(0.3 + np.arctan2(0.010, 0.008))
    np.testing.assert_allclose(bent / bare, arm / 0.005, rtol=2e-4)


def test_a_lag_delays_by_its_mean(individual, rig, circumstances):
    ramp = replace(circumstances, load=Load(np.array([0.0, 40.0]), np.array([0.0, 8.0])))
    time = np.array([30.0, 30.2])
    plain = simulate_trial(individual, {}, ramp, rig, time)
    late = simulate_trial(individual, _dose("actuator_lag", 0.2), ramp, rig, time)
    np.testing.assert_allclose(late[1], plain[0], atol=2e-5)


def test_a_delay_shows_the_motion_later(individual, rig, circumstances):
    dose = {"camera_delay": Dose(0.1, {}, ())}
    shift = 0.1 * (0.9 + 0.2 * 0.3)
    time = np.linspace(1.0, 11.0, 23)
    late = simulate_trial(individual, dose, circumstances, rig, time)
    plain = simulate_trial(individual, {}, circumstances, rig, time - shift)
    np.testing.assert_allclose(late, plain, atol=1e-12)
    told = EFFECTS["camera_delay"].tell(dose["camera_delay"], [circumstances])
    assert told == {"delay_s": pytest.approx(shift)}


def test_a_stop_stops(move):
    free = move({})
    stopped = move({"contact_stop": Dose(200.0, {"stop_angle_rad": 0.2}, (1,))})
    assert free[:, 1].max() > 0.3
    assert stopped[:, 1].max() < 0.22


def test_below_the_yield_torque_nothing_flows(move, individual):
    flowed = move({})[-1] - individual[3]
    held = move({"yield_threshold": Dose(0.06, {}, (0, 1, 2))})[-1] - individual[3]
    assert np.all(flowed > 0.005)
    np.testing.assert_allclose(held[:2], 0.0, atol=5e-4)


def test_gravity_is_borne_before_the_load_comes(move, individual):
    tilted = move(_dose("gravity", 0.3))
    np.testing.assert_allclose(tilted[0], individual[3], atol=1e-12)


def test_fatigue_and_session_wait_for_later_trials(move):
    plain = move({})
    for name in ("fatigue_softening", "session_jump"):
        dose = _dose(name, EFFECTS[name].typical)
        np.testing.assert_array_equal(move(dose, number=0), plain)
        assert np.abs(move(dose, number=9) - plain).max() > 0.01


def test_warmth_softens_and_cold_stiffens(move):
    dose = _dose("temperature", 0.05)  # the choice "stiffness"
    plain = move({}).max()
    assert move(dose, warmth=3.0).max() > plain > move(dose, warmth=-3.0).max()


def test_two_effects_act_at_once(move):
    both = {**_dose("actuator_lag", 0.1), **_dose("picture_stretch", 0.05)}
    single = [move({name: dose}) for name, dose in both.items()]
    for other in single:
        assert np.abs(move(both) - other).max() > 1e-3


@pytest.mark.parametrize("name", EFFECTS)
def test_what_a_truth_tells_is_finite(name, circumstances):
    told = EFFECTS[name].tell(_dose(name, EFFECTS[name].typical)[name], [circumstances])
    assert all(np.isfinite(value) for value in told.values())


def test_friction_by_a_table_of_the_bend_is_the_capstans(individual, rig, circumstances):
    individual[2] = 30.0  # no flow: at rest a spring tells the tension
    dose = {"wire_friction/edge": Dose(0.2, {"width_rad": 0.001}, ())}
    step = replace(circumstances, load=Load(np.zeros(2), np.array([0.0, 8.0])))
    angle = simulate_trial(individual, dose, step, rig, np.array([200.0]))[0]
    tension = (angle - individual[3]) * np.exp(individual[0]) / 0.005
    left = 8.0 * np.exp(-0.2 * np.cumsum(0.1 + 4.0 * angle**2))
    assert tension[0] == pytest.approx(left[0], rel=2e-4)
    assert tension[1] == pytest.approx(left[1], rel=3e-3)  # there the wire slides back a little


def test_a_ratchet_rubs_less_when_the_wire_is_let_go(move, time):
    pulled = move({"wire_friction/ratchet": Dose(0.2, {"width_rad": 0.005}, ())})
    unloading = time.searchsorted(8.9)
    shape = {"pressure_power": 0.999999, "width_rad": 0.005}
    both = move({"wire_friction": Dose(0.2, shape, ())})
    assert np.all(pulled[unloading] < both[unloading] - 0.005)


def test_a_slipping_clamp_loses_tension_from_then_on(move, time, circumstances):
    slips = (0.15 + 0.7 * 0.2) * 12.0
    moved, plain = move(_dose("clamp_slip", 0.2)), move({})
    early = time < slips - 0.01
    np.testing.assert_allclose(moved[early], plain[early], atol=1e-8)
    assert np.all(moved[time > slips + 1.0].max(axis=0) < plain[time > slips + 1.0].max(axis=0))
    np.testing.assert_allclose(move(_dose("clamp_slip", 0.2), luck=(0.9, 0.2, 0.1)), plain)


def test_a_set_stays_when_the_load_is_gone(individual, rig, circumstances):
    individual[2] = 30.0
    rest = simulate_trial(
        individual, _dose("plastic_set", 0.4), circumstances, rig, np.array([60.0])
    )[0]
    largest = 0.04 / np.exp(individual[0])  # at 8 N, what was strained before the set
    beyond = np.maximum(largest - np.sqrt(0.1 * 0.25), 0.0)
    assert np.all(rest - individual[3] > 0.35 * beyond)


def test_a_pause_between_sessions_undoes_a_part_of_the_ageing(move):
    dose = _dose("ageing_with_recovery", 0.15)
    reach = [move(dose, number=k, count=12).max() for k in range(12)]
    assert reach[3] > reach[0]
    assert reach[3] > reach[4]  # the second session begins
    assert reach[4] > reach[0]


def test_a_load_cells_gain_scales_every_deflection(move, individual):
    dose = _dose("load_gain", 0.1)
    plain = move({}) - individual[3]
    np.testing.assert_allclose(move(dose, number=0) - individual[3], plain, atol=1e-8)
    gained = 1.0 + 0.1 * np.sqrt(0.9)
    np.testing.assert_allclose(
        move(dose, number=9) - individual[3], gained * plain, rtol=1e-5, atol=1e-7
    )


def test_a_sticking_joint_shows_nothing_until_it_comes_off(move, time, individual):
    plain, stuck = move({}), move({"sticky_start": Dose(0.1, {}, (1,))})
    first = np.argmax(plain[:, 1] - individual[3, 1] >= 0.1)
    np.testing.assert_allclose(stuck[:first, 1], individual[3, 1], atol=1e-9)
    late = time > time[first] + 2.0
    np.testing.assert_allclose(stuck[late], plain[late], atol=1e-8)
