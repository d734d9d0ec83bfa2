"""Every law of the proof's kernel, beside an independent integration of one joint."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from softfinger.concealed.foreign.law import tabulate_angle, tabulate_rate, tabulate_torque
from softfinger.concealed.kernel import simulate_angles
from softfinger.concealed.laws import look_up
from softfinger.concealed.physics import build_plain_physics

K_V, C_V, C_P, Q_INI, OFFSET = 0.09, 0.03, 4.0, 0.02, 0.005
TIME = np.linspace(0.0, 4.0, 81)
CHANGES = ((0.0, 7.0), (1.5, 3.0), (3.0, 0.0))  # time, tension from then on


def _simulate(**changes):
    time = np.repeat([t for t, _ in CHANGES], 2)
    level = [tension for _, tension in CHANGES]
    plain = build_plain_physics(
        np.array([[K_V], [C_V], [C_P], [Q_INI]]),
        time,
        np.column_stack([[0.0, *level[:-1]], level]).ravel(),
        np.array([0.05]),
        np.array([0.02]),
        OFFSET,
        0.008,
    )
    return simulate_angles(plain._replace(**changes), TIME, 1e-10)[:, 0]


def _integrate(rate, states=2):
    """Angle q_ini + Voigt strain + flow, by Radau from one change of load to the next."""
    ends = [*(t for t, _ in CHANGES[1:]), TIME[-1]]
    state, angle = np.zeros(states), np.full(TIME.size, Q_INI)
    for (start, tension), end in zip(CHANGES, ends, strict=True):
        seen = (start < TIME) & (end >= TIME)
        done = solve_ivp(
            lambda t, y, pull=tension: rate(y, pull, t),
            (start, end),
            state,
            "LSODA",
            np.append(TIME[seen], end) if not seen.any() or TIME[seen][-1] < end else TIME[seen],
            rtol=1e-10,
            atol=1e-12,
            max_step=0.02,
        )
        angle[seen] = (Q_INI + done.y[0] + done.y[1])[: seen.sum()]
        state = done.y[:, -1]
    return angle


def _voigt(y, torque):
    return (torque - K_V * y[0]) / C_V


def _curve(x):
    return 0.6 * x**2 / (x**2 + 0.1)


ONE = np.ones(1)
LAWS = {
    "spring": (
        {"spring_law": tabulate_angle(_curve)[None]},
        lambda y, pull, t: [
            (OFFSET * pull - K_V * y[0] * (1.0 + _curve(abs(y[0])))) / C_V,
            OFFSET * pull / C_P,
        ],
    ),
    "damper": (
        {"damper_law": tabulate_rate(_curve)[None]},
        lambda y, pull, t: [
            (r := _voigt(y, OFFSET * pull)) * (1.0 + _curve(abs(r))),
            OFFSET * pull / C_P,
        ],
    ),
    "flow": (
        {"flow_law": tabulate_torque(lambda x: _curve(np.minimum(10.0 * x, 1e3)))[None]},
        lambda y, pull, t: [
            _voigt(y, OFFSET * pull),
            OFFSET * pull / C_P * (1.0 + _curve(10.0 * OFFSET * pull)),
        ],
    ),
    "stop": (
        {"stop_law": tabulate_angle(lambda q: 0.02 * _curve(q))[None]},
        lambda y, pull, t: [
            _voigt(y, tau := OFFSET * pull - 0.02 * _curve(Q_INI + y[0] + y[1])),
            tau / C_P,
        ],
    ),
    "arm": (
        {"arm_law": tabulate_angle(_curve)[None]},
        lambda y, pull, t: [
            _voigt(y, tau := OFFSET * pull * (1.0 + _curve(Q_INI + y[0] + y[1]))),
            tau / C_P,
        ],
    ),
    "tendon": (
        {"tendon": 0.05, "tendon_slack": 0.2},
        lambda y, pull, t: [
            _voigt(y, tau := OFFSET * pull - 0.05 * max(Q_INI + y[0] + y[1] - 0.2, 0.0)),
            tau / C_P,
        ],
    ),
    "one_way": (
        {"one_way": 0.8 * ONE},
        lambda y, pull, t: [
            (r := _voigt(y, OFFSET * pull)) * (1.0 + 0.8 / (1.0 + np.exp(-2.0 * r / 0.05))),
            OFFSET * pull / C_P,
        ],
    ),
    "lag": (
        {"lag_times": np.array([0.05, 0.3]), "lag_mix": np.array([0.7, 0.3])},
        lambda y, pull, t: [
            _voigt(y, tau := OFFSET * (0.7 * y[2] + 0.3 * y[3])),
            tau / C_P,
            (pull - y[2]) / 0.05,
            (y[2] - y[3]) / 0.3,
        ],
    ),
    "plastic": (
        {"plastic": 0.4 * ONE, "plastic_from": 0.1},
        lambda y, pull, t: [
            (OFFSET * pull - K_V * (y[0] - 0.4 * max(y[2] - 0.1, 0.0))) / C_V,
            OFFSET * pull / C_P,
            max(y[0] - y[2], 0.0) / 0.02,
        ],
    ),
    "dry": (
        {"dry": 0.003 * ONE},
        lambda y, pull, t: [
            v := _voigt(y, tau := OFFSET * pull - 0.003 * y[2]),
            f := tau / C_P,
            (v + f) / 0.005 * (1.0 - (0.5 + 0.5 * np.sign((v + f) * y[2])) * y[2] ** 2),
        ],
    ),
    "thixotropy": (
        {"thixotropy": 3.0 * ONE, "breaking": 60.0, "healing": 0.5},
        lambda y, pull, t: [
            _voigt(y, OFFSET * pull),
            f := OFFSET * pull / C_P * (1.0 + 3.0 * y[2]),
            60.0 * abs(f) * (1.0 - y[2]) - 0.5 * y[2],
        ],
    ),
    "softening": (
        {"softening": 0.5 * ONE, "warming": (0.4, 1.5, 2.0, 0.1)},
        lambda y, pull, t: [
            v := (OFFSET * pull - K_V * y[0] * (1.0 - 0.5 * y[2])) / C_V,
            f := OFFSET * pull / C_P,
            0.4 * (1.0 - y[2]) ** 1.5 + 2.0 * abs(v + f) * (1.0 - y[2]) - 0.1 * y[2],
        ],
    ),
    "thinning_out": (
        {"thinning_out": 0.5 * ONE, "warming": (0.4, 1.0, 0.0, 0.0)},
        lambda y, pull, t: [
            _voigt(y, OFFSET * pull) / (1.0 - 0.5 * -np.expm1(-0.4 * t)),
            OFFSET * pull / C_P / (1.0 - 0.5 * -np.expm1(-0.4 * t)),
        ],
    ),
}
MORE = {"lag": 4, "plastic": 3, "dry": 3, "thixotropy": 3, "softening": 3}


@pytest.mark.parametrize("name", LAWS)
def test_a_law_follows_its_equation(name):
    changes, rate = LAWS[name]
    found, exact = _simulate(**changes), _integrate(rate, MORE.get(name, 2))
    np.testing.assert_allclose(found, exact, rtol=0, atol=2e-6)
    assert np.abs(found - _simulate()).max() > 3e-3


@pytest.mark.parametrize("share", [-0.1, 0.0, 0.013, 0.5, 0.77, 1.0, 1.3])
def test_a_table_is_read_smoothly_and_ends_where_it_ends(share):
    row = np.sin(np.linspace(0.0, 2.0, 301))
    assert look_up(row, share) == pytest.approx(np.sin(2.0 * np.clip(share, 0.0, 1.0)), abs=1e-6)


def test_a_straight_table_is_read_exactly():
    row = 3.0 + 2.0 * np.linspace(0.0, 1.0, 11)
    assert look_up(row, 0.437) == pytest.approx(3.874, abs=1e-14)


def test_a_membrane_pulls_two_joints_together(rig, individual):
    plain = build_plain_physics(
        np.array([[0.1, 0.2], [0.01, 0.01], [1e9, 1e9], [0.02, 0.01]]),
        np.zeros(1),
        np.array([8.0]),
        np.full(2, 0.025),
        np.full(2, 0.005),
        OFFSET,
        0.008,
    )
    joined = plain._replace(
        membrane=np.array([[0.0, 0.03], [0.03, 0.0]]),
        membrane_law=tabulate_angle(lambda d: d)[None],
    )
    q = simulate_angles(joined, np.array([20.0]), 1e-9)[0] - [0.02, 0.01]
    stiffness = np.array([[0.13, -0.03], [-0.03, 0.23]])
    np.testing.assert_allclose(stiffness @ q, [0.04, 0.04], rtol=1e-6)
