"""What the virtual rig was given is named, under loads that its log states by steps."""

import json
import subprocess
import sys

import numpy as np
import pandas as pd
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
SHORT_LAG = {
    "id": "actuator_lag", "form": "first_order", "priors": {"lag_s": {"mean": 0.05, "sd": 0.005}},
}  # fmt: skip
BETWEEN = """\
virtual_rig:
  {n_trials: 10, level: angles, duration_s: 16.0, fps: 30.0,
   load_time_s: [0.0, 0.53, 0.53, 4.07, 4.07, 8.02, 8.02, 12.06, 12.06, 16.0],
   load_tension_n: [0.0, 0.0, 4.0, 4.0, 10.0, 10.0, 2.0, 2.0, 9.0, 9.0]}
"""
TRIANGLE = """\
virtual_rig:
  {n_trials: 10, level: angles, duration_s: 36.0, fps: 30.0, angle_noise_sd_rad: 0.001,
   load_time_s: [0.0, 0.5, 4.5, 8.5, 12.5, 16.5, 20.5, 24.5, 28.5, 32.5],
   load_tension_n: [0.0, 0.0, 8.0, 0.0, 8.0, 0.0, 8.0, 0.0, 8.0, 0.0]}
"""
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

    def run(effects, rig, spoil=lambda campaign: None):
        (tmp_path / "c.yaml").write_text(rig)
        entries = [EffectEntry(**effect) for effect in effects]
        parts = {"version": 1, "joint": "three_element", "torque": "constant_arm"}
        write_model_file(ModelFile(**parts, effects=entries), tmp_path / "model.yaml")
        call("virtual-rig", "--out", tmp_path / "rig", "--model", tmp_path / "model.yaml")
        spoil(tmp_path / "rig/campaign")
        out = tmp_path / "out"
        call("diagnose", tmp_path / "rig/campaign", "--out", out, "--no-mcmc", "--no-report")
        return json.loads((out / "verdict.json").read_text())

    return run


def read_seldom(rate):
    """Read every trial's load so often a second [Hz], from a phase of its own on."""
    rng = np.random.default_rng(1)

    def spoil(campaign):
        for path in sorted((campaign / "load").glob("*.csv")):
            log = pd.read_csv(path)
            rows = np.append(0.0, np.arange(rng.uniform(0.0, 1.0 / rate), 16.0, 1.0 / rate))
            last = (
                np.searchsorted(log["time_s"], rows, side="right") - 1
            )  # steps from level to level
            read = {"time_s": rows, "tension_n": log["tension_n"].to_numpy()[last]}
            pd.DataFrame(read).to_csv(path, index=False)

    return spoil


def read_often(campaign):
    """Read every trial's load a hundred times a second, by a cell that scatters by 0.5 %."""
    rng = np.random.default_rng(1)
    for path in sorted((campaign / "load").glob("*.csv")):
        log = pd.read_csv(path)
        rows = np.arange(0.0, 36.0, 0.01)
        load = np.interp(rows, log["time_s"], log["tension_n"])
        read = {"time_s": rows, "tension_n": load * (1.0 + 0.005 * rng.normal(size=rows.size))}
        pd.DataFrame(read).to_csv(path, index=False)


@pytest.mark.slow
def test_a_log_that_is_read_often_shows_no_effect(diagnose):
    """The corners of its ramps are changes of load, though between two rows it hardly turns.

    The links have mass, so that inertia may be named, with their own mass: it was twice that.
    """
    verdict = diagnose((), TRIANGLE, read_often)
    assert verdict["decision"] in ("adequate", "named")
    for one in verdict["effects"]:
        assert one["id"] == "inertia"
        scale = one["parameters"]["inertia_scale"]
        assert abs(scale["mean"] - 1.0) < 3.0 * scale["sd"]


@pytest.mark.slow
@pytest.mark.parametrize("rate", [10.0, 30.0])
@pytest.mark.parametrize("effects", [(), (SHORT_LAG,)], ids=["clean", "lag"])
def test_a_log_that_is_read_seldom_hides_no_effect_and_shows_none(diagnose, rate, effects):
    """Steps came at any moment between two of its rows, and false effects explained them."""
    verdict = diagnose(effects, BETWEEN, read_seldom(rate))
    assert {one["id"] for one in verdict["effects"]} == {effect["id"] for effect in effects}
    assert verdict["decision"] == ("named" if effects else "adequate")
    assert "clock_offset" in {one["id"] for one in verdict["measurement"]}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effect", "trials", "parameter", "strength"),
    [(LAG, 16, "lag_s", 0.25), (STIFFENING, 1, "stiffening_per_rad2_1", 1.5)],
)
def test_what_the_rig_was_given_is_named(diagnose, effect, trials, parameter, strength):
    """The links have mass, so that inertia may be named beside it."""
    verdict = diagnose((effect,), RIG.format(trials=trials))
    found = {one["id"]: one for one in verdict["effects"]}
    assert verdict["decision"] == "named"
    assert set(found) - {"inertia"} == {effect["id"]}
    estimate = found[effect["id"]]["parameters"][parameter]
    assert abs(estimate["mean"] - strength) < 4.0 * estimate["sd"] + 0.02 * strength
    if "spreads" in effect:
        assert 0.15 < found[effect["id"]]["spread"][parameter] < 0.45
