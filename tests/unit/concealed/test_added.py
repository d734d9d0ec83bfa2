"""Effects added to recordings that a test writes, and answers judged."""

import shutil

import numpy as np
import pandas as pd
import pytest

from softfinger.concealed.added import accepts, claims, draw_additions, read_bodies, write_added
from softfinger.concealed.added.apply import Addition, strengthen
from softfinger.concealed.added.body import RIG, Scale, describe, fit_body, fit_plain
from softfinger.concealed.effects import Dose
from softfinger.concealed.forward import compute_plain_angles, simulate_trial
from softfinger.concealed.population import to_parameters
from softfinger.concealed.protocols import Load

DESCRIPTION = """version: 1
name: a strip
source: measured
specimen:
  motion: {quantity: displacement, unit: mm}
  load: {quantity: force, unit: N}
"""
OWN = np.log(np.array([0.1, 0.02, 20.0]))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Four trials of 12 s: 3 N at 1 s, off at 8 s; millimetres, a repeated frame, a gap."""
    place = tmp_path_factory.mktemp("recorded") / "strip"
    for name in ("angles", "load", "raw"):
        (place / name).mkdir(parents=True)
    (place / "campaign.yaml").write_text(DESCRIPTION)
    time = np.arange(0.0, 12.0, 0.05)
    load = Load(np.array([1.0, 1.0, 8.0, 8.0]), np.array([0.0, 10.0, 10.0, 0.0]))
    rows = []
    for number in range(4):
        own = np.append(OWN + 0.1 * number, 0.02)[:, None]
        angle = compute_plain_angles(own, describe(0, 1, load, 12.0), RIG.wire_offset, time)[:, 0]
        motion = 5.0 + 10.0 * angle
        motion[100], motion[150] = motion[99], np.nan
        table = pd.DataFrame({"time_s": time, "motion": motion})
        table.to_csv(place / f"angles/t{number}.csv", index=False, float_format="%.9f")
        (place / f"load/t{number}.csv").write_text(
            "time_s,load\n0,0\n0.99,0\n1,3\n7.99,3\n8,0\n12,0\n"
        )
        rows.append(f"t{number},angles/t{number}.csv,load/t{number}.csv")
    (place / "trials.csv").write_text("trial,angles,load\n" + "\n".join(rows) + "\n")
    return place


@pytest.fixture(scope="module")
def fitted(folder):
    """Bodies and scale of that folder."""
    return read_bodies(folder)


def read(folder, number):
    return pd.read_csv(folder / f"angles/t{number}.csv")


def test_bodies_are_fitted_in_the_units_of_the_finger(fitted):
    bodies, scale = fitted
    assert [body.name for body in bodies] == ["t0", "t1", "t2", "t3"]
    body = bodies[1]
    assert (scale.load, scale.time) == (pytest.approx(0.3), pytest.approx(11.95 / 30))
    k_v, c_v, c_p, _ = to_parameters(body.individual)[:, 0]
    true = np.exp(OWN + 0.1)
    per = 10.0 / scale.motion  # finger's radians per campaign's
    np.testing.assert_allclose(k_v * per, true[0], rtol=1e-2)
    np.testing.assert_allclose([c_v, c_p], true[1:] / scale.time / per, rtol=2e-2)


def test_a_body_follows_creep_on_many_time_scales_and_gross_errors_hardly_count():
    load = Load(np.array([1.0, 1.0]), np.array([0.0, 10.0]))
    time = np.arange(0.0, 30.0, 0.05)
    trial, since = describe(0, 1, load, 30.0), np.maximum(time - 1.0, 0.0)
    true = 0.02 + 0.1 * (since > 0) * (1 - np.exp(-since / 0.1)) + 0.08 * since**0.3
    spoilt = np.where(np.arange(time.size) % 100 == 7, true + 0.5, true)
    own = fit_plain(time, spoilt, load)
    alone = simulate_trial(own, {}, trial, RIG, time)[:, 0]
    own, ladder = fit_body(time, spoilt, load)
    body = simulate_trial(own, {}, trial, RIG, time, beside=tuple(ladder))[:, 0]
    assert np.abs(body - true).mean() < 0.15 * np.abs(alone - true).mean()
    assert np.abs(body - true).max() < 0.01
    assert (ladder.compliance > 0).all()


def test_an_effect_can_be_added_to_a_body_that_only_flows():
    load = Load(np.array([1.0, 1.0]), np.array([0.0, 10.0]))
    time = np.arange(0.0, 20.0, 0.1)
    trial, motion = describe(0, 1, load, 20.0), 0.02 + 0.03 * np.maximum(time - 1.0, 0.0)
    own, ladder = fit_body(time, motion, load)
    moved = simulate_trial(
        own, {"inertia": Dose(1.0, {}, (0,))}, trial, RIG, time, beside=tuple(ladder)
    )
    assert own[0, 0] <= np.log(100.0)
    assert np.isfinite(moved).all()


def test_an_added_lag_is_where_the_load_changes_and_nowhere_else(folder, fitted, tmp_path):
    bodies, scale = fitted
    addition = Addition("actuator_lag", Dose(0.3, {}, (0,)), 1)
    write_added(folder, tmp_path / "added", bodies, scale, addition)
    before, after = read(folder, 2), read(tmp_path / "added", 2)
    change = (after["motion"] - before["motion"]).to_numpy()
    time = before["time_s"].to_numpy()
    np.testing.assert_array_equal(after["time_s"], time)
    assert np.abs(change[time < 1.0]).max() < 1e-6
    assert np.nanmin(change[(time > 1.0) & (time < 1.5)]) < -0.5
    assert np.nanmax(change[(time > 8.0) & (time < 8.5)]) > 0.5
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(change)), [150])
    assert after["motion"][100] == after["motion"][99]
    assert not (tmp_path / "added/raw").exists()


def test_a_delay_shifts_the_clock_and_leaves_the_motion(folder, fitted, tmp_path):
    bodies, scale = fitted
    addition = Addition("camera_delay", Dose(0.1, {}, (0,)), 1)
    write_added(folder, tmp_path / "added", bodies, scale, addition)
    before, after = read(folder, 0), read(tmp_path / "added", 0)
    late = (after["time_s"] - before["time_s"]).to_numpy() / scale.time
    assert late.min() == pytest.approx(late.max(), abs=1e-6)
    assert 0.09 <= late[0] <= 0.11
    np.testing.assert_allclose(after["motion"], before["motion"], atol=1e-8)


def test_rounded_readings_are_rounded_again_and_others_are_not(folder, tmp_path):
    folder = shutil.copytree(folder, tmp_path / "strip")
    rounded = read(folder, 2)
    rounded["motion"] = (rounded["motion"] / 0.02).round() * 0.02
    rounded.to_csv(folder / "angles/t2.csv", index=False, float_format="%.9f")
    bodies, scale = read_bodies(folder)
    addition = Addition("actuator_lag", Dose(0.3, {}, (0,)), 1)
    write_added(folder, tmp_path / "added", bodies, scale, addition)
    for number, largest in ((2, 1e-6), (1, 0.5)):
        step = read(tmp_path / "added", number)["motion"].dropna() / 0.02
        assert np.abs(step - step.round()).max() <= largest
    assert np.abs(step - step.round()).max() > 0.1


def test_what_is_taken_off_is_what_is_added(folder, fitted, tmp_path):
    bodies, scale = fitted
    for effect, column in (("actuator_lag", "motion"), ("camera_delay", "time_s")):
        addition, change = Addition(effect, Dose(0.1, {}, (0,)), 1), []
        for times in (1.0, -1.0):
            place = tmp_path / f"{effect}{times}"
            write_added(folder, place, bodies, scale, addition, times)
            change.append(read(place, 2)[column] - read(folder, 2)[column])
        assert np.nanmax(np.abs(change[0])) > 0.01
        np.testing.assert_allclose(change[0], -change[1], atol=1e-6)


def test_a_temperature_becomes_a_covariate(folder, fitted, tmp_path):
    bodies, scale = fitted
    addition = Addition("temperature", Dose(0.05, {"stiffness": 1.0}, (0,)), 1)
    write_added(folder, tmp_path / "added", bodies, scale, addition)
    warmth = pd.read_csv(tmp_path / "added/trials.csv")["temperature_c"] - 22.0
    change = [
        (read(tmp_path / "added", k)["motion"] - read(folder, k)["motion"])[100] for k in range(4)
    ]
    assert np.corrcoef(warmth, change)[0, 1] > 0.95


def test_additions_are_the_same_whenever_the_campaign_is_and_of_bounded_strength():
    day = Scale(time=3000.0, motion=1.0, load=1.0, rest=0.0)  # seconds of a trial per one of ours
    once, again = draw_additions("spruce", 34, day), draw_additions("spruce", 34, day)
    assert once == again
    assert [a.effect for a in draw_additions("spruce", 1, day)] == [
        a.effect
        for a in once
        if a.effect not in ("fatigue_softening", "temperature", "session_jump", "load_gain")
    ]
    lag = next(a for a in once if a.effect == "actuator_lag")
    assert strengthen(lag, 99.0, day).dose.strength == 0.3
    delay = next(a for a in once if a.effect == "camera_delay")
    for one in (delay, strengthen(delay, 99.0, day)):
        assert one.dose.strength * day.time <= 0.2  # seconds of a real clock
    assert strengthen(delay, 99.0, day._replace(time=0.2)).dose.strength == 0.2


def answer(decision, *effects, equivalent=(), explained=()):
    return {
        "decision": decision,
        "effects": [{"id": name} for name in effects],
        "equivalent": [list(equivalent)] if equivalent else [],
        "explained": [{"effects": list(ids)} for ids in explained],
    }


@pytest.mark.parametrize(
    ("accepted", "verdict", "right"),
    [
        ("inertia", answer("named", "inertia"), True),
        ("inertia", answer("named", "inertia", "gravity"), False),
        ("inertia", answer("ambiguous", "inertia"), False),
        ("actuator_lag+inertia", answer("named", "inertia", "actuator_lag"), True),
        ("ambiguous:inertia", answer("ambiguous", equivalent=["inertia+gravity", "none"]), True),
        ("ambiguous:inertia", answer("ambiguous", equivalent=["gravity", "none"]), False),
        ("unlisted", answer("unlisted"), True),
        ("unlisted:inertia", answer("unlisted", explained=[["inertia", "gravity"]]), True),
        ("unlisted:inertia", answer("unlisted", explained=[["gravity"], ["inertia"]]), False),
        ("adequate", answer("adequate"), True),
        ("adequate", answer("crashed"), False),
    ],
)
def test_answers_of_an_expert(accepted, verdict, right):
    assert accepts([accepted], verdict) is right


def test_what_is_explained_counts_under_unlisted_only():
    said = answer("named", "inertia", explained=[["inertia", "gravity"]])
    assert claims(said) == {"inertia"}
