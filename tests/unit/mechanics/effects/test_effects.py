from dataclasses import replace

import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.mechanics import effects
from softfinger.mechanics.chain import compute_inertia_coefficients
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.effect import Setting
from softfinger.mechanics.effects.model import EffectModel, Piece
from softfinger.mechanics.effects.places import list_places
from softfinger.mechanics.forward.hooks import find_hooks
from softfinger.mechanics.forward.simulate import (
    describe_finger,
    describe_unknown_finger,
    simulate_joint_angle_array,
)
from softfinger.mechanics.forward.slots import SLOTS, build_slots
from softfinger.mechanics.geometry import FingerGeometry

TRIALS, JOINTS = 4, 3
CATALOGUE = {
    "second_retardation", "fractional_creep", "strain_stiffening", "wire_friction", "moment_arm",
    "actuator_lag", "fatigue_softening", "temperature", "preload_memory", "contact_stop",
    "yield_threshold", "stress_nonlinear_flow", "joint_coupling", "gravity", "inertia",
    "camera_delay", "lens_distortion", "session_jump", "load_limit", "load_gain", "joint_play",
    "thinning_damper", "softening_within_trial",
}  # fmt: skip


def build_setting(**changes):
    content = {
        "trials": TRIALS, "joints": JOINTS, "interval": 0.05, "duration": 8.0, "torque": 0.04,
        "reversals": True, "levels": True, "rests": True, "load_known": True, "tension": True,
        "stiffness": np.array([0.1, 0.12, 0.15]), "reach": np.array([0.4, 0.35, 0.3]),
        "number": np.arange(TRIALS, dtype=float), "memory": np.full((TRIALS, JOINTS), 0.1),
        "largest_torque": np.array([0.02, 0.03, 0.04, 0.05]),
        "rest_time": np.array([np.inf, 20.0, 30.0, 25.0]),
        "covariates": {"temperature_c": np.array([20.0, 22.0, 21.0, 25.0])},
        "geometry": True, "masses": True, "camera": True,
    }  # fmt: skip
    return Setting(**{**content, **changes})


def list_forms(setting):
    return list(generate_forms(setting))


def generate_forms(setting):
    for effect in list_effects().values():
        forms = effect.build_forms(setting)
        if not isinstance(forms, str):
            yield from ((effect, form) for form in forms)


def fill(form, amplitude):
    """Physical values of a form: amplitudes at a number of prior sd, the rest at their means."""
    pairs = (JOINTS, JOINTS)
    shapes = {"chain": (), "joint": (JOINTS,), "pair": pairs, "neighbours": pairs}
    values = {}
    for p in form.parameters:
        value = amplitude * p.sd if p.amplitude else np.exp(p.mean) if p.log else p.mean
        values[p.name] = np.full(shapes[p.per], value)
    return form.slots(values)


@pytest.fixture(scope="module")
def trials():
    geometry = FingerGeometry.uniform([0.025] * JOINTS, [0.005] * JOINTS, 0.008, 0.005)
    own = np.array([[-2.4, -3.7, 2.9, 0.02], [-2.3, -3.6, 3.1, 0.01], [-1.9, -3.9, 3.3, 0.03]])
    time = np.tile(np.linspace(0.1, 8.0, 9), (TRIALS, 1))
    load_time = np.tile([0.0, 5.0, 5.0, 8.0], (TRIALS, 1))
    load = np.outer([0.01, 0.02, 0.03, 0.04], [1.0, 1.0, 0.2, 0.2])
    finger = describe_finger(geometry)

    def simulate(slots):
        parameters = np.tile(own, (TRIALS, 1, 1))
        filled = build_slots(TRIALS, JOINTS, slots)
        series = time, load_time, load
        return simulate_joint_angle_array(parameters, filled, [], finger, *series, by_own=False)[0]

    return simulate


def test_the_catalogue_is_complete():
    assert set(list_effects()) >= CATALOGUE
    assert {module.EFFECT.id for module in effects.MODULES} == CATALOGUE


@pytest.mark.parametrize(
    "case", list_forms(build_setting()), ids=lambda c: f"{c[0].id}-{c[1].name}"
)
def test_a_form_is_absent_at_null_and_acts_beyond(case, trials):
    effect, form = case
    base = trials({})
    np.testing.assert_allclose(trials(fill(form, 0.0)), base, atol=2e-5)
    if effect.id != "inertia":  # its motion is over before the first of these times
        # terms of one sign let a coupling grow until a joint runs away: those angles are NaN
        assert np.nanmax(np.abs(trials(fill(form, 0.3)) - base)) > 1e-4


@pytest.mark.parametrize(
    "case", list_forms(build_setting()), ids=lambda c: f"{c[0].id}-{c[1].name}"
)
def test_a_form_has_amplitudes_with_null_at_zero(case):
    _, form = case
    amplitudes = [p for p in form.parameters if p.amplitude]
    assert amplitudes
    for p in amplitudes:
        assert p.mean == 0.0
        assert p.low <= p.starts[0] <= p.high
        assert not p.log
    assert set(fill(form, 0.1)) <= set(SLOTS)


@pytest.mark.parametrize(
    "case", list_forms(build_setting()), ids=lambda c: f"{c[0].id}-{c[1].name}"
)
def test_an_effect_is_negligible_where_all_its_amplitudes_lie_below_their_floors(case):
    effect, form = case
    per = {p.per for p in form.parameters}
    pairs = "pair" in per or "neighbours" in per
    places = ((0, 1), (1, 2)) if pairs else ((0,), (1,)) if "joint" in per else ()
    model = EffectModel(build_setting(), (Piece(effect, form, places),))
    floors = np.array([e.parameter.floor for e in model.entries])[model.amplitudes]
    assert floors.min() > 0.0
    shared = model.shared_prior[0].copy()
    shared[model.amplitudes] = -0.9 * floors
    assert model.list_negligible(shared) == {effect.id}
    shared[np.flatnonzero(model.amplitudes)[-1]] *= -1.2
    assert model.list_negligible(shared) == frozenset()


@pytest.mark.parametrize(
    ("changes", "refused"),
    [
        ({"load_known": False}, {"actuator_lag", "camera_delay", "load_limit"}),
        ({"tension": False}, {"moment_arm", "wire_friction"}),
        ({"masses": False}, {"gravity"}),
        ({"covariates": {}}, {"temperature"}),
        ({"trials": 1}, {"fatigue_softening", "temperature", "session_jump", "load_gain"}),
        ({"camera": False}, {"lens_distortion"}),
        ({"joints": 1}, {"joint_coupling"}),
    ],
)
def test_what_a_campaign_cannot_show_is_refused_with_a_reason(changes, refused):
    setting = build_setting(**changes)
    answers = {name: e.build_forms(setting) for name, e in list_effects().items()}
    assert {name for name, answer in answers.items() if isinstance(answer, str)} == refused


def test_a_specimen_shows_no_effect_of_the_finger_alone():
    setting = build_setting(joints=1, specimen=True)
    answers = {name: e.list_forms(setting) for name, e in list_effects().items()}
    refused = {name: answer for name, answer in answers.items() if isinstance(answer, str)}
    assert set(refused) == {
        "wire_friction", "moment_arm", "gravity", "joint_coupling", "lens_distortion"
    }  # fmt: skip
    assert refused["lens_distortion"] == "the campaign is of a specimen, which has no lens"


def test_a_plug_in_must_be_an_effect(monkeypatch):
    class Point:
        value = "mine:thing"

        @staticmethod
        def load():
            return object()

    monkeypatch.setattr(effects, "entry_points", lambda group: [Point])
    effects.list_effects.cache_clear()
    try:
        with pytest.raises(Fault, match="mine:thing"):
            effects.list_effects()
    finally:
        effects.list_effects.cache_clear()


@pytest.mark.parametrize(("step_gap", "frames"), [(0.0, 0.005), (4e-4, 0.008), (0.01, 0.02)])
def test_a_shift_in_time_is_worth_a_name_where_the_log_states_when_its_steps_are(step_gap, frames):
    setting = build_setting(step_gap=step_gap)
    for name in ("actuator_lag", "camera_delay"):
        for form in list_effects()[name].build_forms(setting):
            # of a free response the first share arrives a quarter of a frame late
            late = 0.25 * setting.interval if form.is_free else 1.0
            assert form.parameters[0].floor * late == pytest.approx(frames * setting.interval)


@pytest.mark.parametrize(("gap", "forms"), [(1.0, 5), (3.0, 1)])
def test_how_a_load_rises_is_asked_of_logs_that_show_it(gap, forms):
    """A free law bent the line between two rows into a step."""
    setting = build_setting()
    setting = replace(setting, step_gap=gap * setting.interval)
    names = [form.name for form in list_effects()["load_limit"].build_forms(setting)]
    assert (len(names), names[0]) == (forms, "saturation")


@pytest.mark.parametrize("way", ["across", "along"])
def test_a_tilt_about_one_axis_is_reported_as_an_angle_and_with_its_way(way):
    gravity = list_effects()["gravity"]
    form = next(form for form in gravity.build_forms(build_setting()) if form.name == way)
    model = EffectModel(build_setting(), (Piece(gravity, form, ()),))
    reported = model.entries[0].report(np.array([-0.1, 0.2]))
    np.testing.assert_array_equal(reported.pop("tilt_rad"), [0.1, 0.2])
    np.testing.assert_array_equal(reported.pop(f"tilt_{way}_rad"), [-0.1, 0.2])
    assert not reported


def test_what_a_chain_shows_of_its_masses_is_free():
    rods = FingerGeometry.uniform([0.025] * JOINTS, [0.005] * JOINTS, 0.008, 0.005)
    loaded = replace(
        rods,
        link_mass=np.array([0.005, 0.006, 0.012]),
        link_centre=np.array([0.015, 0.01, 0.024]),
        link_inertia=np.array([1e-7, 4e-7, 3e-7]),
    )
    ratio = compute_inertia_coefficients(loaded) / compute_inertia_coefficients(rods)
    assert ratio[0, 2] == pytest.approx(ratio[1, 2])
    form = next(f for f in list_effects()["inertia"].build_forms(build_setting()) if f.is_free)
    values = {
        "inertia_scale": np.array(20.0),
        "own_ratio": np.diagonal(ratio),
        "moment_ratio": np.append(1.0, np.diagonal(ratio, 1)),
    }
    own = np.tile([-2.3, -5.5, 3.0, 0.02], (1, JOINTS, 1))
    series = np.linspace(0.02, 1.0, 50)[None], np.array([[0.0, 1.0]]), np.array([[0.04, 0.04]])

    def simulate(geometry, slots):
        finger, filled = describe_finger(geometry), build_slots(1, JOINTS, slots)
        return simulate_joint_angle_array(own, filled, [], finger, *series, by_own=False)[0]

    expected = simulate(loaded, {"inertia_scale": 20.0})
    np.testing.assert_allclose(simulate(rods, form.slots(values)), expected, atol=1e-6)
    assert np.abs(simulate(rods, {"inertia_scale": 20.0}) - expected).max() > 0.01


def test_a_wire_that_wraps_bends_and_guides_loses_a_share_for_each_radian():
    geometry = FingerGeometry.uniform([0.025] * JOINTS, [0.005] * JOINTS, 0.008, 0.005)
    friction = list_effects()["wire_friction"]
    form = next(
        form for form in friction.build_forms(build_setting()) if form.name == "wrap_by_load"
    )
    values = {"friction_coefficient": 0.25, "guide_rad": 0.4, "turning_width": 1e-4}
    own = np.tile([np.log(0.1), -5.0, 15.0, 0.02], (1, JOINTS, 1))  # a stiff dashpot: no flow
    series = np.array([[8.0]]), np.array([[0.0, 8.0]]), np.array([[0.04, 0.04]])
    filled = build_slots(1, JOINTS, form.slots(values))
    finger = describe_finger(geometry)
    angle = simulate_joint_angle_array(own, filled, [], finger, *series, by_own=False)[0].ravel()
    wrapped = np.cumsum(angle + 0.4)
    np.testing.assert_allclose(0.1 * (angle - 0.02), 0.04 * np.exp(-0.25 * wrapped), rtol=1e-4)


def test_a_membrane_pulls_two_neighbours_by_a_law_of_their_difference():
    coupling = list_effects()["joint_coupling"]
    form = next(form for form in coupling.build_forms(build_setting()) if form.is_free)
    values = {p.name: np.zeros((JOINTS, JOINTS)) for p in form.parameters}
    values["coupling"][1, 2], values["membrane_law_1"][1, 2] = 0.4, 0.25
    values["membrane_law_2"][1, 2] = -0.15
    stiffness = np.array([0.1, 0.08, 0.3])
    own = np.array([[[np.log(k), -5.0, 15.0, 0.02] for k in stiffness]])  # a dashpot that is stiff
    series = np.array([[8.0]]), np.array([[0.0, 8.0]]), np.array([[0.04, 0.04]])
    filled = build_slots(1, JOINTS, form.slots(values))
    finger = describe_unknown_finger(JOINTS)
    angle = simulate_joint_angle_array(own, filled, [], finger, *series, by_own=False)[0].ravel()
    x = angle - 0.02
    apart = x[2] - x[1]
    place = 2.0 * abs(apart) / 0.4 - 1.0  # of the law's reach
    law = 0.25 * (place + 1.0) - 0.15 * (2.0 * place**2 - 2.0)
    pull = (0.4 + law) * np.sqrt(stiffness[1] * stiffness[2]) * apart
    expected = 0.04 + pull * np.array([0.0, 1.0, -1.0])
    np.testing.assert_allclose(stiffness * x, expected, rtol=1e-4)
    assert abs(pull) > 0.005


def test_a_law_of_the_motion_needs_more_than_one_course_in_time():
    stop = list_effects()["contact_stop"]
    for several in (build_setting(levels=True, trials=1), build_setting(levels=False)):
        assert any(form.is_free for form in stop.list_forms(several))
    assert "one trial under one load" in stop.list_forms(build_setting(levels=False, trials=1))
    creep = list_effects()["second_retardation"].list_forms(build_setting(levels=False, trials=1))
    assert any(form.is_free for form in creep)


@pytest.mark.parametrize(("levels", "joints"), [(False, 3), (True, 1), (True, 3)])
def test_a_free_response_of_the_load_needs_loads_and_joints(levels, joints):
    lag = list_effects()["actuator_lag"]
    forms = lag.list_forms(build_setting(levels=levels, joints=joints))
    assert any(form.is_free for form in forms) == (levels and joints > 1)


def test_a_hook_that_effects_share_is_called_once():
    hooks = [hook for effect in list_effects().values() for hook in effect.hooks]
    assert len(find_hooks(hooks, {"spectrum"})) == 1


@pytest.mark.parametrize(
    ("levels", "joints", "shared"),
    [(False, 1, True), (False, 3, False), (True, 1, False), (True, 3, False)],
)
def test_the_response_of_one_joint_to_one_load_is_in_the_place_of_creep(levels, joints, shared):
    setting = build_setting(levels=levels, joints=joints)
    known = list_effects()
    places = {
        name: known[name].find_place(setting) for name in ("actuator_lag", "second_retardation")
    }
    assert (len(set(places.values())) == 1) == shared


def list_linear_forms():
    found = [
        (effect, part)
        for effect, form in list_forms(build_setting())
        for part in (form, form.finer)
    ]
    return [(effect, part) for effect, part in found if part is not None and part.linear]


def test_slots_of_linear_forms_have_the_same_slopes_everywhere():
    """Their tangents are kept, so they may depend on nothing."""
    found = list_linear_forms()
    assert len({effect.id for effect, _ in found}) > 10
    for effect, form in found:
        setting = build_setting()
        piece = Piece(effect, form, list_places(form.parameters, setting))
        slopes = []
        for seed in (1, 2):
            model = EffectModel(setting, (piece,))
            mean, sd = model.shared_prior
            shared = mean + sd * np.abs(np.random.default_rng(seed).normal(size=len(sd)))
            terms = np.flatnonzero([entry.parameter.term for entry in model.entries])
            slopes.append(model.fill_tangents(shared.clip(model.low, model.high), terms))
        for one, other in zip(*slopes, strict=True):
            for part, again in zip(one, other, strict=True):
                np.testing.assert_allclose(part, again, rtol=1e-6, atol=1e-6, err_msg=form.name)


@pytest.mark.parametrize("name", ["stress_nonlinear_flow", "yield_threshold"])
def test_a_law_of_the_load_needs_more_than_one_load(name):
    effect = list_effects()[name]
    assert "another viscosity" in effect.list_forms(build_setting(trials=1, levels=False))
    for several in ({"trials": 4, "levels": False}, {"trials": 1, "levels": True}):
        assert not isinstance(effect.list_forms(build_setting(**several)), str)


def test_the_free_law_of_place_contains_every_form_of_place():
    forms = {
        form.name: form for form in list_effects()["lens_distortion"].build_forms(build_setting())
    }
    free = _name_parameters(forms["free_of_place"])
    for name in ("radial", "radial_off_centre", "aslant", "aslant_off_centre"):
        assert _name_parameters(forms[name]) <= free


def _name_parameters(form):
    return {parameter.name for parameter in form.parameters}


def test_an_early_stop_is_about_as_likely_as_a_late_one():
    """Under one step an early one was a false moment arm."""
    forms = list_effects()["contact_stop"].build_forms(build_setting())
    for form in forms:
        place = next(p for p in form.parameters if p.name == "stop_share_of_reach")
        early, late = (-0.5 * ((share - place.mean) / place.sd) ** 2 for share in (0.3, 0.85))
        assert abs(early - late) < 1.0
        assert min(place.starts) <= 0.3
    assert "hertzian" in [form.name for form in forms]
