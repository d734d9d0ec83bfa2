import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.mechanics.dynamics import simulate_full_dynamics
from softfinger.mechanics.three_element import compute_joint_angle_array

TIME = np.linspace(0.0, 30.0, 61)


def test_labels_rest_and_the_slow_motion(parameters, geometry):
    motion = simulate_full_dynamics(parameters, geometry, TIME, [1.0], [8.0])
    assert motion.joint_angle.dims == ("trial", "joint", "frame")
    assert motion.joint_angle.shape == (5, 3, 61)
    before = motion.time <= 1.0
    np.testing.assert_array_equal(
        motion.joint_angle.where(before, drop=True),
        parameters.q_ini.expand_dims(frame=int(before.sum())).transpose("trial", "joint", "frame"),
    )
    values = [parameters[name].to_numpy()[..., None] for name in ("k_v", "c_v", "c_p", "q_ini")]
    values = [value[..., 0] for value in values]
    quasi_static = compute_joint_angle_array(*values, TIME, [1.0], [0.04])
    late = motion.time.to_numpy() > 4.0
    assert np.abs(motion.joint_angle - quasi_static)[..., late].max() < 2e-4


def test_trials_do_not_touch_each_other_and_equal_inputs_give_equal_bytes(parameters, geometry):
    load = ([0.0, 5.0, 5.0], [8.0, 6.0, 2.0])
    motion = simulate_full_dynamics(parameters, geometry, TIME, *load, "paper")
    again = simulate_full_dynamics(parameters.isel(trial=[3, 1]), geometry, TIME, *load, "paper")
    np.testing.assert_array_equal(again.joint_angle, motion.joint_angle.isel(trial=[3, 1]))


def test_a_load_for_each_trial(parameters, geometry):
    tension = np.linspace(1.0, 8.0, 5)[:, None]
    motion = simulate_full_dynamics(parameters, geometry, TIME, np.zeros((5, 1)), tension)
    one = simulate_full_dynamics(parameters.isel(trial=[2]), geometry, TIME, [0.0], tension[2])
    np.testing.assert_array_equal(one.joint_angle, motion.joint_angle.isel(trial=[2]))


def test_energy_is_conserved(parameters, geometry, evaluate_chain):
    """Work of the wire = kinetic + elastic energy + what both dashpots took."""
    from softfinger.mechanics.chain import compute_inertia_coefficients

    time = np.r_[0.0, np.geomspace(1e-6, 0.3, 4000)]
    motion = simulate_full_dynamics(parameters, geometry, time, [0.0], [8.0])
    q, w, q_v = (motion[n] for n in ("joint_angle", "joint_velocity", "elastic_angle"))
    k_v, c_v, c_p = (parameters[n] for n in ("k_v", "c_v", "c_p"))
    torque = c_p / (c_p + c_v) * (k_v * q_v + c_v * w)
    loss = (torque - k_v * q_v) ** 2 / c_v + torque**2 / c_p
    steps = np.diff(time)
    lost = ((loss[..., 1:] + loss[..., :-1].to_numpy()) / 2 * steps).sum(("joint", "frame"))
    angle, velocity = (v.transpose("trial", "frame", "joint").to_numpy()[:, -1] for v in (q, w))
    coefficients = compute_inertia_coefficients(geometry)
    matrix = np.stack(
        [evaluate_chain(q, w, coefficients)[0] for q, w in zip(angle, velocity, strict=True)]
    )
    kinetic = 0.5 * np.einsum("ti,tij,tj->t", velocity, matrix, velocity)
    elastic = (0.5 * k_v * q_v[..., -1] ** 2).sum("joint")
    work = (0.04 * (q[..., -1] - parameters.q_ini)).sum("joint")
    np.testing.assert_allclose(kinetic + elastic + lost, work, rtol=2e-4)


def test_the_far_end_of_the_population_survives(parameters, geometry):
    """Nearly no mass beside the damping: rates of −1e6 and more; and a finger that swings."""
    stiff = parameters.assign(c_v=parameters.c_v * 30.0)
    swinging = parameters.assign(c_v=parameters.c_v * 1e-3)
    for extreme in (stiff, swinging):
        motion = simulate_full_dynamics(extreme, geometry, TIME, [0.0], [8.0], "paper")
        assert np.isfinite(motion.joint_angle).all()


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"c_p": -1.0}, r"c_p\[0, 0\] = .*must be positive"),
        ({"k_v": np.nan}, r"k_v\[0, 0\] = nan"),
    ],
)
def test_impossible_parameters_are_refused(parameters, geometry, change, sentence):
    bad = parameters.assign({name: parameters[name] * value for name, value in change.items()})
    with pytest.raises(Fault, match=sentence):
        simulate_full_dynamics(bad, geometry, TIME, [0.0], [8.0])


def test_impossible_calls_are_refused(parameters, geometry):
    with pytest.raises(Fault, match="runs backwards"):
        simulate_full_dynamics(parameters, geometry, TIME[::-1], [0.0], [8.0])
    with pytest.raises(Fault, match="'constant_arm' or 'paper'"):
        simulate_full_dynamics(parameters, geometry, TIME, [0.0], [8.0], "straight")
    with pytest.raises(Fault, match="2 joints and the geometry 3"):
        simulate_full_dynamics(parameters.isel(joint=[0, 1]), geometry, TIME, [0.0], [8.0])
    tensions = np.full((5, 1), 8.0)
    tensions[3] = 1e300
    with pytest.raises(Fault, match="motion of trial trial_3 could not be integrated"):
        simulate_full_dynamics(parameters, geometry, TIME, np.zeros((5, 1)), tensions)
