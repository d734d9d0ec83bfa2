"""LSODA with its own driver in C and a compiled right-hand side.

It is the best of what SciPy has: the driver runs from frame to frame in machine code, and Python is
passed only on the way to the right-hand side, which is compiled. Its switching between stiff and
non-stiff rules spares it Newton steps where the finger has come to rest.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import odeint

from benchmarks.rivals.equations import ROOM, STATES, fill_rate, start_state
from softfinger.compiled import compiled


@compiled
def _rate(
    moment: float, state: NDArray, k_v: NDArray, c_v: NDArray, c_p: NDArray, room: NDArray
) -> NDArray[np.float64]:
    rate = np.empty(STATES)
    fill_rate(state, k_v, c_v, c_p, room, rate)
    return rate


def run(finger: tuple[NDArray, ...], frames: NDArray, tolerance: float) -> NDArray[np.float64]:
    """Joint angles (joint, frame) [rad] of a finger k_v, c_v, c_p, q_ini under the step."""
    k_v, c_v, c_p, q_ini = (np.ascontiguousarray(value) for value in finger)
    moments = np.concatenate([[0.0], frames])
    solution = odeint(
        _rate, start_state(q_ini), moments, (k_v, c_v, c_p, np.empty(ROOM)), rtol=tolerance,
        atol=tolerance, mxstep=1_000_000, tfirst=True,
    )  # fmt: skip
    return solution[1:, :3].T
