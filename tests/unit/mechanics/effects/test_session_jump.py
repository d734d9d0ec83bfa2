"""Sessions differ from the first one, each in its own way."""

import numpy as np

from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.effect import Setting
from softfinger.mechanics.effects.model import EffectModel, Piece

SESSION = np.array([1.0, 1.0, 2.0, 2.0, 3.0])


def build_setting(**covariates):
    count = len(SESSION)
    return Setting(
        trials=count, joints=2, interval=0.05, duration=8.0, torque=0.04, reversals=False,
        levels=False, rests=False, load_known=True, tension=True, stiffness=np.full(2, 0.1),
        reach=np.full(2, 0.4), number=np.arange(float(count)), memory=np.zeros((count, 2)),
        largest_torque=np.full(count, 0.04), rest_time=np.full(count, 60.0),
        covariates=covariates, geometry=False, masses=False,
    )  # fmt: skip


def test_a_later_session_has_its_own_ratio_and_the_first_has_none():
    setting = build_setting(session=SESSION)
    effect = list_effects()["session_jump"]
    form = next(f for f in effect.list_forms(setting) if f.name == "viscosities_by_session")
    model = EffectModel(setting, (Piece(effect, form, ((0,), (1,))),))
    names = [entry.name for entry in model.entries]
    assert "log_ratio_c_p_session_3_2" in names
    shared = np.zeros(len(names))
    shared[names.index("log_ratio_c_p_session_3_2")] = 0.3
    shared[names.index("log_ratio_c_v_session_2_1")] = -0.2
    moved = model.fill_slots(shared).joint - model.fill_slots(np.zeros(len(names))).joint
    expected = np.zeros_like(moved)
    expected[SESSION == 3.0, 1, 2] = 0.3
    expected[SESSION == 2.0, 0, 1] = -0.2
    np.testing.assert_allclose(moved, expected, atol=1e-12)


def test_without_sessions_there_is_no_such_form_and_a_session_is_no_temperature():
    effects = list_effects()
    for setting in (build_setting(), build_setting(session=np.ones(len(SESSION)))):
        forms = effects["session_jump"].list_forms(setting)
        assert not any(form.name.endswith("_by_session") for form in forms)
    alone = effects["temperature"].list_forms(build_setting(session=SESSION))
    assert isinstance(alone, str)
