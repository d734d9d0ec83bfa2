"""CVODE with compiled driver and compiled right-hand side.

It is the best of its kind: the variable-order BDF code for stiff systems that LSODA grew into, with
a dense Newton matrix that is reused over many steps, maintained and tuned for thirty years. It gets
the exact Jacobian, as ours does. Nothing of Python runs between two frames: solver, right-hand side
and Jacobian call each other as machine code.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np
import sundials4py
from llvmlite import ir
from numba import carray, cfunc, njit, types
from numba.extending import intrinsic
from numpy.typing import NDArray

from benchmarks.rivals.equations import ROOM, STATES, fill_jacobian, fill_rate, start_state

_ADDRESS, _REAL, _INT = ctypes.c_size_t, ctypes.c_double, ctypes.c_int
_BDF, _NORMAL = 2, 1
_MOST_STEPS = 1_000_000
_FINGER = 9 + ROOM  # what the compiled functions are given: parameters, then room to work in
_LIBRARY = ctypes.CDLL(sundials4py.__file__)


def _take(name: str, *arguments: type, gives: type = _INT) -> Callable:
    """A function of SUNDIALS; addresses are whole numbers."""
    function = getattr(_LIBRARY, name)
    function.argtypes, function.restype = arguments, gives
    return function


_create_context = _take("SUNContext_Create", _INT, _ADDRESS)
_make_vector = _take("N_VMake_Serial", ctypes.c_int64, _ADDRESS, _ADDRESS, gives=_ADDRESS)
_make_matrix = _take("SUNDenseMatrix", ctypes.c_int64, ctypes.c_int64, _ADDRESS, gives=_ADDRESS)
_make_solver = _take("SUNLinSol_Dense", _ADDRESS, _ADDRESS, _ADDRESS, gives=_ADDRESS)
_create = _take("CVodeCreate", _INT, _ADDRESS, gives=_ADDRESS)
_begin = _take("CVodeInit", _ADDRESS, _ADDRESS, _REAL, _ADDRESS)
_begin_anew = _take("CVodeReInit", _ADDRESS, _REAL, _ADDRESS)
_set_tolerances = _take("CVodeSStolerances", _ADDRESS, _REAL, _REAL)
_set_solver = _take("CVodeSetLinearSolver", _ADDRESS, _ADDRESS, _ADDRESS)
_set_data = _take("CVodeSetUserData", _ADDRESS, _ADDRESS)
_set_most_steps = _take("CVodeSetMaxNumSteps", _ADDRESS, ctypes.c_long)
_advance = _take("CVode", _ADDRESS, _REAL, _ADDRESS, _ADDRESS, _INT)
_set_jacobian = _take("CVodeSetJacFn", _ADDRESS, _ADDRESS)
_find_columns = _take("SUNDenseMatrix_Data", _ADDRESS, gives=_ADDRESS)
_find_values = _take("N_VGetArrayPointer", _ADDRESS, gives=_ADDRESS)


@intrinsic
def _as_reals(context: object, address: types.Type) -> tuple:
    """The address as a pointer to reals."""

    def build(context: object, builder: ir.IRBuilder, signature: object, values: list) -> ir.Value:
        return builder.inttoptr(values[0], ir.DoubleType().as_pointer())

    return types.CPointer(types.float64)(types.uintp), build


@cfunc(types.int32(types.float64, types.uintp, types.uintp, types.uintp))
def _rate(moment: float, state: int, rate: int, finger: int) -> int:
    """The right-hand side in the form that CVODE calls."""
    at = carray(_as_reals(_find_values(state)), STATES)
    out = carray(_as_reals(_find_values(rate)), STATES)
    given = carray(_as_reals(finger), _FINGER)
    fill_rate(at, given[:3], given[3:6], given[6:9], given[9:], out)
    return 0


@cfunc(types.int32(types.float64, *7 * [types.uintp]))
def _jacobian(
    moment: float, state: int, rate: int, matrix: int, finger: int, one: int, two: int, three: int
) -> int:
    """The Jacobian in the form that CVODE calls; its matrix is stored by columns."""
    at = carray(_as_reals(_find_values(state)), STATES)
    out = carray(_as_reals(_find_columns(matrix)), (STATES, STATES))
    given = carray(_as_reals(finger), _FINGER)
    fill_jacobian(at, given[:3], given[3:6], given[6:9], given[9:], out)
    return 0


@njit
def _drive(
    memory: int, vector: int, values: NDArray, frames: NDArray, reached: NDArray, motion: NDArray
) -> int:
    """Advance from frame to frame; CVODE's flag of the last."""
    for frame in range(frames.size):
        flag = _advance(memory, frames[frame], vector, reached.ctypes.data, _NORMAL)
        if flag < 0:
            return flag
        motion[:, frame] = values[:3]
    return 0


class Cvode:
    """A solver that is made once and begins anew for every finger."""

    def __init__(self) -> None:
        """Make context, vector, matrix and solver."""
        self.values, self.finger = np.zeros(STATES), np.zeros(_FINGER)
        self.reached = np.zeros(1)
        context = np.zeros(1, np.uint64)
        _create_context(0, context.ctypes.data)
        context = int(context[0])
        self.vector = _make_vector(STATES, self.values.ctypes.data, context)
        self.memory = _create(_BDF, context)
        _begin(self.memory, _rate.address, 0.0, self.vector)
        matrix = _make_matrix(STATES, STATES, context)
        _set_tolerances(self.memory, 1e-6, 1e-6)
        _set_solver(self.memory, _make_solver(self.vector, matrix, context), matrix)
        _set_jacobian(self.memory, _jacobian.address)
        _set_data(self.memory, self.finger.ctypes.data)
        _set_most_steps(self.memory, _MOST_STEPS)

    def run(
        self, finger: tuple[NDArray, ...], frames: NDArray, tolerance: float
    ) -> NDArray[np.float64]:
        """Joint angles (joint, frame) [rad] of a finger k_v, c_v, c_p, q_ini under the step."""
        self.finger[:9] = np.concatenate(finger[:3])
        self.values[:] = start_state(finger[3])
        _begin_anew(self.memory, 0.0, self.vector)
        _set_tolerances(self.memory, tolerance, tolerance)
        motion = np.empty((3, frames.size))
        flag = _drive(self.memory, self.vector, self.values, frames, self.reached, motion)
        if flag < 0:
            raise ArithmeticError(f"CVODE gave up with flag {flag}")
        return motion
