"""The documented example of an effect by entry point, found without being installed."""

import importlib
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.effect import Setting
from softfinger.mechanics.effects.model_file import ModelFile, build_model
from softfinger.mechanics.forward.simulate import (
    describe_unknown_finger,
    simulate_joint_angle_array,
)
from softfinger.mechanics.forward.slots import build_slots, build_tangent

EXAMPLE = Path(__file__).parents[3] / "docs/own_effect"


def describe_campaign(trials=7, joints=2):
    return Setting(
        trials=trials, joints=joints, interval=0.05, duration=10.0, torque=0.04,
        reversals=False, levels=True, rests=False, load_known=True, tension=True,
        stiffness=np.array([0.1, 0.2][:joints]), reach=np.array([0.5, 0.3][:joints]),
        number=np.arange(trials, dtype=float), memory=np.zeros((trials, joints)),
        largest_torque=np.full(trials, 0.04),
        rest_time=np.full(trials, np.nan),
    )  # fmt: skip


@pytest.fixture
def announce(tmp_path, monkeypatch):
    """Put a distribution with entry points on the path, as an installation would."""

    def write(lines: list[str]) -> None:
        info = tmp_path / "softfinger_warm_up-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text("Metadata-Version: 2.1\nName: x\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text("\n".join(["[softfinger.effects]", *lines]) + "\n")
        for folder in (tmp_path, EXAMPLE):
            monkeypatch.syspath_prepend(str(folder))
        importlib.invalidate_caches()
        list_effects.cache_clear()

    yield write
    for module in ("softfinger_warm_up", "softfinger_detent"):
        sys.modules.pop(module, None)
    monkeypatch.undo()
    list_effects.cache_clear()


def test_the_example_joins_the_catalogue_and_fills_slots(announce):
    project = tomllib.loads((EXAMPLE / "pyproject.toml").read_text())["project"]
    points = project["entry-points"]["softfinger.effects"]
    announce([f"{name} = {value}" for name, value in points.items()])
    effect = list_effects()["friction_warm_up"]
    assert isinstance(effect.build_forms(describe_campaign(trials=3)), str)
    content = ModelFile.model_validate(
        {
            "version": 1,
            "joint": "three_element",
            "torque": "constant_arm",
            "effects": [
                {
                    "id": "friction_warm_up",
                    "form": "exponential",
                    "priors": {"cold_friction": {"mean": 0.3, "sd": 0.1}},
                }
            ],
        }
    )
    model = build_model(content, describe_campaign())
    shared = np.array([0.3, np.log(2.0)])
    slots, absent = model.fill_slots(shared), model.fill_slots(shared * [0.0, 1.0])
    change = (slots.chain - absent.chain)[:, np.any(slots.chain != absent.chain, axis=0)]
    assert change[:, 0] == pytest.approx(0.3 * np.exp(-np.arange(7) / 2.0))


def test_an_effect_brings_physics_of_its_own(announce):
    """Places of depth a and pitch p: at rest under a torque u, k q + a sin(2π q/p) = u."""
    announce(["detent = softfinger_detent:EFFECT"])
    effect = list_effects()["detent"]
    (form,) = effect.build_forms(describe_campaign())
    values = {"detent_torque_nm": np.array(0.004), "detent_pitch_rad": np.array(0.3)}
    slots = build_slots(1, 2, form.slots(values))
    tangents = [build_tangent(1, 2, {name: 1.0}) for name in ("detent_torque", "detent_pitch")]
    own = np.tile([np.log(0.1), np.log(0.01), 20.0, 0.0], (1, 2, 1))  # a stiff dashpot: no flow
    series = describe_unknown_finger(2), [5.0], [0.0], [0.025]
    angle, gradient = simulate_joint_angle_array(own, slots, tangents, *series, by_own=False)
    q, turn = angle[0, 0, 0], 2 * np.pi * angle[0, 0, 0] / 0.3
    assert 0.1 * q + 0.004 * np.sin(turn) == pytest.approx(0.025, abs=1e-6)
    stiffness = 0.1 + 0.004 * np.cos(turn) * 2 * np.pi / 0.3
    by_pitch = 0.004 * np.cos(turn) * turn / 0.3
    expected = [-np.sin(turn) / stiffness, by_pitch / stiffness]
    np.testing.assert_allclose(gradient[0, 0, 0], expected, rtol=1e-4)


def test_an_entry_point_that_is_no_effect_is_refused(announce):
    announce(["wrong = math:pi"])
    with pytest.raises(Fault, match=r"math:pi.*is not an Effect"):
        list_effects()


def test_an_id_that_is_taken_is_refused(announce):
    announce(["again = softfinger.mechanics.effects.gravity:EFFECT"])
    with pytest.raises(Fault, match=r"'gravity'.*is taken"):
        list_effects()
