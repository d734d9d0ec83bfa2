import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.forward.hooks import find_hooks
from softfinger.mechanics.forward.slot import SLOTS, Slot, declare, list_slots
from softfinger.mechanics.forward.slots import (
    build_slots,
    build_tangent,
    check_slots,
    find_moved_slots,
    stack_tangents,
)


def test_nulls_where_nothing_is_given_and_values_where_something_is():
    matrix = np.arange(9.0).reshape(3, 3)
    slots = build_slots(
        5, 3, {"arm_scale": [1.0, 2.0, 3.0], "lag": np.arange(5.0), "coupling_share": matrix}
    )
    names = list_slots("joint")
    arm = names.index("arm_scale")
    assert slots.joint.shape == (5, 3, len(names))
    assert slots.joint[4, :, arm].tolist() == [1.0, 2.0, 3.0]
    assert slots.pick(SLOTS["lag"]).tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
    np.testing.assert_array_equal(slots.pick(SLOTS["coupling_share"])[2], matrix)
    rest = np.delete(slots.joint, arm, axis=-1)
    nulls = [SLOTS[name].null for name in names if name != "arm_scale"]
    np.testing.assert_array_equal(rest, np.tile(nulls, (5, 3, 1)))


def test_tangents_are_zero_where_nothing_is_given():
    tangent = build_tangent(5, 3, {"flow_share": 1.0})
    assert tangent.joint.sum() == 15.0
    assert not tangent.chain.any()
    assert not tangent.coupling.any()


def find_kinds(slots, tangents):
    hooks = [hook for effect in list_effects().values() for hook in effect.hooks]
    moved = find_moved_slots(slots, stack_tangents(slots, tangents))
    return [hook.kind for hook in find_hooks(hooks, moved)]


def test_physics_is_on_where_a_value_or_a_direction_says_so():
    null = build_slots(5, 3, {})
    assert find_kinds(null, []) == []
    assert find_kinds(build_slots(5, 3, {"tilt_across": 0.1}), []) == ["balance"]
    assert find_kinds(null, [build_tangent(5, 3, {"yield_torque": 1.0})]) == ["flow"]


def test_a_name_is_declared_once():
    known = SLOTS["lag"]
    assert declare(lag=known) == (known.place,)  # its file may be read again
    with pytest.raises(Fault, match="'lag' is declared twice"):
        declare(lag=Slot("joint", "s", 0.0, "another"))


@pytest.mark.parametrize(
    ("build", "values", "sentence"),
    [
        (build_slots, {"arm": 1.0}, "unknown slot 'arm': it must be one of log_k_v, "),
        (build_slots, {"lag": np.nan}, r"slot 'lag' has a value that is not finite \[s\]"),
        (build_slots, {"lag": np.ones(3)}, r"'lag' has shape \(3,\): it must broadcast to \(5,\)"),
        (build_tangent, {"friction_driver": 1.0}, "'friction_driver' chooses a form"),
    ],
)
def test_what_is_no_slot_is_refused(build, values, sentence):
    with pytest.raises(Fault, match=sentence):
        build(5, 3, values)


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"second_time": 0.0}, r"second_time\[0, 0\] = 0: it must be positive and finite \[s\]"),
        ({"lag": -0.1}, r"lag\[0\] = -0.1: it must be finite and at least 0 \[s\]"),
        ({"springpot_exponent": 1.2}, "springpot_exponent"),
        ({"stop_width": 0.0}, "stop_width"),
    ],
)
def test_values_that_no_finger_has_are_refused(values, sentence):
    with pytest.raises(Fault, match=sentence):
        check_slots(build_slots(5, 3, values), values)
