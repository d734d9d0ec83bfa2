"""What each number that an inference decides by does, where no other test shows it."""

import numpy as np
import pytest

from softfinger.inference.layout import describe_limits
from softfinger.inference.loo_pit import choose_frames_array
from softfinger.inference.setting import build_setting
from softfinger.measurement.measure import measure
from softfinger.measurement.trials import prepare_trials


@pytest.mark.parametrize(("trials", "warned"), [(4, True), (5, False)])
def test_few_trials_are_warned_of(trials, warned):
    assert bool(describe_limits(np.ones((trials, 2), bool))) == warned


@pytest.mark.parametrize(
    ("share", "reversals", "rests"),
    [(0.97, False, False), (0.9, True, False), (0.12, True, False), (0.08, True, True)],
)
def test_a_fall_of_the_load_is_a_reversal_or_a_rest(make_campaign, rng, share, reversals, rests):
    load = ([0.0, 1.5, 1.5, 3.0], [0.04, 0.04, 0.04 * share, 0.04 * share])
    angles = make_campaign(rng, 5, 1, load=load)[0]
    unknown = {f"link_{k}": ("joint", [np.nan]) for k in ("length", "mass", "centre", "inertia")}
    angles = angles.assign(started_at=("trial", np.full(5, np.nan)), **unknown)
    angles = angles.assign(joint_length=np.nan, wire_offset=np.nan)
    trials = prepare_trials(angles, measure(angles))
    setting = build_setting(angles, trials, np.tile([-2.4, -3.6, 2.8, 0.02], (5, 1)))
    assert (setting.reversals, setting.rests) == (reversals, rests)


def test_predictions_are_checked_early_and_late():
    time = np.arange(0.0, 30.05, 0.1)
    chosen = choose_frames_array(time, np.ones(time.size, bool))
    assert time[chosen] == pytest.approx([0.1, 1.0, 10.0, 30.0])
