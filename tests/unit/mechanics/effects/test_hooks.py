"""An effect's physics is its file's alone: machine code of no other file depends on it."""

import inspect
from types import ModuleType

import pytest

from softfinger.compiled import digest_function
from softfinger.compiled.digest import _Reader
from softfinger.mechanics.effects import MODULES, list_effects, wire_friction
from softfinger.mechanics.forward import hooks, trials

EFFECTS = "softfinger.mechanics.effects."


def list_effect_files(function):
    """The files of effects that a function's machine code is made from."""
    reader = _Reader()
    reader.describe(function)
    places = [part for part in reader.read() if part.startswith(EFFECTS)]
    return {place.split(".")[3] for place in places}


def test_the_kernel_is_made_from_no_effect():
    assert list_effect_files(trials.run_trials) == set()


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.EFFECT.id)
def test_an_effect_is_made_from_no_other(module):
    shared = {"cole_cole", "creep_spectrum", "load_fade", "load_response"}
    for hook in module.EFFECT.hooks:
        made_from = list_effect_files(hook.function)
        assert made_from
        assert made_from - shared <= {module.EFFECT.id}


def test_an_edit_changes_the_digest_of_what_calls_it_alone():
    source = inspect.getsource(wire_friction)
    edited = source.replace(
        "math.exp(-abs(motion) / width)", "math.exp(-2.0 * abs(motion) / width)"
    )
    assert edited != source
    module = ModuleType(wire_friction.__name__)
    exec(compile(edited, wire_friction.__file__, "exec"), module.__dict__)
    pairs = zip(wire_friction.EFFECT.hooks, module.EFFECT.hooks, strict=True)
    changed = {
        old.function.__name__
        for old, new in pairs
        if digest_function(old.function) != digest_function(new.function)
    }
    assert changed == {"turn_at_nodes", "turn_in_jump"}


@pytest.mark.parametrize(
    ("kind", "slots", "sentence"),
    [
        ("torque", ("lag",), "'torque' is not a kind of hook: it must be one of clock, log, "),
        ("balance", ("lag", "leg"), "a hook is switched by 'leg', which is not a slot: declare it"),
    ],
)
def test_a_hook_of_no_kind_or_switched_by_no_slot_is_refused(kind, slots, sentence):
    with pytest.raises(hooks.Fault, match=sentence):
        hooks.Hook(kind, print, slots)


def test_hooks_that_are_not_on_are_not_compiled():
    friction = list_effects()["wire_friction"].hooks
    found = hooks.compile_hooks(friction)
    assert found.count.tolist() == [kind in ("pull", "turn", "jump") for kind in hooks.KINDS]
    assert (found.address != 0).sum() == 3
    assert found.feedback
    assert found.curved
    assert not found.inertial
    assert hooks.compile_hooks(()).count.sum() == 0


def test_two_effects_that_change_the_log_are_refused():
    log = next(h for h in list_effects()["load_limit"].hooks if h.kind == "log")
    with pytest.raises(hooks.Fault, match="two effects change the load log"):
        hooks.compile_hooks((log, log))
