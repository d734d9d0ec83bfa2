"""Foreign laws: there are enough, each has a reason, and those without a table are right."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from softfinger.concealed.effects import CATALOGUES, Dose
from softfinger.concealed.effects.load_limit import limit_rate, saturate
from softfinger.concealed.foreign import FOREIGN
from softfinger.concealed.foreigners import draw_foreign
from softfinger.concealed.forward import simulate_trial, vary
from softfinger.concealed.protocols import Load, refine_load
from softfinger.concealed.registry import EFFECTS


def test_every_effect_of_both_catalogues_has_three_foreign_laws_and_a_reason_for_each():
    count = Counter(law.id for law in FOREIGN.values())
    assert set(count) == set(CATALOGUES["second"])
    assert min(count.values()) >= 3
    assert all(law.law and law.why for law in FOREIGN.values())
    assert set(FOREIGN) < set(EFFECTS)


def test_a_foreign_law_is_not_the_effects_own(individual, rig, circumstances, time):
    """At strengths that move the finger as far the two curves differ."""
    for name in ("strain_stiffening/plateau", "moment_arm/guides", "stress_nonlinear_flow/plateau"):
        own = EFFECTS[EFFECTS[name].id]
        joints = () if own.joints == "chain" else (0, 1, 2)
        plain = simulate_trial(individual, {}, circumstances, rig, time)
        moved = [
            simulate_trial(individual, {key: Dose(e.typical, {}, joints)}, circumstances, rig, time)
            - plain
            for key, e in ((name, EFFECTS[name]), (own.id, own))
        ]
        likeness = (moved[0] * moved[1]).sum() / np.sqrt(np.prod([(m**2).sum() for m in moved]))
        assert 0.5 < likeness < 0.9999


@pytest.fixture(scope="module")
def suite():
    return draw_foreign(3, 120, catalogue="second")


def test_the_suite_of_foreign_laws_is_balanced(suite):
    laws = Counter(name for spec in suite for name in spec.effects)
    assert set(laws) == set(FOREIGN)
    pairs = [spec for spec in suite if len(spec.effects) == 2]
    assert len(pairs) == 30
    assert all(len({FOREIGN[name].id for name in spec.effects}) == 2 for spec in pairs)
    varies = [spec for spec in suite if spec.scatters]
    assert len(varies) == 30
    assert all(0.1 <= spec.scatters[0] <= 0.3 for spec in varies)
    for spec in suite:
        assert spec.trials >= max(FOREIGN[name].trials for name in spec.effects)


def test_laws_of_effects_that_the_catalogue_lacks_are_not_drawn():
    for spec in draw_foreign(3, 60, longest=20):
        assert {FOREIGN[name].id for name in spec.effects} <= set(CATALOGUES["first"])
        assert spec.trials <= 20


def test_a_strength_varies_between_trials_as_a_log_normal(circumstances):
    doses = {"gravity": Dose(0.2, scatter=0.3), "inertia": Dose(4.0)}
    rng = np.random.default_rng(1)
    lucky = [replace(circumstances, luck=tuple(rng.uniform(size=3))) for _ in range(2000)]
    varied = [vary(doses, trial) for trial in lucky]
    logs = np.log([v["gravity"].strength / 0.2 for v in varied])
    assert logs.mean() == pytest.approx(0.0, abs=0.03)
    assert logs.std() == pytest.approx(0.3, rel=0.05)
    assert {v["inertia"].strength for v in varied} == {4.0}


def test_a_slow_drive_ramps_to_what_it_is_asked_for():
    load = Load(np.array([0.0, 0.0, 5.0, 5.0]), np.array([0.0, 6.0, 6.0, 1.0]))
    slow = limit_rate(load, 3.0)
    time = np.array([0.0, 1.0, 2.0, 3.0, 5.0, 6.0, 9.0])
    exact = [0.0, 3.0, 6.0, 6.0, 6.0, 3.0, 1.0]
    np.testing.assert_allclose(slow.value(time + 1e-9), exact, atol=1e-6)


def test_a_slow_drive_follows_a_slow_ramp_and_lags_a_fast_one():
    ramp = Load(np.array([0.0, 10.0]), np.array([0.0, 5.0]))
    time = np.linspace(0.1, 9.9, 40)
    np.testing.assert_allclose(limit_rate(ramp, 2.0).value(time), 0.5 * time, atol=1e-9)
    np.testing.assert_allclose(limit_rate(ramp, 0.2).value(time), 0.2 * time, atol=1e-9)


def test_a_limit_is_not_passed_and_a_small_load_is_reached():
    load = Load(np.array([0.0, 10.0]), np.array([0.0, 12.0]))
    limited = saturate(load, 6.0, 8.0)
    assert limited.tension.max() < 6.0
    assert limited.value(np.array([2.0]))[0] == pytest.approx(2.4, rel=1e-3)
    np.testing.assert_allclose(
        refine_load(load, 0.25).value(np.linspace(0, 10, 33)), 1.2 * np.linspace(0, 10, 33)
    )


def test_backlash_follows_only_after_its_gap(rig, circumstances):
    swing = 0.3 * np.sin(np.linspace(0.0, 4.0 * np.pi, 2001))[:, None] * np.ones(3)
    dose = Dose(0.1, {}, (1,))
    seen = EFFECTS["joint_play/backlash"].record(swing, swing[:, 0], dose, circumstances, rig)
    np.testing.assert_array_equal(seen[:, [0, 2]], swing[:, [0, 2]])
    assert np.abs(seen[:, 1] - swing[:, 1]).max() == pytest.approx(0.05)
    assert np.ptp(seen[1000:, 1]) == pytest.approx(0.5, abs=1e-3)  # 2 · 0.3 − 0.1


def test_a_lens_without_strength_shows_what_is_there(rig, circumstances):
    angle = np.array([[0.1, 0.4, 0.2], [0.3, 0.2, 0.7]])
    for name in ("orthographic", "moustache", "keystone"):
        law = EFFECTS[f"lens_distortion/{name}"]
        seen = law.record(angle, np.zeros(2), Dose(0.0), circumstances, rig)
        np.testing.assert_allclose(seen, angle, atol=1e-6)


def test_a_membrane_is_a_share_of_each_trials_own_stiffness(individual, rig, circumstances):
    """With both stiffnesses doubled and the load as well, the motion at rest is the same."""
    individual[2] = 30.0
    dose = {"joint_coupling/membrane": Dose(0.3, {}, (0, 1))}
    late, step = np.array([60.0]), Load(np.zeros(2), np.array([0.0, 4.0]))
    soft = simulate_trial(individual, dose, replace(circumstances, load=step), rig, late)
    individual[0] += np.log(2.0)
    step = Load(np.zeros(2), np.array([0.0, 8.0]))
    stiff = simulate_trial(individual, dose, replace(circumstances, load=step), rig, late)
    np.testing.assert_allclose(stiff, soft, rtol=1e-6)
