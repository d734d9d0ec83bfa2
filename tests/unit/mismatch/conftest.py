import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp

from softfinger.inference.simulate import build_recording, draw_noise_array
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.forward.simulate import (
    describe_unknown_finger,
    simulate_joint_angle_array,
)
from softfinger.mechanics.forward.slots import build_slots
from softfinger.mechanics.three_element import compute_joint_angle_array
from softfinger.mismatch import diagnose
from softfinger.mismatch.candidates import rank

TRIALS, FRAMES = 7, 160
CONFIG = {
    "bootstrap_replicates": 99,
    "false_alarm_probability": 0.01,
    "sample_repaired": False,
    "longest_search_s": 600.0,
}


def quiet(items, _):
    return items


def stretch(time, load, k, c, thinning):
    """Strain of a Voigt element whose rate r grows to r (1 + thinning |r|): pull, then release."""

    def rate(_, strain, torque):
        linear = (torque - k * strain) / c
        return linear * (1.0 + thinning * np.abs(linear))

    pulled, let_go = time <= 8.0, time > 8.0
    accurate = {"rtol": 1e-8, "atol": 1e-10}
    up = solve_ivp(rate, (0, 8), [0], t_eval=time[pulled], args=(load[0],), **accurate)
    down = solve_ivp(rate, (8, time[-1]), up.y[:, -1], t_eval=time[let_go], args=(0.0,), **accurate)
    return np.concatenate([up.y[0], down.y[0]])


@pytest.fixture(scope="session")
def draw_campaign():
    """Draw a campaign of one joint.

    A second Voigt element carries a share of its compliance; or its damper thins: [s/rad].
    """

    def draw(seed, share, retardation_time=1.5, rho=0.3, thinning=0.0):
        rng = np.random.default_rng(seed)
        time = np.arange(FRAMES) * 0.08
        load_time = np.tile([0.0, 8.0, 8.0, 13.0], (TRIALS, 1))
        load = np.resize([0.02, 0.03, 0.04], TRIALS)[:, None] * np.array([1.0, 1.0, 0.0, 0.0])
        angles = build_recording(time, load_time, load, 1, [f"t{i}" for i in range(TRIALS)])
        log_k, log_c, log_p = (
            m + s * rng.normal(size=(TRIALS, 1)) for m, s in ((-2.3, 0.2), (-3.6, 0.4), (2.9, 0.5))
        )
        series = time, load_time[:, None], load[:, None]
        motion = compute_joint_angle_array(
            np.exp(log_k),
            np.exp(log_c),
            np.exp(log_p),
            rng.normal(0.02, 0.01, (TRIALS, 1)),
            *series,
        )
        if share > 0:
            k = np.exp(log_k) / share
            motion += compute_joint_angle_array(k, k * retardation_time, np.inf, 0.0, *series)
        if thinning > 0:
            k, c = np.exp(log_k), np.exp(log_c)
            motion -= compute_joint_angle_array(k, c, np.inf, 0.0, *series)
            motion[:, 0] += [
                stretch(time, rows, ki, ci, thinning)
                for rows, ki, ci in zip(load, k[:, 0], c[:, 0], strict=True)
            ]
        noise = xr.Dataset(
            {
                "noise_sd": ("joint", [0.002]),
                "noise_autocorrelation": ("joint", [rho]),
                "noise_white": ("joint", [0.0]),
                "noise_correlation": (("joint", "other_joint"), np.eye(1)),
            }
        )
        motion += draw_noise_array(time / 0.08, noise, TRIALS, rng)
        return complete(angles, motion).assign_attrs(campaign="drawn", camera=1)

    return draw


def complete(angles, motion):
    """Recordings of a finger of which nothing is declared."""
    joints = np.full(angles.sizes["joint"], np.nan)
    unknown = {f"link_{k}": ("joint", joints) for k in ("length", "mass", "centre", "inertia")}
    return angles.assign(
        joint_angle=(("trial", "joint", "frame"), motion),
        started_at=("trial", np.full(angles.sizes["trial"], np.nan)),
        joint_length=np.nan,
        wire_offset=np.nan,
        **unknown,
    )


@pytest.fixture(scope="session")
def slow_lag():
    """Draw a campaign whose joint is faster than the lag of its load, 0.3 s.

    Filters in series: only that the joint's own time differs from trial to trial tells which is it.
    """
    rng, trials = np.random.default_rng(5), 6
    time = np.arange(200) * 0.03
    load_time, load = np.tile([0.0, 3.0, 3.0, 6.0], (trials, 1)), np.array([1.0, 1.0, 0.0, 0.0])
    load = np.resize([0.02, 0.03, 0.04], trials)[:, None] * load
    angles = build_recording(time, load_time, load, 1, [f"t{i}" for i in range(trials)])
    log_k = rng.normal(-2.3, 0.1, (trials, 1))
    log_c = log_k + np.log(0.06) + rng.normal(0.0, 0.8, (trials, 1))
    own = np.stack([log_k, log_c, np.full_like(log_k, 2.9), np.full_like(log_k, 0.02)], axis=-1)
    slots, finger = build_slots(trials, 1, {"lag": 0.3}), describe_unknown_finger(1)
    motion, _ = simulate_joint_angle_array(own, slots, [], finger, time, load_time, load)
    return complete(angles, motion + rng.normal(0.0, 0.001, motion.shape))


@pytest.fixture(scope="session")
def late_links():
    """Draw a campaign of ramps in which both links follow after play of 0.1 rad."""
    rng, trials = np.random.default_rng(6), 6
    time = np.arange(240) * 0.1
    load_time = np.tile([0.0, 9.0, 11.0, 17.0, 24.0], (trials, 1))
    load = np.linspace(0.03, 0.05, trials)[:, None] * np.array([0.0, 1.0, 1.0, 0.3, 0.3])
    angles = build_recording(time, load_time, load, 2, [f"t{i}" for i in range(trials)])
    own = np.array([-2.3, -4.0, 3.5, 0.02]) + rng.normal(0.0, [0.1, 0.4, 0.3, 0.01], (trials, 2, 4))
    slots, finger = build_slots(trials, 2, {"play_backlash": 0.1}), describe_unknown_finger(2)
    motion, _ = simulate_joint_angle_array(own, slots, [], finger, time, load_time, load)
    return complete(angles, motion + rng.normal(0.0, 0.001, motion.shape))


@pytest.fixture(scope="session")
def recorded(draw_campaign):
    """A campaign with a second retardation."""
    return draw_campaign(1, 0.15)


@pytest.fixture(scope="session")
def named(recorded):
    return diagnose(recorded, CONFIG, 5, quiet)


@pytest.fixture(scope="session")
def clean(draw_campaign):
    return diagnose(draw_campaign(2, 0.0), CONFIG, 5, quiet)


@pytest.fixture(scope="session")
def recorded_thinning(draw_campaign):
    """A campaign whose damper thins."""
    return draw_campaign(2, 0.0, thinning=0.3)


@pytest.fixture(scope="session")
def thinned(recorded_thinning):
    """Diagnose it by a list that lacks the effect, and what takes its place: creep, and play."""
    without = {"thinning_damper", "second_retardation", "fractional_creep", "joint_play"}
    known = {name: e for name, e in list_effects().items() if name not in without}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rank, "list_effects", lambda: known)
        return diagnose(recorded_thinning, CONFIG, 5, quiet)
