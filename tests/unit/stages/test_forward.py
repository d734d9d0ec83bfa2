"""The forward model that propagation gets: from the posterior and the model file alone."""

import numpy as np
import pytest
import xarray as xr

from softfinger.faults import Fault
from softfinger.inference.motion import move_paper_joint
from softfinger.inference.setting_table import tabulate_setting
from softfinger.mechanics.effects.effect import Setting
from softfinger.mechanics.forward.simulate import describe_unknown_finger
from softfinger.stages.forward import open_mover

CONFIG = {"draws": 2}
TRIALS = ["first", "second"]
SETTING = Setting(
    trials=2, joints=1, interval=0.05, duration=10.0, torque=0.04, reversals=False, levels=True,
    rests=False, load_known=True, tension=False, stiffness=np.array([0.1]), reach=np.array([0.5]),
    number=np.arange(2.0), memory=np.zeros((2, 1)), largest_torque=np.full(2, 0.04),
    rest_time=np.full(2, np.nan),
)  # fmt: skip
MODEL = """\
version: 1
joint: three_element
torque: constant_arm
effects:
- {id: second_retardation, form: own_compliance, joints: [1]}
"""


@pytest.fixture
def angles():
    return xr.Dataset(coords={"trial": TRIALS})


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "model.yaml"
    path.write_text(MODEL)
    return path


@pytest.fixture
def posterior():
    """Two draws of the effect: absent, and a third of the stiffness over 2 s."""
    names = ["second_retardation.compliance_share_1", "second_retardation.retardation_time_s"]
    dims = ("chain", "draw", "effect_parameter")
    effect = xr.Dataset({"effect": (dims, [[[0.0, 2.0], [0.3, 2.0]]])}, {"effect_parameter": names})
    constant = tabulate_setting(SETTING, describe_unknown_finger(1), TRIALS)
    return xr.DataTree.from_dict({"posterior": effect, "constant_data": constant})


def test_effects_move_new_trials_without_the_recordings(angles, posterior, model):
    move = open_mover(angles, posterior, CONFIG, model, np.random.default_rng(4))
    own = np.array([[[-2.4, -3.6, 2.8, 0.02]]] * 2)
    time, load = np.array([0.0, 1.0, 8.0]), (np.array([0.0, 8.0]), np.array([0.04, 0.04]))
    moved = move(own, np.array([1, 0]), np.array([0, 1]), time, *load)
    paper = move_paper_joint(own, None, None, time, *load)
    np.testing.assert_allclose(moved[1], paper[1], atol=2e-5)
    assert moved[0, 0, 0] == pytest.approx(paper[0, 0, 0], abs=2e-5)
    further = 0.3 * 0.04 * np.exp(2.4) * -np.expm1(-time[1:] / 2)
    np.testing.assert_allclose(moved[0, 0, 1:] - paper[0, 0, 1:], further, rtol=0.5)


def test_without_effects_it_is_the_papers_joint(angles):
    base = xr.DataTree.from_dict({"posterior": xr.Dataset()})
    assert open_mover(angles, base, CONFIG, None, np.random.default_rng(4)) is move_paper_joint


def test_posterior_and_model_must_belong_together(angles, posterior, model):
    with pytest.raises(Fault, match="no model file was given"):
        open_mover(angles, posterior, CONFIG, None, np.random.default_rng(4))
    base = xr.DataTree.from_dict({"posterior": xr.Dataset()})
    with pytest.raises(Fault, match="was fitted without it"):
        open_mover(angles, base, CONFIG, model, np.random.default_rng(4))


def test_a_posterior_of_an_older_version_is_named(angles, posterior, model):
    del posterior["constant_data"]
    with pytest.raises(Fault, match="fitted by an older version; fit again"):
        open_mover(angles, posterior, CONFIG, model, np.random.default_rng(4))


def test_an_effect_that_differs_between_trials_differs_in_new_ones(angles, posterior, model):
    """It differs about the posterior's own draw; an effect that is absent stays so."""
    own = np.array([[[-2.4, -3.6, 2.8, 0.02]]] * 2)
    time, load = np.array([0.0, 1.0, 8.0]), (np.array([0.0, 8.0]), np.array([0.04, 0.04]))
    same, varied = [], []
    for found, more in ((same, ""), (varied, ", spreads: {compliance_share: 0.5}")):
        model.write_text(MODEL.replace("joints: [1]", "joints: [1]" + more))
        for seed in range(40):
            move = open_mover(angles, posterior, CONFIG, model, np.random.default_rng(seed))
            found.append(move(own, np.array([1, 0]), np.array([0, 1]), time, *load))
    same, varied = np.array(same), np.array(varied)
    assert np.ptp(same, axis=0).max() == 0.0
    np.testing.assert_allclose(varied[:, 1], same[:, 1])
    moved = same[0, 0, 0, -1] - same[0, 1, 0, -1]
    assert np.std(varied[:, 0, 0, -1]) == pytest.approx(0.5 * moved, rel=0.3)
