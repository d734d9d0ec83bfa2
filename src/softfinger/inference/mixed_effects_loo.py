"""Leave-one-trial-out scores of a mixed-effects fit.

They show how well the other trials predict each one, its own parameters integrated:

    log p(z_i | z_−i) = log p(z | Ω_−i) − log p(z_−i | Ω_−i)

in the model linearised at the modes; μ and φ are integrated given the other trials, and Ω_−i is the
full Ω moved by one EM step that leaves the trial out. With many trials one trial does not move Ω.
"""

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled.threads import run_side_by_side
from softfinger.inference.budget import BUDGET
from softfinger.inference.mixed_effects import LOG_TWO_PI, Prior, solve_gram
from softfinger.inference.mixed_effects_laplace import Fit
from softfinger.inference.mixed_effects_linearised import centre_gram


def compute_left_out(
    fit: Fit, prior: Prior, rows: NDArray[np.int64], logdet: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Compute each trial's leave-one-out log density (trial,) [nats].

    Parameters
    ----------
    fit
        A fit; its linearisation is used.
    rows, logdet
        (trial,) numbers and log|Σ| of its noise.
    """
    moved, near, _ = centre_gram(fit.gram, prior, fit.own, fit.shared)
    moved = np.ascontiguousarray(moved)
    moves = len(moved) <= BUDGET.omega_moves

    def run(some: slice) -> tuple[NDArray]:
        return (_leave_out(moved, near, fit.omega, moves, some),)

    square = run_side_by_side(run, len(moved))[0]
    return square - 0.5 * rows * LOG_TWO_PI - 0.5 * logdet


def _leave_out(
    gram: NDArray[np.float64], prior: Prior, omega: NDArray[np.float64], moves: bool, some: slice
) -> NDArray[np.float64]:
    whole, density = solve_gram(gram, prior, omega)[5], []
    for i in range(len(gram))[some]:
        others, left = np.delete(gram, i, axis=0), omega
        if moves:
            left = solve_gram(others, prior, omega)[6]
            whole = solve_gram(gram, prior, left)[5]
        density.append(whole - solve_gram(others, prior, left)[5])
    return np.array(density)
