"""What the virtual rig was given is named, under loads that its log states by steps."""

import json
import subprocess
import sys

import pytest

from softfinger.mechanics.effects.model_file import EffectEntry, ModelFile, write_model_file

CODE = "from softfinger.cli import main; main()"
RIG = """\
virtual_rig:
  {{n_trials: {trials}, level: angles, duration_s: 16.0, fps: 25.0,
   load_time_s: [0.0, 4.0, 4.0, 8.0, 8.0, 12.0, 12.0, 16.0],
   load_tension_n: [4.0, 4.0, 10.0, 10.0, 2.0, 2.0, 9.0, 9.0]}}
"""
LAG = {
    "id": "actuator_lag", "form": "first_order", "priors": {"lag_s": {"mean": 0.25, "sd": 0.01}},
    "spreads": {"lag_s": 0.3},
}  # fmt: skip
STIFFENING = {
    "id": "strain_stiffening", "form": "square_in_joint_angle", "joints": [1, 2, 3],
    "priors": {f"stiffening_per_rad2_{j}": {"mean": 1.5, "sd": 0.1} for j in (1, 2, 3)},
}  # fmt: skip


@pytest.fixture
def diagnose(tmp_path):
    def call(*arguments):
        command = [sys.executable, "-c", CODE, *arguments, "--config", tmp_path / "c.yaml"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr

    def run(effect, trials):
        (tmp_path / "c.yaml").write_text(RIG.format(trials=trials))
        entries = [EffectEntry(**effect)]
        parts = {"version": 1, "joint": "three_element", "torque": "constant_arm"}
        write_model_file(ModelFile(**parts, effects=entries), tmp_path / "model.yaml")
        call("virtual-rig", "--out", tmp_path / "rig", "--model", tmp_path / "model.yaml")
        out = tmp_path / "out"
        call("diagnose", tmp_path / "rig/campaign", "--out", out, "--no-mcmc", "--no-report")
        return json.loads((out / "verdict.json").read_text())

    return run


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effect", "trials", "parameter", "strength"),
    [(LAG, 16, "lag_s", 0.25), (STIFFENING, 1, "stiffening_per_rad2_1", 1.5)],
)
def test_what_the_rig_was_given_is_named(diagnose, effect, trials, parameter, strength):
    """The links have mass, so that inertia may be named beside it."""
    verdict = diagnose(effect, trials)
    found = {one["id"]: one for one in verdict["effects"]}
    assert verdict["decision"] == "named"
    assert set(found) - {"inertia"} == {effect["id"]}
    estimate = found[effect["id"]]["parameters"][parameter]
    assert abs(estimate["mean"] - strength) < 4.0 * estimate["sd"] + 0.02 * strength
    if "spreads" in effect:
        assert 0.15 < found[effect["id"]]["spread"][parameter] < 0.45
