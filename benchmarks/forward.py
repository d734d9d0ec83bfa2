"""The forward model: full dynamics beside LSODA, and the quasi-static model with its gradients.

Fingers of the paper's table (joint 3's c_p from log-normal(3.3, 0.9)) under its step of 8 N for
30 s, filmed at 30 frames per second. CPU time; ratios within this run, the median of repeats.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from softfinger.compiled import compiled
from softfinger.mechanics.chain import (
    compute_inertia_coefficients,
    fill_inertia_and_nonlinear_term,
)
from softfinger.mechanics.dynamics import TOLERANCE, simulate_full_dynamics_array
from softfinger.mechanics.forward.simulate import (
    describe_unknown_finger,
    simulate_joint_angle_array,
)
from softfinger.mechanics.forward.slots import build_slots
from softfinger.mechanics.geometry import FingerGeometry
from softfinger.mechanics.linear import factorise, solve_factorised
from softfinger.mechanics.wires import moment_arm

MU = np.array([[-2.4441, -2.2986, -1.88], [-3.6635, -3.6476, -3.8777], [2.8538, 3.1129, 3.3]])
SIGMA = np.array([[0.1973, 0.2238, 0.3957], [0.5232, 0.4838, 0.8223], [0.7011, 0.8496, 0.9]])
GEOMETRY = FingerGeometry.uniform([0.025] * 3, [0.005] * 3, 0.008, 0.005)
INERTIA = compute_inertia_coefficients(GEOMETRY)
HALF_LENGTH, OFFSET, TENSION = GEOMETRY.joint_length / 2, GEOMETRY.wire_offset, 8.0
FRAMES = np.arange(1, 901) / 30.0
TRIALS, FINGERS, REPEATS = 100, 9, 15
ACCURACY_RAD = 1e-6
RIVAL_TOLERANCES = 10.0 ** -np.arange(4.0, 11.5, 0.5)


def measure() -> dict[str, float]:
    """Measure speed and accuracy of both models."""
    parameters = _draw_parameters(np.random.default_rng(1), TRIALS)
    return {**measure_full_dynamics(parameters), **measure_quasi_static(parameters)}


def measure_full_dynamics(parameters: NDArray[np.float64]) -> dict[str, float]:
    """Integrate fingers one by one, each beside the loosest LSODA that is within 1e-6 rad."""
    ratios, errors, ours, theirs = [], [], [], []
    for k_v, c_v, c_p, q_ini in np.moveaxis(parameters[:, :FINGERS], 1, 0):
        finger = (k_v, c_v, c_p, q_ini)
        exact = _run_lsoda(finger, 1e-13)
        tolerance, rival_error = next(
            (tolerance, error)
            for tolerance in RIVAL_TOLERANCES
            if (error := np.abs(_run_lsoda(finger, tolerance) - exact).max()) <= ACCURACY_RAD
        )
        errors.append((np.abs(_run_ours(finger) - exact).max(), rival_error))
        ours.append(_time(lambda f=finger: _run_ours(f), 20))
        theirs.append(_time(lambda f=finger, t=tolerance: _run_lsoda(f, t), 3))
        ratios.append(theirs[-1] / ours[-1])
    error, rival_error = np.max(errors, axis=0)
    return {
        "forward_full_dynamics_speedup_vs_lsoda": float(np.median(ratios)),
        "forward_full_dynamics_ms": 1e3 * float(np.median(ours)),
        "forward_full_dynamics_lsoda_ms": 1e3 * float(np.median(theirs)),
        "forward_full_dynamics_error_rad": float(error),
        "forward_full_dynamics_lsoda_error_rad": float(rival_error),
    }


def measure_quasi_static(parameters: NDArray[np.float64]) -> dict[str, float]:
    """Angles of 100 trials × 3 joints × 900 frames with all gradients, on one core."""
    natural = np.stack([*np.log(parameters[:3]), parameters[3]], axis=-1)
    slots, finger = build_slots(TRIALS, 3, {}), describe_unknown_finger(3)

    def run() -> None:
        simulate_joint_angle_array(natural, slots, [], finger, FRAMES, [0.0], [OFFSET * TENSION])

    run()  # compiles
    times = [_time(run, 1) for _ in range(REPEATS)]
    return {"forward_quasistatic_gradient_ms": 1e3 * float(np.median(times))}


def _draw_parameters(rng: np.random.Generator, trials: int) -> NDArray[np.float64]:
    """k_v, c_v, c_p, q_ini: (4, trial, joint)."""
    logs = MU[:, None] + SIGMA[:, None] * rng.standard_normal((3, trials, 3))
    return np.stack([*np.exp(logs), rng.normal(0.02, 0.01, (trials, 3))])


def _run_ours(finger: tuple[NDArray, ...]) -> NDArray[np.float64]:
    columns = [np.ascontiguousarray(value)[None] for value in finger]
    load = np.zeros((1, 1)), np.full((1, 1), TENSION)
    return simulate_full_dynamics_array(
        *columns, INERTIA, HALF_LENGTH, OFFSET, FRAMES, *load, TOLERANCE
    )[0][0, 0]


def _run_lsoda(finger: tuple[NDArray, ...], tolerance: float) -> NDArray[np.float64]:
    k_v, c_v, c_p, q_ini = (np.ascontiguousarray(value) for value in finger)
    solution = solve_ivp(
        _rate, (0.0, FRAMES[-1]), np.concatenate([q_ini, np.zeros(6)]), "LSODA", FRAMES,
        args=(k_v, c_v, c_p), rtol=tolerance, atol=tolerance,
    )  # fmt: skip
    return solution.y[:3]


@compiled
def _rate(
    moment: float, state: NDArray, k_v: NDArray, c_v: NDArray, c_p: NDArray
) -> NDArray[np.float64]:
    """The equations of motion, states q, q̇, q_v."""
    angle, velocity, elastic = state[:3], state[3:6], state[6:]
    matrix, push, rate = np.empty((3, 3)), np.empty(3), np.empty(9)
    fill_inertia_and_nonlinear_term(angle, velocity, INERTIA, matrix, push)
    for j in range(3):
        share = c_p[j] / (c_v[j] + c_p[j])
        torque = moment_arm(angle[j], HALF_LENGTH, OFFSET) * TENSION
        push[j] = torque - share * (k_v[j] * elastic[j] + c_v[j] * velocity[j]) - push[j]
        rate[j] = velocity[j]
        rate[6 + j] = share * velocity[j] - k_v[j] * elastic[j] / (c_v[j] + c_p[j])
    factorise(matrix)
    solve_factorised(matrix, push)
    rate[3:6] = push
    return rate


def _time(task: Callable[[], object], repeat: int) -> float:
    """CPU seconds of one run."""
    start = time.process_time()
    for _ in range(repeat):
        task()
    return (time.process_time() - start) / repeat
