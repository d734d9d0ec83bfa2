import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.mechanics.forward.simulate import (
    describe_finger,
    describe_unknown_finger,
    simulate_joint_angle,
    simulate_joint_angle_array,
)
from softfinger.mechanics.forward.slots import build_slots

TIME = np.linspace(-1.0, 20.0, 22)
LOAD = ([0.0, 5.0, 5.0, 9.0], [0.04, 0.04, 0.01, 0.05])


def test_labels_and_derivatives(parameters, geometry):
    directions = [{"arm_scale": 1.0}, {"lag": 1.0}]
    angles = simulate_joint_angle(
        parameters, describe_finger(geometry), TIME, *LOAD, {"arm_scale": 1.0}, directions
    )
    assert angles.joint_angle.dims == ("trial", "joint", "frame")
    assert angles.joint_angle.shape == (5, 3, 22)
    assert angles.joint_angle_by_parameter.shape == (5, 3, 22, 3, 4)
    assert angles.joint_angle_by_direction.shape == (5, 3, 22, 2)
    assert angles.trial.to_numpy()[0] == "trial_0"
    elsewhere = angles.joint_angle_by_parameter.to_numpy()[:, 0, :, 1:]
    assert not elsewhere.any()  # the arm does not couple the joints


def test_at_rest_before_the_load(parameters, geometry):
    angles = simulate_joint_angle(parameters, describe_finger(geometry), TIME, *LOAD)
    early = angles.joint_angle.to_numpy()[..., TIME <= 0.0]
    np.testing.assert_allclose(
        early, parameters.q_ini.to_numpy()[..., None] + 0 * early, rtol=1e-14
    )


def test_trials_do_not_touch_each_other_and_equal_inputs_give_equal_bytes(parameters, geometry):
    finger = describe_finger(geometry)
    slots = {"arm_scale": 1.0, "stiffening_square": 2.0, "delay": np.linspace(0.0, 0.2, 5)}
    angles = simulate_joint_angle(parameters, finger, TIME, *LOAD, slots, [{"arm_scale": 1.0}])
    some = {**slots, "delay": slots["delay"][[3, 1]]}
    again = simulate_joint_angle(
        parameters.isel(trial=[3, 1]), finger, TIME, *LOAD, some, [{"arm_scale": 1.0}]
    )
    for name in again:
        np.testing.assert_array_equal(again[name], angles[name].isel(trial=[3, 1]))


def test_each_trial_has_its_own_times_and_load_and_padding_stays_nan(parameters, geometry):
    finger = describe_finger(geometry)
    time = np.tile(TIME, (5, 1))
    time[1, 15:] = np.nan
    load_time = np.tile([0.0, 5.0, 5.0, 9.0], (5, 1))
    load_torque = np.linspace(0.01, 0.05, 5)[:, None] * [1.0, 1.0, 0.2, 1.0]
    slots = {"stiffening_linear": 0.5}
    angles = simulate_joint_angle(parameters, finger, time, load_time, load_torque, slots)
    assert np.isnan(angles.joint_angle[1, :, 15:]).all()
    one = simulate_joint_angle(
        parameters.isel(trial=[1]), finger, TIME[:15], load_time[1], load_torque[1], slots
    )
    np.testing.assert_allclose(angles.joint_angle[1, :, :15], one.joint_angle[0], rtol=1e-12)


def test_a_delay_shows_the_past(parameters, geometry):
    finger = describe_finger(geometry)
    late = simulate_joint_angle(parameters, finger, TIME + 0.3, *LOAD, {"delay": 0.3})
    prompt = simulate_joint_angle(parameters, finger, TIME, *LOAD)
    np.testing.assert_allclose(late.joint_angle, prompt.joint_angle, rtol=1e-12)


@pytest.mark.parametrize("also", [{}, {"stiffening_square": 2.0}])
def test_a_frame_at_the_first_step_is_not_moved_by_a_lag_of_nothing(parameters, geometry, also):
    """The load comes later, so the frame shows the finger at rest: its slope is 0."""
    frames, load = np.linspace(0.0, 4.0, 41), ([0.0, 4.0], [0.04, 0.04])
    finger = describe_finger(geometry)

    def simulate(lag):
        return simulate_joint_angle(parameters, finger, frames, *load, also | lag, [{"lag": 1.0}])

    slope = simulate({}).joint_angle_by_direction.to_numpy()[..., 0]
    moved = simulate({"lag": 5e-4}).joint_angle - simulate({}).joint_angle
    assert not slope[..., 0].any()
    np.testing.assert_allclose(slope, moved.to_numpy() / 5e-4, atol=0.01 * np.abs(slope).max())


def test_gravity_is_in_balance_before_the_load(parameters, geometry):
    """Without flow nothing moves until the load comes, however the plane is tilted."""
    slots = {"tilt_across": 0.3, "tilt_along": -0.2, "flow_share": 0.0, "stiffening_square": 3.0}
    angles = simulate_joint_angle(parameters, describe_finger(geometry), TIME, *LOAD, slots)
    early = angles.joint_angle.to_numpy()[..., TIME <= 0.0]
    np.testing.assert_allclose(early, parameters.q_ini.to_numpy()[..., None] + 0 * early, rtol=1e-9)


def test_distal_joints_get_less_through_friction(parameters, geometry):
    same = parameters.copy(deep=True)
    for name in same:
        same[name] = same[name].isel(joint=[0, 0, 0]).assign_coords(joint=[1, 2, 3])
    slots = {"friction_bend": 0.3, "friction_width": 0.01}
    angles = simulate_joint_angle(same, describe_finger(geometry), TIME, [0.0], [0.04], slots)
    last = angles.joint_angle.to_numpy()[..., -1]
    assert (np.diff(last, axis=1) < -0.005).all()


def test_a_hard_stop_holds(parameters, geometry):
    slots = {"stop_angle": 0.2, "stop_stiffness": 1e4, "stop_width": 1e-4}
    angles = simulate_joint_angle(parameters, describe_finger(geometry), TIME, [0.0], [0.04], slots)
    assert angles.joint_angle.max() < 0.2 + 0.04 / 1e4 + 1e-6
    assert angles.joint_angle.max() > 0.199


def test_no_flow_below_the_threshold(parameters, geometry):
    slots = {"yield_torque": 0.06, "yield_width": 1e-3}
    time = np.array([60.0, 120.0])
    finger = describe_finger(geometry)
    angles = simulate_joint_angle(parameters, finger, time, [0.0], [0.04], slots)
    assert np.abs(np.diff(angles.joint_angle)).max() < 1e-6


def test_a_finger_without_declared_sizes_serves_where_none_is_needed(parameters):
    unknown = describe_unknown_finger(3)
    for slot in ("angle_cubic", "arm_law"):
        angles = simulate_joint_angle(parameters, unknown, TIME, *LOAD, {slot: 0.1})
        assert np.isfinite(angles.joint_angle).all()
    for slot in ("arm_scale", "tilt_along", "inertia_scale", "lens_radial"):
        with pytest.raises(Fault, match="not declared"):
            simulate_joint_angle(parameters, unknown, TIME, *LOAD, {slot: 0.1})


def test_what_cannot_be_integrated_is_nan_and_the_other_trials_stay(parameters, geometry):
    runaway = np.zeros((5, 3))
    runaway[[1, 3]] = 2e5  # sinh of thousands, and a trial after each in any share of the work
    angles = simulate_joint_angle(
        parameters, describe_finger(geometry), TIME, *LOAD, {"flow_sinh": runaway}
    ).joint_angle
    assert np.isnan(angles[[1, 3]]).all()
    assert np.isfinite(angles[[0, 2, 4]]).all()


def test_knots_that_rounding_keeps_apart_are_a_jump(parameters, geometry):
    both = [
        simulate_joint_angle(
            parameters, describe_finger(geometry), TIME, [0.0, 5.0, 5.0 + gap], [0.0, 0.0, 0.04]
        ).joint_angle
        for gap in (0.0, 1e-15)
    ]
    assert both[1].to_numpy() == pytest.approx(both[0].to_numpy(), abs=1e-12)


@pytest.mark.parametrize("slots", [{}, {"stiffening_square": 2.0, "lag": 0.3}])
def test_rows_of_a_dense_log_on_a_plateau_change_nothing(parameters, geometry, slots):
    dense = np.union1d(np.linspace(0.0, 5.0, 101), np.linspace(5.0, 9.0, 81))
    level = np.where(dense < 5.0, 0.04, 0.01)
    edge = [0.0, dense[dense < 5.0][-1], 5.0, 9.0]
    few = simulate_joint_angle(
        parameters, describe_finger(geometry), TIME, edge, [0.04, 0.04, 0.01, 0.01], slots, []
    )
    many = simulate_joint_angle(
        parameters, describe_finger(geometry), TIME, dense, level, slots, []
    )
    for name in few:
        np.testing.assert_array_equal(many[name], few[name])


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"time": TIME[::-1]}, "runs backwards"),
        ({"load_torque": [0.04, np.nan, 0.0, 0.0]}, r"load_torque\[1\] = nan"),
    ],
)
def test_impossible_input_is_refused(parameters, geometry, change, sentence):
    call = {"time": TIME, "load_time": LOAD[0], "load_torque": LOAD[1], **change}
    with pytest.raises(Fault, match=sentence):
        simulate_joint_angle(parameters, describe_finger(geometry), **call)


def test_impossible_parameters_and_fingers_are_refused(parameters, geometry):
    bad = parameters.assign(c_v=-parameters.c_v)
    with pytest.raises(Fault, match=r"c_v\[0, 0\] = -.*positive and finite \[N m s/rad\]"):
        simulate_joint_angle(bad, describe_finger(geometry), TIME, *LOAD)
    with pytest.raises(Fault, match="3 joints and the finger 2"):
        simulate_joint_angle_array(
            np.zeros((1, 3, 4)), build_slots(1, 3, {}), [], describe_unknown_finger(2), TIME, *LOAD
        )
