from types import SimpleNamespace

import numpy as np
import pytest

from softfinger.concealed.kernel import RunawayError
from softfinger.concealed.knobs import Knobs
from softfinger.concealed.oracle import Line, compute_gain
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.setting import disturb, draw_setting, record_cleanly, set_strengths
from softfinger.concealed.strength import (
    MOST_NATS,
    calibrate_strength,
    find_reach,
    place_strengths,
)
from softfinger.concealed.suite import CaseSpec


def _spec(name, joints, protocol="staircase", trials=3, seed=11, noise="white"):
    return CaseSpec(seed, (name,), (joints,), (0.5,), protocol, trials, noise, duration_s=12.0)


def _gain(spec, strength):
    """Realised gain of the oracle on a noisy campaign with, or without, the effect."""
    setting = draw_setting(spec)
    name = spec.effects[0]
    doses = set_strengths(setting.doses, {name: strength})
    clean = record_cleanly(setting, doses, np.arange(spec.trials))
    guess = set_strengths(setting.doses, {name: strength or EFFECTS[name].typical})
    return compute_gain(
        disturb(setting, clean, spec.seed),
        setting.rig,
        setting.noise,
        guess,
        setting.individuals,
    )


@pytest.mark.parametrize(
    ("name", "joints"),
    [
        ("moment_arm", ()),
        pytest.param("second_retardation", (1,), marks=pytest.mark.slow),
        pytest.param("joint_play", (0,), marks=pytest.mark.slow),
    ],
)
def test_a_clean_campaign_gives_the_oracle_nothing(name, joints):
    gain, base, true = _gain(_spec(name, joints), 0.0)
    assert base.settled
    assert true.settled
    assert gain < 1.0


def test_the_oracle_finds_what_was_concealed():
    gain, base, true = _gain(_spec("wire_friction", ()), 0.03)
    assert gain > 30.0
    assert true.doses["wire_friction"].strength == pytest.approx(0.03, abs=0.005)
    misfit = [np.mean(np.concatenate(f.residuals) ** 2) for f in (base, true)]
    assert misfit[0] > misfit[1]
    assert misfit[1] == pytest.approx(1.0, abs=0.05)


@pytest.mark.slow
def test_a_calibrated_strength_gives_about_the_gain_aimed_at():
    spec = _spec("second_retardation", (0, 1, 2), "levels", noise="ar_0.9")
    setting = draw_setting(spec)
    reach = find_reach("second_retardation", setting)
    strength = calibrate_strength("second_retardation", setting, 60.0, reach)
    assert reach > 300.0
    gain, _, _ = _gain(spec, strength)
    assert 30.0 < gain < 110.0  # ± 2.5 sd of √(2 · 60)


def test_places_run_from_one_nat_to_the_reach():
    setting = draw_setting(_spec("camera_delay", (), "single_step", trials=2))
    low, middle = (place_strengths({"camera_delay": q}, setting) for q in (0.0, 0.5))
    assert low[1]["camera_delay"] == 1.0
    assert middle[1]["camera_delay"] == pytest.approx(100.0)  # half-way to the cap of 10000 nats
    largest = EFFECTS["camera_delay"].largest
    assert 0.0 < low[0]["camera_delay"] < middle[0]["camera_delay"] < largest
    none = {"camera_delay": 0.0}
    assert place_strengths({"camera_delay": -1.0}, setting) == (none, none)


@pytest.mark.slow
def test_in_an_even_pair_the_weaker_ones_reach_counts_for_both():
    names, joints = ("camera_delay", "stress_nonlinear_flow"), ((), (0,))
    spec = CaseSpec(3, names, joints, (1.0, 0.9), "single_step", 2, "white", duration_s=12.0)
    setting, places = draw_setting(spec), dict(zip(names, spec.quantiles, strict=True))
    weak = find_reach("stress_nonlinear_flow", setting)
    assert 1.0 < weak < 15.0  # a single step hides it in c_p
    _, aims = place_strengths(places, setting, even=True)
    assert aims == pytest.approx({names[0]: weak, names[1]: weak**0.9})
    _, aims = place_strengths(places, setting)
    assert aims == pytest.approx({names[0]: MOST_NATS, names[1]: weak**0.9})


def test_what_cannot_be_reached_gets_the_largest_strength():
    setting = draw_setting(_spec("stress_nonlinear_flow", (0,), "single_step"))
    reach = find_reach("stress_nonlinear_flow", setting)
    assert reach < 15.0  # a single step hides it in c_p
    largest = EFFECTS["stress_nonlinear_flow"].largest
    assert calibrate_strength("stress_nonlinear_flow", setting, reach + 1.0, reach) == largest


def test_knobs_turn_a_vector_into_doses_and_back():
    setting = draw_setting(_spec("second_retardation", (1,)))
    doses = set_strengths(setting.doses, {"second_retardation": 0.2})
    knobs = Knobs.of(doses)
    assert knobs.read().shape == knobs.sd.shape == (2,)
    back = knobs.turn(knobs.read())["second_retardation"]
    assert back.strength == 0.2
    assert back.shape["own"] == doses["second_retardation"].shape["own"]
    assert back.shape["retardation_time_s"] == pytest.approx(
        doses["second_retardation"].shape["retardation_time_s"]
    )
    assert 0.0 < knobs.floor[0] < 1e-3
    assert knobs.floor[1] == -np.inf


@pytest.mark.parametrize(("limit", "reached"), [(9.0, 2.0), (0.6, 0.5), (0.01, 0.0)])
def test_a_fit_does_not_go_where_the_motion_runs_away(limit, reached):
    def look(_, point):
        if point[0] > limit:
            raise RunawayError("the motion runs away")
        return 3.0 - point

    line = Line(look, 0, np.zeros(1))
    line.advance(np.array([2.0]), SimpleNamespace(mean=np.zeros(1), log_spread=np.zeros(1)))
    assert line.point == pytest.approx([reached])
    assert line.residual == pytest.approx([3.0 - reached])
