import numpy as np

from softfinger.mechanics.effects.model_file import EffectEntry, ModelFile
from softfinger.virtual_rig.motion import draw_motion


def test_truth_starts_at_rest_and_bends_with_the_load(config):
    truth = draw_motion(config, seed=2)
    assert truth.joint_angle.dims == ("trial", "joint", "frame")
    assert truth.joint_angle.shape == (5, 3, 7)
    np.testing.assert_allclose(truth.time, np.arange(7) / 10)
    np.testing.assert_allclose(truth.joint_angle.isel(frame=0), truth.q_ini, atol=1e-12)
    assert (truth.joint_angle.isel(frame=3) > truth.q_ini + 0.02).all()


def test_the_first_trials_do_not_depend_on_how_many_follow(config):
    few, many = draw_motion(config | {"n_trials": 2}, 2), draw_motion(config, 2)
    assert few.equals(many.isel(trial=slice(2)))


def test_the_load_and_the_wires_geometry_matter(config):
    truth = draw_motion(config, 2)
    slack = draw_motion(config | {"load_tension_n": [0.0] * 4}, 2)
    np.testing.assert_allclose(slack.joint_angle - slack.q_ini, 0.0, atol=1e-9)
    paper = draw_motion(config | {"wire_geometry": "paper"}, 2)
    assert (paper.joint_angle > truth.joint_angle).isel(frame=slice(1, None)).all()


def build_model_file(**spreads):
    retardation = EffectEntry(
        id="second_retardation",
        form="own_compliance",
        joints=[1],
        priors={
            "compliance_share_1": {"mean": 0.3, "sd": 0.02},
            "retardation_time_s": {"median": 0.3, "log_sd": 0.1},
        },
        spreads=spreads,
    )
    return ModelFile(version=1, joint="three_element", torque="constant_arm", effects=[retardation])


def test_an_effect_that_differs_between_trials_differs_in_each(config):
    plain = draw_motion(config, 2)
    same, varied = (
        (draw_motion(config, 2, file).joint_angle - plain.joint_angle).isel(joint=0, frame=3).values
        for file in (build_model_file(), build_model_file(compliance_share=0.2))
    )
    share = varied / same
    assert len(set(np.round(share, 6))) == len(share)
    assert 0.05 < share.std() < 0.6
