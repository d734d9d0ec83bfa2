"""A campaign with every switch off holds no evidence for any effect, in any protocol."""

import numpy as np
import pytest

from softfinger.concealed.oracle import compute_gain
from softfinger.concealed.protocols import PROTOCOLS
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.setting import disturb, draw_setting, record_cleanly, set_strengths
from softfinger.concealed.strength import calibrate_strength, find_reach
from softfinger.concealed.suite import CaseSpec

JOINTS = {"any": (0, 1, 2), "one": (1,), "pair": (0, 1), "first": (0,), "chain": ()}
CHANCE_NATS = 4.0  # noise alone lends an effect ½ z² nats: 4 in one of two hundred at most


@pytest.mark.slow
@pytest.mark.parametrize("name", EFFECTS)
def test_the_oracle_gains_less_than_a_nat_for_any_effect(name):
    gains = []
    for seed, protocol in enumerate(PROTOCOLS):
        joints = (JOINTS[EFFECTS[name].joints],)
        spec = CaseSpec(100 + seed, (name,), joints, (-1.0,), protocol, 10, "white")
        setting = draw_setting(spec)
        clean = record_cleanly(setting, {}, np.arange(spec.trials))
        guess = set_strengths(setting.doses, {name: 0.1 * EFFECTS[name].typical})
        gain, base, _ = compute_gain(
            disturb(setting, clean, spec.seed),
            setting.rig,
            setting.noise,
            guess,
            setting.individuals,
        )
        assert base.settled
        gains.append(gain)
    assert np.median(gains) < 1.0
    assert max(gains) < CHANCE_NATS


@pytest.mark.slow
@pytest.mark.parametrize("name", ["second_retardation", "wire_friction", "camera_delay"])
def test_realised_gains_scatter_about_the_gain_aimed_at(name):
    """A gain of g nats is ½ χ² with one degree and noncentrality 2 g: sd √(2 g)."""
    off = []
    for seed in range(6):
        joints = (JOINTS[EFFECTS[name].joints],)
        spec = CaseSpec(300 + seed, (name,), joints, (0.5,), "staircase", 10, "ar_0.9")
        setting = draw_setting(spec)
        strength = calibrate_strength(name, setting, 50.0, find_reach(name, setting))
        doses = set_strengths(setting.doses, {name: strength})
        clean = record_cleanly(setting, doses, np.arange(spec.trials))
        gain, _, _ = compute_gain(
            disturb(setting, clean, spec.seed),
            setting.rig,
            setting.noise,
            doses,
            setting.individuals,
        )
        off.append((gain - 50.0) / np.sqrt(100.0))
    assert abs(np.mean(off)) < 3.0 / np.sqrt(6) + 0.5  # six trials stand for ten when aiming
    assert np.std(off) < 2.5
