"""First guesses of base parameters, over rates."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from softfinger.inference.budget import BUDGET
from softfinger.measurement.trials import Trials
from softfinger.mechanics.load import integrate_load_array
from softfinger.mechanics.three_element import compute_elastic_basis_array

LEAST_SHARE = 1e-3  # of the largest angle: a smaller elastic or flowing part counts as this


def guess_own(trials: Trials) -> NDArray[np.float64]:
    """Guess the own parameters of each joint (joint, 4).

    (log k_v, log c_v, log c_p, q_ini): medians over some trials.

    A joint that no load moves gets parameters that move it little.
    """
    chosen = np.unique(
        np.linspace(0, len(trials.name) - 1, min(BUDGET.guess_trials, len(trials.name))).astype(int)
    )
    guesses = np.full((len(chosen), trials.joints, 4), np.nan)
    for row, i in enumerate(chosen):
        bins = trials.bins[i]
        time = trials.node[i, :bins].mean(axis=1)
        load = trials.load_time[i], trials.load_torque[i]
        if not np.any(load[1]):
            continue
        span = time[-1] - time[0]
        shortest = np.diff(time)[np.diff(time) > 0].min()
        rates = np.geomspace(1.0 / span, 1.0 / shortest, BUDGET.guess_rates)
        basis, _ = compute_elastic_basis_array(rates, time, *load)
        flow = integrate_load_array(time, *load)
        for j in np.flatnonzero(trials.present[i]):
            guesses[row, j] = _guess_joint(rates, basis, flow, trials.angle[i, :bins, j])
    guess = np.array([_median(guesses[:, j]) for j in range(trials.joints)])
    known = np.isfinite(guess[:, 0])
    usual = np.median(guess[known], axis=0) if known.any() else np.zeros(4)
    return np.where(np.isfinite(guess), guess, usual)


def _median(values: NDArray) -> NDArray:
    good = values[np.isfinite(values).all(axis=1)]
    return np.median(good, axis=0) if len(good) else np.full(values.shape[1], np.nan)


def _guess_joint(rates: NDArray, basis: NDArray, flow: NDArray, angle: NDArray) -> NDArray:
    best = (np.inf, rates[0], np.zeros(4))
    for rate, elastic in zip(rates, basis, strict=True):
        one = np.ones_like(angle)
        design = np.column_stack([elastic, flow, one, -one])
        solution, misfit = nnls(design, angle)
        if misfit < best[0]:
            best = (misfit, rate, solution)
    _, rate, (elastic_part, flow_part, up, down) = best
    size = LEAST_SHARE * max(np.abs(angle).max(), 1e-6)
    soft = max(elastic_part, size / np.abs(basis).max())
    thin = max(flow_part, size / max(np.abs(flow).max(), 1e-300))
    return np.array([-np.log(soft), -np.log(soft * rate), -np.log(thin), up - down])
