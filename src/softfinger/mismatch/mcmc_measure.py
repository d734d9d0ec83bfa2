"""The full model's χ² at many points of φ and η at once: what the sampler's chains ask for."""

import numpy as np
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.mechanics.forward.simulate import simulate_joint_angle_array
from softfinger.mechanics.forward.slots import SlotArrays
from softfinger.mismatch.problem import OWN, TOLERANCE, Candidate, Problem
from softfinger.mismatch.reduce import reduce_trials


def measure_chains(
    problem: Problem, candidate: Candidate, own: NDArray[np.float64], effect: NDArray[np.float64]
) -> NDArray[np.float64]:
    """χ² of each trial in each chain; infinite where the model cannot be integrated.

    Parameters
    ----------
    candidate
        The model, and a fit whose φ stands in where a chain's φ has no slots.
    own, effect
        η (chain, trial, d) and φ (chain, p).

    Returns
    -------
    chi_square : (chain, trial)
    """
    trials = problem.trials
    chains, n, _ = own.shape
    slots, failed = _fill_slots(candidate, effect)
    wide = own.reshape(chains * n, trials.joints, OWN)
    repeated = [
        np.tile(a, (chains, 1))
        for a in (trials.node.reshape(n, -1), trials.load_time, trials.load_torque)
    ]

    angle, _ = simulate_joint_angle_array(
        wide, slots, [], problem.finger, *repeated, by_own=False, tolerance=TOLERANCE
    )
    angle = angle.reshape(chains, n, *angle.shape[1:])
    empty = np.zeros((*angle.shape[1:], 0))
    chi_square = np.stack([reduce_trials(trials, a, empty)[:, 0, 0] for a in angle])
    chi_square[failed] = np.inf
    return np.where(np.isfinite(chi_square), chi_square, np.inf)


def _fill_slots(
    candidate: Candidate, effect: NDArray[np.float64]
) -> tuple[SlotArrays, NDArray[np.bool_]]:
    """Slots of all chains' trials in one; chains whose φ has none."""
    filled, failed = [], np.zeros(len(effect), bool)
    for c, phi in enumerate(effect):
        try:
            filled.append(candidate.model.fill_slots(phi))
        except (ArithmeticError, Fault):
            filled.append(candidate.model.fill_slots(candidate.fit.shared))
            failed[c] = True
    return SlotArrays(*(np.concatenate(parts) for parts in zip(*filled, strict=True))), failed
