import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from softfinger.mechanics.chain import compute_inertia_coefficients
from softfinger.mechanics.dynamics import simulate_full_dynamics
from softfinger.mechanics.geometry import FingerGeometry
from softfinger.mechanics.load import evaluate_load_array
from softfinger.mechanics.wires import compute_moment_arm_array

TIME = np.r_[0.0, np.geomspace(1e-4, 11.9, 40)]
FRAMES = np.unique(np.r_[TIME, np.arange(0.0, 12.0, 1 / 30)])
LOAD = (np.array([0.0, 3.0, 3.0, 5.0]), np.array([8.0, 8.0, 2.0, 6.0]))


@pytest.mark.parametrize(
    ("wire_geometry", "damping", "rtol"), [("constant_arm", 1.0, 1e-9), ("paper", 1e-2, 1e-11)]
)
def test_agrees_with_an_independent_integrator(
    parameters, geometry, evaluate_chain, wire_geometry, damping, rtol
):
    """At every frame, for a usual finger and for one that swings a hundred times longer."""
    one = parameters.isel(trial=[0])
    one = one.assign(c_v=damping * one.c_v)
    k_v, c_v, c_p, q_ini = (one[n].to_numpy()[0] for n in ("k_v", "c_v", "c_p", "q_ini"))
    coefficients = compute_inertia_coefficients(geometry)
    share = c_p / (c_p + c_v)

    def rate(time, state, tension):
        q, w, q_v = state.reshape(3, 3)
        arm = compute_moment_arm_array(q, 0.008, 0.005) if wire_geometry == "paper" else 0.005
        inner = share * (k_v * q_v + c_v * w)
        matrix, term = evaluate_chain(q, w, coefficients)
        turn = np.linalg.solve(matrix, arm * tension(time) - inner - term)
        return np.concatenate([w, turn, share * w - k_v * q_v / (c_v + c_p)])

    state, pieces = np.r_[q_ini, np.zeros(6)], []
    for start, end in ((0.0, 3.0), (3.0, 5.0), (5.0, 12.0)):
        middle = np.array([start, end - 1e-9])
        values = evaluate_load_array(middle, *LOAD)
        inside = FRAMES[(start <= FRAMES) & (end > FRAMES)]
        solution = solve_ivp(
            rate, (start, end), state, "LSODA", np.r_[inside, end],
            args=(lambda t, v=values, m=middle: np.interp(t, m, v),), rtol=rtol, atol=1e-2 * rtol,
        )  # fmt: skip
        pieces.append(solution.y[:3, : inside.size])
        state = solution.y[:, -1]
    motion = simulate_full_dynamics(one, geometry, FRAMES, *LOAD, wire_geometry)
    np.testing.assert_allclose(
        motion.joint_angle[0], np.concatenate(pieces, axis=1), rtol=0, atol=1e-6
    )


def test_one_link_has_a_closed_form(parameters):
    """q, q̇, q_v of a single joint under a constant torque: a linear system of three."""
    one = parameters.isel(joint=[0])
    geometry = FingerGeometry.uniform([0.025], [0.005], 0.008, 0.005)
    motion = simulate_full_dynamics(one, geometry, TIME, [0.0], [8.0])
    inertia = 0.005 * 0.025**2 / 3
    for trial in range(one.sizes["trial"]):
        k_v, c_v, c_p, q_ini = (float(one[n][trial, 0]) for n in ("k_v", "c_v", "c_p", "q_ini"))
        share = c_p / (c_p + c_v)
        system = np.zeros((4, 4))
        system[0, 1] = 1.0
        system[1] = [0.0, -share * c_v / inertia, -share * k_v / inertia, 0.04 / inertia]
        system[2, 1], system[2, 2] = share, -k_v / (c_v + c_p)
        exact = [(expm(system * t) @ [q_ini, 0.0, 0.0, 1.0])[0] for t in TIME]
        np.testing.assert_allclose(motion.joint_angle[trial, 0], exact, rtol=0, atol=1e-6)


def test_tolerance_holds_over_the_population(parameters, geometry, monkeypatch):
    from softfinger.mechanics import dynamics

    arguments = (parameters, geometry, np.linspace(0.0, 30.0, 901), [0.0], [8.0], "paper")
    usual = simulate_full_dynamics(*arguments).joint_angle
    monkeypatch.setattr(dynamics, "TOLERANCE", 1e-11)
    assert np.abs(usual - simulate_full_dynamics(*arguments).joint_angle).max() < 1e-6
