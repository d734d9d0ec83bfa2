"""A hum goes on whatever the load does; what follows the load is physics."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from scipy.signal import lfilter

from softfinger.inference.problem import pose_problem
from softfinger.measurement.mend import mend_recordings
from softfinger.mechanics.effects.model_file import FittedTo
from softfinger.mismatch import diagnose
from softfinger.mismatch.checks.hums import _tune, find_hums
from softfinger.mismatch.checks.lines import find_line
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.tables.outcome import describe_repair

CONFIG = {
    "bootstrap_replicates": 99,
    "false_alarm_probability": 0.01,
    "sample_repaired": False,
    "longest_search_s": 600.0,
}
JOINTS, FRAMES, INTERVAL, SD = 2, 331, 0.04, 0.003
TIME = np.arange(FRAMES) * INTERVAL
STEPS = np.array([0.0, 1.0, 1.0, 7.0, 7.0, 13.5]), np.array([0.0, 0.0, 1.0, 1.0, 0.0, 0.0])


def draw(seed, trials, wave=None, *, log=STEPS, rho=0.0, level=(1.0,)):
    """Noise, and a wave (trial, frame) in the second joint; loads of some levels."""
    rng = np.random.default_rng(seed)
    size = np.resize(level, trials)
    residual = SD * np.sqrt(1 - rho**2) * rng.normal(size=(trials, JOINTS, FRAMES))
    residual = lfilter([1.0], [1.0, -rho], residual, axis=2)
    load = np.interp(TIME, *log) * size[:, None]
    if wave is not None:
        residual[:, 1] += wave(rng, load)
    residual[:, :, 40:44] = np.nan
    problem = SimpleNamespace(
        trials=SimpleNamespace(
            interval=INTERVAL,
            load_time=np.tile(log[0], (trials, 1)),
            load_torque=np.outer(size, log[1]),
        ),
        setting=SimpleNamespace(duration=float(np.ptp(TIME)), stiffness=np.full(JOINTS, 0.1)),
        noise=xr.Dataset(
            {
                "noise_autocorrelation": ("joint", np.full(JOINTS, rho)),
                "noise_white": ("joint", np.zeros(JOINTS)),
                "noise_correlation": (("joint", "other_joint"), np.eye(JOINTS)),
            }
        ),
    )
    return problem, residual, np.tile(TIME, (trials, 1))


def hum(frequency, size):
    """A hum of constant amplitude, of any phase in each trial."""

    def wave(rng, load):
        phase = rng.uniform(0.0, 2 * np.pi, (len(load), 1))
        return np.sqrt(2.0) * size * np.cos(2 * np.pi * frequency * TIME + phase)

    return wave


def ring(frequency, size, periods):
    """What a finger's inertia adds after each change of load; its frequency differs by 5 %."""

    def wave(rng, load):
        own = frequency * np.exp(0.05 * rng.normal(size=(len(load), 1)))
        moved = np.zeros(load.shape)
        for change, sign in ((1.0, 1.0), (7.0, -1.0)):
            since = np.maximum(TIME - change, 0.0)
            decay = np.exp(-since * frequency / periods)
            moved += sign * load.max(axis=1)[:, None] * decay * np.sin(2 * np.pi * own * since)
        return size * moved

    return wave


def ring_otherwise_as_it_falls(frequency, size, periods):
    """A ring after each change of load, of a phase of its own: valves open and close in time."""

    def wave(rng, load):
        rises, falls = rng.uniform(0.0, 2 * np.pi, (2, len(load), 1))
        moved = np.zeros(load.shape)
        for since, until, phase in ((1.0, 7.0, rises), (7.0, np.inf, falls)):
            gone, on = TIME - since, (since <= TIME) & (until > TIME)
            ringing = np.sin(2 * np.pi * frequency * gone + phase)
            moved += np.where(on, np.exp(-gone * frequency / periods) * ringing, 0.0)
        return size * load.max(axis=1)[:, None] * moved

    return wave


def weigh_rest(problem, residual, time, hums):
    """Evidence [nats] for a line beside the hums."""
    return find_line(problem, residual - sum(one.move(time) for one in hums), time).gain


@pytest.mark.parametrize("rho", [0.0, 0.5])
@pytest.mark.parametrize("frequency", [1.53, 4.2, 7.9])
@pytest.mark.parametrize(("trials", "size"), [(1, 0.6), (6, 0.3), (1, 3.0), (6, 3.0)])
def test_a_hum_is_found_and_leaves_no_line(frequency, trials, size, rho):
    case = draw(3, trials, hum(frequency, size * SD), rho=rho)
    assert find_line(*case).gain > DECISIONS.least_left
    hums = find_hums(*case)
    assert len(hums) == 1
    assert hums[0].frequency_hz == pytest.approx(frequency, abs=0.02)
    assert hums[0].size == pytest.approx(size * SD, rel=0.25)
    assert hums[0].evidence > 6.0
    assert np.all(hums[0].amplitude[:, 0] == 0.0)
    assert weigh_rest(*case, hums) < np.log(100.0)


def test_hums_of_several_frequencies_are_found_one_after_the_other():
    first, second = hum(2.0, SD), hum(6.0, 0.5 * SD)
    case = draw(4, 6, lambda rng, load: first(rng, load) + second(rng, load))
    hums = find_hums(*case)
    np.testing.assert_allclose([one.frequency_hz for one in hums], [2.0, 6.0], atol=0.02)
    assert weigh_rest(*case, hums) < np.log(100.0)


@pytest.mark.parametrize("trials", [1, 6])
@pytest.mark.parametrize(("frequency", "periods"), [(2.0, 3.0), (5.0, 3.0), (5.0, 15.0)])
def test_a_ring_is_no_hum_and_leaves_its_line(frequency, periods, trials):
    case = draw(5, trials, ring(frequency, 20 * SD, periods))
    assert find_hums(*case) == []
    assert find_line(*case).gain > DECISIONS.least_left


@pytest.mark.parametrize("trials", [1, 6])
@pytest.mark.parametrize(("frequency", "periods"), [(1.2, 10.0), (1.2, 30.0), (3.3, 30.0)])
def test_a_finger_that_rings_otherwise_as_it_is_let_go_does_not_hum(frequency, periods, trials):
    assert find_hums(*draw(8, trials, ring_otherwise_as_it_falls(frequency, 6 * SD, periods))) == []


@pytest.mark.parametrize("trials", [1, 6])
def test_a_hum_does_not_hide_a_ring(trials):
    swings, sounds = ring(2.0, 8 * SD, 3.0), hum(6.0, 2 * SD)
    case = draw(6, trials, lambda rng, load: swings(rng, load) + sounds(rng, load))
    hums = find_hums(*case)
    assert [round(one.frequency_hz, 1) for one in hums] == [6.0]
    assert weigh_rest(*case, hums) > DECISIONS.least_left


@pytest.mark.parametrize("trials", [1, 6])
def test_what_moves_as_a_load_that_swings_is_no_hum(trials):
    log = TIME, 1.0 + 0.5 * np.sin(2 * np.pi * 1.0 * TIME)
    case = draw(7, trials, lambda _, load: 0.006 * (load - 1.0), log=log, level=(1.0, 1.2, 0.8))
    assert find_line(*case).gain > DECISIONS.least_left
    assert find_hums(*case) == []


@pytest.mark.parametrize("frequency", [2.3, 4.3, 7.7])
def test_a_wave_that_comes_with_a_slow_load_is_no_hum(frequency):
    slow = np.array([0.0, 6.0, 12.0, 13.5]), np.array([0.0, 1.0, 0.0, 0.0])
    sounds = hum(frequency, SD)
    case = draw(8, 6, lambda rng, load: load * sounds(rng, load), log=slow, level=(0.5, 1.0, 1.5))
    assert find_line(*case).gain > DECISIONS.least_left
    assert find_hums(*case) == []


@pytest.mark.parametrize("trials", [1, 6])
def test_noise_holds_no_hum(trials):
    for seed in range(8):
        case = draw(seed, trials, rho=0.4)
        assert find_hums(*case) == []
        assert find_line(*case).gain < np.log(100.0)


@pytest.mark.parametrize(("trials", "frequency"), [(1, 1.7), (6, 4.4)])
def test_a_campaign_that_hums_is_adequate_and_its_hum_is_a_finding(
    draw_campaign, trials, frequency
):
    angles = draw_campaign(2, 0.0).isel(trial=slice(trials)).copy(deep=True)
    phase = np.random.default_rng(1).uniform(0.0, 2 * np.pi, (trials, 1, 1))
    time = angles["time"].values[:, None]
    angles["joint_angle"].values += 0.002 * np.cos(2 * np.pi * frequency * time + phase)
    found = diagnose(angles, CONFIG, 5, lambda items, _: items)
    assert found.verdict.decision == "adequate"
    assert [one.id for one in found.verdict.measurement] == ["drift"]
    np.testing.assert_allclose(found.problem.noise["hum_frequency"], [frequency], atol=0.02)
    assert found.problem.noise["component"].values.tolist() == ["hum"]
    size = float(found.problem.noise["component_size"][0])
    assert size == pytest.approx(0.002 / np.sqrt(2), rel=0.15)
    assert found.findings.line.gain < np.log(100.0)
    assert found.findings.p_value > 0.01
    quiet = draw_campaign(2, 0.0).isel(trial=slice(trials))
    known = describe_repair(found, FittedTo(campaign="hum", sha256="0" * 64)).measurement
    mended = mend_recordings(angles, known)["joint_angle"]
    np.testing.assert_allclose(mended, found.angles["joint_angle"], atol=1e-7)
    assert float(((mended - quiet["joint_angle"]) ** 2).mean()) < 0.1 * size**2
    still, _ = pose_problem(quiet)
    for name in ("noise_sd", "noise_autocorrelation"):
        both = [float(one.noise[name][0]) for one in (found.problem, still)]
        assert both[0] == pytest.approx(both[1], rel=0.1)


def test_a_finger_that_rings_is_not_said_to_hum(draw_campaign):
    angles = draw_campaign(2, 0.0).copy(deep=True)
    since = np.maximum(angles["time"].values - 8.0, 0.0)
    swing = 0.02 * np.exp(-since / 1.5) * np.sin(2 * np.pi * 2.3 * since)
    angles["joint_angle"].values += swing[:, None]
    found = diagnose(angles, CONFIG, 5, lambda items, _: items)
    assert found.verdict.decision != "adequate"
    assert "hum" not in found.problem.noise["component"]
    assert found.findings.line.gain > DECISIONS.least_left


def test_no_frequency_is_sought_below_half_the_slowest():
    """What is slower is a drift; a constant would have the frequency zero."""
    constant = [SimpleNamespace(values=np.ones(50), time=np.linspace(0.0, 10.0, 50))]
    assert _tune(constant, np.array([0.05, 0.3, 0.55]), 0) >= 0.025
