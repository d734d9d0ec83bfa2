"""All trials of a run, seen by the camera."""

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.compiled.borrowed import borrow, keep_alive
from softfinger.mechanics.forward.hooks import OBSERVE, call_observe
from softfinger.mechanics.forward.trial import run_trial
from softfinger.mechanics.forward.work import allocate_model, allocate_work


@compiled
def run_trials(
    joint: NDArray,
    chain: NDArray,
    coupling: NDArray,
    law: NDArray,
    d_joint: NDArray,
    d_chain: NDArray,
    d_coupling: NDArray,
    d_law: NDArray,
    rest: tuple,
    modes: int,
    mixed: bool,
    has_law: bool,
    time: NDArray,
    load_time: NDArray,
    load_torque: NDArray,
    by_own: bool,
    tolerance: float,
    longest: float,
) -> tuple[NDArray, NDArray]:
    """Run every trial in turn, in the same arrays.

    Parameters
    ----------
    joint, chain, coupling, law
        Values of the slots, trial first; d_joint … along each direction, direction first.
    rest
        The fields of `Model` from `hook` on.
    modes, mixed, has_law
        How many modes a joint has; whether a column moves joints besides its own; whether any law
        is on.

    Returns
    -------
    Angles (trial, joint, n) and gradients (trial, joint, n, column), NaN in a trial that could not
    be integrated.
    """
    trials, joints, _ = joint.shape
    own = 4 * joints * by_own
    columns = own + len(d_joint)
    owners = (
        allocate_model(joint, chain, coupling, law, by_own, columns, mixed, rest),
        allocate_work(joints, modes, columns),
    )
    model, work = borrow(owners[0]), borrow(owners[1])
    angle = np.full((trials, joints, time.shape[1]), np.nan)
    gradient = np.zeros((*angle.shape, columns))
    for trial in range(trials):
        model.joint[:], model.chain[:] = joint[trial], chain[trial]
        model.coupling[:] = coupling[trial]
        if has_law:
            model.law[:] = law[trial]
            model.d_law[own:] = d_law[:, trial]
        model.d_joint[own:] = d_joint[:, trial]
        model.d_chain[own:] = d_chain[:, trial]
        model.d_coupling[own:] = d_coupling[:, trial]
        done = run_trial(
            model, work, time[trial], load_time[trial], load_torque[trial],
            tolerance, longest, angle[trial], gradient[trial],
        )  # fmt: skip
        if not done:
            angle[trial], gradient[trial] = np.nan, np.nan
        elif model.count[OBSERVE] > 0:
            true, by = angle[trial].copy(), gradient[trial].copy()
            for k in range(model.count[OBSERVE]):
                call_observe(model.hook[OBSERVE, k], model, true, by, angle[trial], gradient[trial])
    keep_alive(owners)
    return angle, gradient
