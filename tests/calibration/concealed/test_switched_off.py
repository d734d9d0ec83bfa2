"""Switches that are off are off: without noise, no effect explains anything in a clean campaign."""

import numpy as np
import pytest

from softfinger.concealed.oracle import compute_gain
from softfinger.concealed.protocols import PROTOCOLS
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.setting import draw_setting, record_cleanly, set_strengths
from softfinger.concealed.suite import CaseSpec

JOINTS = {"any": (0, 1, 2), "one": (1,), "pair": (0, 1), "first": (0,), "chain": ()}


@pytest.mark.slow
@pytest.mark.parametrize("place", range(len(EFFECTS)))
def test_the_oracle_gains_less_than_a_nat_from_what_is_off(place):
    name = list(EFFECTS)[place]
    protocol = PROTOCOLS[place % len(PROTOCOLS)]
    spec = CaseSpec(7, (name,), (JOINTS[EFFECTS[name].joints],), (-1.0,), protocol, 10, "white")
    setting = draw_setting(spec)
    clean = record_cleanly(setting, {}, np.arange(spec.trials))
    guess = set_strengths(setting.doses, {name: 0.1 * EFFECTS[name].typical})
    gain, base, _ = compute_gain(clean, setting.rig, setting.noise, guess, setting.individuals)
    assert base.settled
    assert gain < 1.0
    misfit = np.mean(np.concatenate([r.ravel() for r in base.residuals]) ** 2)
    assert misfit < 1e-3  # the base model is the whole motion, up to its priors' pull
