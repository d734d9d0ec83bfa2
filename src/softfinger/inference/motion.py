"""Motion of many trials, each with own effects."""

from collections.abc import Callable

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.inference.budget import BUDGET
from softfinger.inference.problem import Candidate, Problem
from softfinger.inference.reduce import reduce_trials
from softfinger.inference.setting_table import read_setting
from softfinger.mechanics import OWN
from softfinger.mechanics.effects.model import EffectModel
from softfinger.mechanics.effects.model_file import ModelFile, build_model
from softfinger.mechanics.effects.spread import vary_effects
from softfinger.mechanics.forward.simulate import Finger, simulate_joint_angle_array
from softfinger.mechanics.forward.slots import SlotArrays
from softfinger.mechanics.load import integrate_load_array
from softfinger.mechanics.three_element import compute_elastic_basis_array

Move = Callable[[NDArray, NDArray, NDArray, NDArray, NDArray, NDArray], NDArray[np.float64]]
"""(own (m, joint, 4), draw (m,), like (m,), time (n,), load_time, load_torque) → (m, joint, n)."""


def move_paper_joint(
    own: NDArray[np.float64],
    draw: NDArray[np.int_],
    like: NDArray[np.int_],
    time: NDArray[np.float64],
    load_time: NDArray[np.float64],
    load_torque: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Move fingers of the paper's joints: a `Move`.

    Without the gradient of `compute_joint_angle_array`, which would need four times the memory.

    >>> own = np.log([[[0.1, 0.01, 20.0, np.exp(0.03)]]])
    >>> move_paper_joint(own, 0, 0, np.array([10.0]), np.array([0.0]), np.array([0.04]))
    array([[[0.45]]])
    """
    k_v, c_v, c_p = np.exp(np.moveaxis(own[..., :3], -1, 0))[..., None]
    rate = (k_v / c_v).ravel()
    known = np.isfinite(rate)  # not of a spread that one trial cannot show
    lagged = np.full((rate.size, np.size(time)), np.nan)
    if known.any():
        lagged[known] = compute_elastic_basis_array(rate[known], time, load_time, load_torque)[0]
    flow = integrate_load_array(time, load_time, load_torque) / c_p
    return lagged.reshape(*own.shape[:2], -1) / k_v + flow + own[..., 3, None]


def build_mover(
    constant: xr.Dataset,
    content: ModelFile,
    effect: xr.DataArray,
    trial: xr.DataArray,
    rng: np.random.Generator | None = None,
) -> Move:
    """Build the function that moves a campaign's new trials.

    Parameters
    ----------
    constant
        The fit's constant data, of `tabulate_setting`: what differs between trials is that of the
        trial that a new one is like.
    effect
        (draw, effect_parameter), as the fit of that model names and orders them.
    trial
        Names of the recorded trials, in the order in which `like` counts them.
    rng
        Draws how parameters of effects differ between trials; None leaves each at its draw.

    Returns
    -------
    (own (m, joint, 4) logs but for q_ini; draw (m,) of the effects; like (m,) place of a recorded
    trial; time (n,) [s]; load_time, load_torque (knot,)) → angle (m, joint, n) [rad], NaN where
    the model could not be integrated.
    """
    setting, finger, fitted = read_setting(constant)
    model = build_model(content, setting)
    physical = effect.transpose("draw", "effect_parameter").to_numpy()
    internal = physical.copy()
    for k, entry in enumerate(model.entries):
        if entry.parameter.log:
            internal[:, k] = np.log(physical[:, k])
    if rng is not None:
        internal = vary_effects(model, internal, content.spreads, rng)
    known = {name: k for k, name in enumerate(fitted.values)}
    place = np.array([known.get(name, 0) for name in trial.values])

    def move(
        own: NDArray, draw: NDArray, like: NDArray, time: NDArray, *load: NDArray
    ) -> NDArray[np.float64]:
        return move_trials(finger, model, own, internal[draw], place[like], time, load)

    return move


def move_trials(
    finger: Finger,
    model: EffectModel,
    own: NDArray[np.float64],
    effect: NDArray[np.float64],
    like: NDArray[np.int64],
    time: NDArray[np.float64],
    load: tuple[NDArray[np.float64], NDArray[np.float64]],
) -> NDArray[np.float64]:
    """Compute the angles (m, joint, n) [rad] of trials.

    Parameters
    ----------
    finger, model
        What moves, and by which physics.
    own
        (m, joint, 4) log k_v, log c_v, log c_p, q_ini.
    effect
        (m, p) φ on the internal scale.
    like
        (m,) place of the recorded trial whose number, covariates and rest each one shares.
    time
        (n,) or (m, n) [s], nondecreasing; rows may end in NaN.
    load
        Times and values, (knot,) or (m, knot) [s], [N m].

    Returns
    -------
    (m, joint, n), NaN where time is, and where the model could not be integrated.
    """
    slots, failed = fill_draw_slots(model, effect, like)
    angle, _ = simulate_joint_angle_array(
        own, slots, [], finger, time, *load, by_own=False, tolerance=BUDGET.angle_error
    )
    angle[failed] = np.nan
    return angle


def fill_draw_slots(
    model: EffectModel, effect: NDArray[np.float64], like: NDArray[np.int64]
) -> tuple[SlotArrays, NDArray[np.bool_]]:
    """Slots under φ (m, p), and failures (m,)."""
    kinds, kind = np.unique(effect, axis=0, return_inverse=True) if effect.size else (
        effect[:1], np.zeros(len(effect), int)
    )  # fmt: skip
    kind = kind.ravel()
    filled, failed = None, np.zeros(len(effect), bool)
    for k, phi in enumerate(kinds):
        rows = np.flatnonzero(kind == k)
        try:
            slots = model.fill_slots(phi)
        except (ArithmeticError, Fault):
            failed[rows] = True
            continue
        if filled is None:
            filled = SlotArrays(*(np.zeros((len(effect), *s.shape[1:]), s.dtype) for s in slots))
        for whole, part in zip(filled, slots, strict=True):
            whole[rows] = part[like[rows]]
    if filled is None:
        raise Fault(f"{model.label}: no draw of its parameters has slots")
    for whole in filled:
        whole[failed] = whole[np.argmin(failed)]
    return filled, failed


def measure_draws(
    problem: Problem,
    candidate: Candidate,
    own: NDArray[np.float64],
    effect: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Exact χ² (draw, trial) of draws of all trials.

    It is infinite where the model has no motion.

    Parameters
    ----------
    own, effect
        η (draw, trial, d) and φ (draw, p).
    """
    trials = problem.trials
    draws, n, _ = own.shape
    node = trials.node.reshape(n, -1)
    angle = move_trials(
        problem.finger,
        candidate.model,
        own.reshape(draws * n, trials.joints, OWN),
        np.repeat(effect, n, axis=0),
        np.tile(np.arange(n), draws),
        np.tile(node, (draws, 1)),
        tuple(np.tile(a, (draws, 1)) for a in (trials.load_time, trials.load_torque)),
    )
    angle = angle.reshape(draws, n, *angle.shape[1:])
    empty = np.zeros((*angle.shape[1:], 0))
    square = np.stack([reduce_trials(trials, a, empty)[:, 0, 0] for a in angle])
    return np.where(np.isfinite(square), square, np.inf)
