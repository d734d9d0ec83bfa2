import numpy as np
import pytest
from scipy.integrate import solve_ivp

from softfinger.concealed.chain import accelerate_in_place, weigh_in_place
from softfinger.concealed.effects import Circumstances, Dose
from softfinger.concealed.forward import compute_plain_angles, simulate_trial
from softfinger.concealed.kernel import RunawayError, simulate_angles
from softfinger.concealed.physics import build_plain_physics
from softfinger.concealed.population import PAPER_MEAN, PAPER_SD, to_parameters
from softfinger.concealed.protocols import Load


@pytest.mark.parametrize("draw", range(5))
def test_all_switches_off_is_the_papers_step_response(draw, rig, circumstances):
    individual = PAPER_MEAN + PAPER_SD * np.random.default_rng(draw).normal(size=PAPER_MEAN.shape)
    k_v, c_v, c_p = np.exp(individual[:3])
    step = Load(np.zeros(2), np.array([0.0, 8.0]))
    trial = Circumstances(**{**vars(circumstances), "load": step})
    time = np.linspace(0.0, 30.0, 601)

    torque, t = 8.0 * 0.005, time[:, None]
    paper = torque / k_v * (1.0 - np.exp(-k_v / c_v * t)) + torque / c_p * t + individual[3]
    np.testing.assert_allclose(
        simulate_trial(individual, {}, trial, rig, time), paper, rtol=0, atol=1e-8
    )
    np.testing.assert_allclose(
        compute_plain_angles(individual, trial, 0.005, time), paper, rtol=0, atol=1e-13
    )


@pytest.mark.parametrize("load", ["staircase", "triangle"])
def test_closed_form_and_integrator_agree_under_any_load(
    load, individual, rig, circumstances, time
):
    if load == "triangle":
        ramps = Load(np.array([1.0, 5.0, 8.0, 11.0]), np.array([0.0, 8.0, 2.0, 6.0]))
        circumstances = Circumstances(**{**vars(circumstances), "load": ramps})
    integrated = simulate_trial(individual, {}, circumstances, rig, time)
    closed = compute_plain_angles(individual, circumstances, rig.wire_offset, time)
    np.testing.assert_allclose(integrated, closed, rtol=0, atol=1e-8)
    assert np.ptp(closed, axis=0).min() > 0.1


def test_a_recording_may_start_before_the_load_and_end_after_it(individual, rig, circumstances):
    time = np.array([-1.0, 0.0, 0.5, 20.0])
    angle = simulate_trial(individual, {}, circumstances, rig, time)
    np.testing.assert_allclose(angle[:3], np.tile(individual[3], (3, 1)), atol=1e-12)
    closed = compute_plain_angles(individual, circumstances, rig.wire_offset, time)
    np.testing.assert_allclose(angle[3], closed[3], atol=1e-8)


def test_one_heavy_stiffening_joint_follows_its_equation_of_motion():
    k_v, c_v, c_p, q_ini, stiffening, tension = 0.09, 0.03, 20.0, 0.02, 0.8, 7.0
    length, mass, scale, offset, joint_length, arm_scale = 0.05, 0.02, 3.0, 0.005, 0.008, 0.7
    time = np.linspace(0.0, 2.0, 81)

    def change(_, state):
        angle, speed, flown = state
        voigt = angle - q_ini - flown
        spring = k_v * voigt / (1.0 - stiffening * voigt**2)
        carried = (spring + c_v * speed) / (1.0 + c_v / c_p)
        reach = np.sqrt((joint_length / 2) ** 2 + offset**2)
        chord = reach * np.sin(angle / 2 + np.arctan(2 * offset / joint_length))
        arm = (1 - arm_scale) * offset + arm_scale * chord
        inertia = scale * mass * length**2 / 3.0
        return [speed, (tension * arm - carried) / inertia, carried / c_p]

    exact = solve_ivp(
        change, (0.0, 2.0), [q_ini, 0.0, 0.0], "Radau", time, rtol=1e-10, atol=1e-12
    ).y[0]
    plain = build_plain_physics(
        np.array([[k_v], [c_v], [c_p], [q_ini]]),
        np.array([0.0]),
        np.array([tension]),
        np.array([length]),
        np.array([mass]),
        offset,
        joint_length,
    )
    heavy = plain._replace(
        inertia_scale=scale, stiffening=np.array([stiffening]), arm_scale=arm_scale
    )
    np.testing.assert_allclose(simulate_angles(heavy, time, 5e-9)[:, 0], exact, atol=2e-7)
    assert np.abs(simulate_angles(plain, time, 5e-9)[:, 0] - exact).max() > 0.005


def _place_rods(angle, length, centre):
    """Centres of the rods, at a share of half their length, and the tip."""
    heading = np.cumsum(angle)
    links = length[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
    ends = np.cumsum(links, axis=0)
    return ends - links + 0.5 * centre * links, ends[-1]


def _describe_chain(rig, **changes):
    plain = build_plain_physics(
        to_parameters(PAPER_MEAN),
        np.zeros(1),
        np.zeros(1),
        rig.link_length,
        rig.link_mass,
        rig.wire_offset,
        rig.joint_length,
    )
    return plain._replace(**changes)


@pytest.mark.parametrize(("payload", "centre"), [(0.0, 1.0), (0.008, 1.0), (0.003, 1.6)])
def test_weight_is_the_slope_of_the_potential(rig, payload, centre):
    pull = np.array([0.7, -1.3])
    chain = _describe_chain(
        rig,
        gravity_x=pull[0],
        gravity_y=pull[1],
        payload=payload,
        rod_centre=np.full(3, centre),
    )
    angle, nudge = np.array([0.3, 0.5, -0.2]), 1e-6

    def potential(angle):
        centres, tip = _place_rods(angle, rig.link_length, centre)
        return -(rig.link_mass @ centres + payload * tip) @ pull

    expected = [
        -(potential(angle + h) - potential(angle - h)) / (2 * nudge) for h in nudge * np.eye(3)
    ]
    torque = np.zeros(3)
    weigh_in_place(chain, angle, torque)
    np.testing.assert_allclose(torque, expected, rtol=1e-6)


@pytest.mark.parametrize(("payload", "centre", "rotor"), [(0.0, 1.0, 0.0), (0.008, 1.6, 2e-6)])
@pytest.mark.parametrize("speed", [np.zeros(3), np.array([2.0, -3.0, 5.0])])
def test_acceleration_feeds_the_power_into_kinetic_energy(rig, speed, payload, centre, rotor):
    scale, angle = 2.0, np.array([0.3, 0.5, -0.2])
    chain = _describe_chain(
        rig,
        inertia_scale=scale,
        payload=payload,
        rod_centre=np.full(3, centre),
        rotor=np.full(3, rotor),
    )

    def energy(angle, speed):
        h = 1e-5
        ends = [_place_rods(angle + s * h * speed, rig.link_length, centre) for s in (1, -1)]
        velocity, tip = ((a - b) / (2 * h) for a, b in zip(*ends, strict=True))
        spin = np.cumsum(speed) ** 2 * rig.link_length**2 / 12.0
        rods = rig.link_mass @ ((velocity**2).sum(axis=1) + spin)
        return 0.5 * scale * (rods + payload * tip @ tip + rotor * speed @ speed)

    torque = np.array([0.02, -0.01, 0.015])
    acceleration = torque.copy()
    accelerate_in_place(chain, angle, speed, acceleration)
    if not speed.any():  # at rest M q̈ is the torque, and M the energy's second derivative
        unit = np.eye(3)
        mass = np.array(
            [
                [energy(angle, a + b) - energy(angle, a) - energy(angle, b) for a in unit]
                for b in unit
            ]
        )
        np.testing.assert_allclose(mass @ acceleration, torque, rtol=1e-5)
        return
    h = 1e-5
    later = energy(angle + h * speed, speed + h * acceleration)
    earlier = energy(angle - h * speed, speed - h * acceleration)
    assert (later - earlier) / (2 * h) == pytest.approx(torque @ speed, rel=1e-4)


def test_an_impossible_motion_is_refused(individual, rig, circumstances, time):
    dose = {"joint_coupling": Dose(1e4, {"helping": 1.0}, (0, 1))}
    individual[2, :] = -30.0
    with pytest.raises(RunawayError, match="runs away"):
        simulate_trial(individual, dose, circumstances, rig, time)
