"""Chance's best gain over the catalogue, by bootstrap.

The bootstrap is parametric.

Each replicate (`replicates`) is fitted anew (Ω and μ); every form's gain is its one-step score: the
log evidence of the linear model with the form's amplitudes.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from softfinger.compiled import compiled
from softfinger.inference.mixed_effects import (
    Prior,
    climb_omega,
    fit_linear,
    invert_scaled,
    solve_gram,
)
from softfinger.inference.problem import Candidate, Problem
from softfinger.mismatch.candidates.columns import ScoreColumns
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.priors import PRIORS
from softfinger.mismatch.search.replicates import draw_products, set_apart

ROUNDS, SLIGHT = 3, 0.1  # of EM, and the nats at which it stops: a score errs by more


class FalseAlarms(NamedTuple):
    """Largest gain in each replicate (replicate,) [nats].

    It is over the whole catalogue.
    """

    gain: NDArray[np.float64]

    def p_value(self, gain: float) -> float:
        """Probability that chance alone gains this much or more.

        Beyond the replicates' upper fifth the tail is exponential, with its own mean excess.

        >>> FalseAlarms(np.arange(100.0)).p_value(49.5)
        0.5
        """
        ordered = np.sort(self.gain)
        edge = ordered[-int(np.ceil(DECISIONS.tail_share * len(ordered)))]
        if gain <= edge:
            return float(np.mean(self.gain >= gain))
        beyond = ordered[ordered >= edge] - edge
        share = np.mean(self.gain >= edge)
        return float(share * np.exp(-(gain - edge) / max(beyond.mean(), 0.5)))

    def threshold(self, probability: float) -> float:
        """Gain [nats] that chance exceeds with a probability.

        The probability is below the tail's share.
        """
        ordered = np.sort(self.gain)
        edge = ordered[-int(np.ceil(DECISIONS.tail_share * len(ordered)))]
        beyond = ordered[ordered >= edge] - edge
        share = np.mean(self.gain >= edge)
        return float(edge + max(beyond.mean(), 0.5) * np.log(share / probability))


def calibrate_false_alarms(
    columns: ScoreColumns,
    problem: Problem,
    base: Candidate,
    rng: np.random.Generator,
    replicates: int,
) -> FalseAlarms:
    """Find the largest gain in replicates without effects.

    The replicates are drawn from the base model.
    """
    d = len(base.fit.omega)
    whole = set_apart(columns.bare)
    prior = problem.build_prior(base.model)
    away = prior.mean[:d] - base.fit.mean  # only differences keep their digits
    prior = prior._replace(mean=away, precision=prior.precision[:d])
    largest = np.empty(replicates)
    for k, product in enumerate(draw_products(whole, base, prior, rng, replicates)):
        gains, sizes, alone = score_columns_array(columns, whole, product, prior, base.fit.omega)
        gains = np.where(np.isfinite(gains), gains, -np.inf)
        largest[k] = gains.max(initial=0.0)
        if gains.size:  # the best form by its score gains what a fit of it does
            try:
                form = int(gains.argmax())
                sized = form, float(sizes[form])
                again = _refit(columns, whole, product, prior, base.fit.omega, sized) - alone
            except np.linalg.LinAlgError:  # numbers beyond their range: its score is what is known
                continue
            largest[k] = max(largest[k], again)
    return FalseAlarms(largest)


def _refit(
    columns: ScoreColumns,
    whole: NDArray,
    product: NDArray,
    prior: Prior,
    omega: NDArray,
    sized: tuple[int, float],
) -> float:
    """Log evidence [nats] of one form at a size, Ω fitted anew.

    What differs between trials may shrink.
    """
    d, (form, size) = len(omega), sized
    more = columns.first[form] + np.arange(columns.count[form])
    sd = columns.sd[more] * np.where(columns.law[more], size, 1.0)
    wider = prior._replace(
        mean=np.append(prior.mean, np.zeros(len(more))),
        precision=np.append(prior.precision, sd**-2.0),
    )
    kept = np.append(np.arange(d), d + more)
    gram = np.zeros((len(product), len(kept) + 1, len(kept) + 1))
    gram[:, :-1, :-1] = whole[:, kept[:, None], kept]
    gram[:, :-1, -1] = gram[:, -1, :-1] = product[:, kept]
    return fit_linear(gram, wider, omega, rounds=ROUNDS, tolerance=SLIGHT).log_evidence


def score_columns_array(
    columns: ScoreColumns,
    gram: NDArray[np.float64],
    product: NDArray[np.float64],
    prior: Prior,
    omega: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Gain [nats] and size of each form (form,); evidence of none.

    Ω is fitted under the base model. A law has the size with which it gains most.

    Parameters
    ----------
    gram, product
        CᵀC (trial, d + c, d + c) of the columns alone, and Cᵀz (trial, d + c).
    """
    forms = columns.first, columns.count
    sizes = np.array(PRIORS.law_sizes)
    gain, size, mean, sd, alone = _score(
        gram, product, forms, columns.sd, columns.law, sizes, prior, omega
    )
    inside = norm.logcdf(mean / sd) + np.log(2.0)
    cut = np.where(columns.positive, inside, 0.0)
    add = np.add.reduceat(cut, columns.first) if len(columns.first) else np.zeros(0)
    return gain + add, size, alone


@compiled
def _score(
    gram: NDArray,
    product: NDArray,
    forms: tuple[NDArray, NDArray],
    amplitude_sd: NDArray,
    law: NDArray,
    sizes: NDArray,
    prior: Prior,
    omega: NDArray,
) -> tuple[NDArray, NDArray, NDArray, NDArray, float]:
    """Gain, size and amplitudes of each form; evidence without any.

    Mean and sd of each amplitude: one Ω, one inverse for each trial.
    """
    first, count = forms
    trials, d = gram.shape[0], omega.shape[0]
    own = np.zeros((trials, d + 1, d + 1))
    own[:, :d, :d] = gram[:, :d, :d]
    own[:, :d, d] = product[:, :d]
    own[:, d, :d] = product[:, :d]
    omega, _ = climb_omega(own, prior, omega, ROUNDS, SLIGHT)
    shared, covariance, _, _, _, alone, _ = solve_gram(own, prior, omega)
    cross, direct, square = _take_up(gram, product, own, first, count, omega)
    direct -= cross @ shared
    gain, chosen = np.full(first.size, -np.inf), np.ones(first.size)
    location, sd = np.zeros(amplitude_sd.size), np.ones(amplitude_sd.size)
    for form in range(first.size):
        p, begin = count[form], first[form]
        part = slice(begin, begin + p)
        seen = square[part, :p] - cross[part] @ covariance @ cross[part].T
        for size in sizes if law[part].any() else sizes[:1]:
            wide = np.where(law[part], size * amplitude_sd[part], amplitude_sd[part])
            hessian = np.diag(wide**-2.0) + seen
            inside = np.linalg.inv(hessian)
            place = inside @ direct[part]
            volume = np.linalg.slogdet(hessian)[1] + 2.0 * np.sum(np.log(wide))
            now = 0.5 * (place @ direct[part] - volume)
            if not now > gain[form]:
                continue
            gain[form], chosen[form], location[part] = now, size, place
            for a in range(p):
                sd[begin + a] = np.sqrt(inside[a, a])
    return gain, chosen, location, sd, alone


@compiled
def _take_up(
    gram: NDArray,
    product: NDArray,
    own: NDArray,
    first: NDArray,
    count: NDArray,
    omega: NDArray,
) -> tuple[NDArray, NDArray, NDArray]:
    """What is left of columns beside every trial's η.

    Their products with ∂F/∂μ and with z, and each form's columns with one another.
    """
    d, size = omega.shape[0], gram.shape[1] - omega.shape[0]
    inverse = np.linalg.inv(omega)
    cross, direct = np.zeros((size, d)), np.zeros(size)
    square = np.zeros((size, count.max() if count.size else 0))
    for i in range(gram.shape[0]):
        kept = invert_scaled(inverse + own[i, :d, :d])
        side = np.ascontiguousarray(gram[i, d:, :d])
        taken = side @ kept
        cross += side - taken @ np.ascontiguousarray(own[i, :d, :d])
        direct += product[i, d:] - taken @ product[i, :d]
        for form in range(first.size):
            begin = first[form]
            for a in range(begin, begin + count[form]):
                for b in range(begin, begin + count[form]):
                    left = gram[i, d + a, d + b]
                    for c in range(d):
                        left -= taken[a, c] * side[b, c]
                    square[a, b - begin] += left
    return cross, direct, square


def project_columns_array(
    gram: NDArray[np.float64],
    d: int,
    precision: NDArray[np.float64],
    omega: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What is left of columns once parameters adapt.

    η ~ N(μ, Ω) and μ take up what they can.

    Returns
    -------
    left, shift
        Gram matrix (c, c) of what is left; what each column adds to μ (d, c).
    """
    inverse = np.linalg.inv(omega)
    kept = np.linalg.inv(inverse + gram[:, :d, :d])
    cross = gram[:, :, :d]
    marginal = (gram - cross @ kept @ cross.transpose(0, 2, 1)).sum(axis=0)
    mean = marginal[:d, :d] + np.diag(precision)
    shift = np.linalg.solve(mean, marginal[:d, d:])
    return marginal[d:, d:] - marginal[d:, :d] @ shift, shift
