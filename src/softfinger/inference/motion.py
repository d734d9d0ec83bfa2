"""Motion of trials whose own parameters and effects are draws: many at once."""

import numpy as np
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.inference.problem import OWN, TOLERANCE, Candidate, Problem
from softfinger.inference.reduce import reduce_trials
from softfinger.mechanics.effects.model import EffectModel
from softfinger.mechanics.forward.simulate import simulate_joint_angle_array
from softfinger.mechanics.forward.slots import SlotArrays


def move_trials(
    problem: Problem,
    model: EffectModel,
    own: NDArray[np.float64],
    effect: NDArray[np.float64],
    like: NDArray[np.int64],
    time: NDArray[np.float64],
    load: tuple[NDArray[np.float64], NDArray[np.float64]],
) -> NDArray[np.float64]:
    """Compute the angles (m, joint, n) [rad] of m trials, each with its own draw of everything.

    Parameters
    ----------
    problem, model
        The campaign, and the model that moves its finger.
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
        own, slots, [], problem.finger, time, *load, by_own=False, tolerance=TOLERANCE
    )
    angle[failed] = np.nan
    return angle


def fill_draw_slots(
    model: EffectModel, effect: NDArray[np.float64], like: NDArray[np.int64]
) -> tuple[SlotArrays, NDArray[np.bool_]]:
    """Slots of m trials under their own φ (m, p), and which φ (m,) has none."""
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
    """Exact χ² (draw, trial) of draws of all trials; infinite where the model has no motion.

    Parameters
    ----------
    own, effect
        η (draw, trial, d) and φ (draw, p).
    """
    trials = problem.trials
    draws, n, _ = own.shape
    node = trials.node.reshape(n, -1)
    angle = move_trials(
        problem,
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
