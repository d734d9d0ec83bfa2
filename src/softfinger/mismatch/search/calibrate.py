"""Chance's best gain over the catalogue, by bootstrap.

The bootstrap is parametric.

Each replicate (`replicates`) is fitted anew (Ω and μ); every form's gain is its one-step score: the
log evidence of the linear model with the form's amplitudes.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.mixed_effects import Prior, fit_linear
from softfinger.inference.problem import Candidate, Problem
from softfinger.mismatch.candidates.columns import ScoreColumns
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.search.best_form import (
    ROUNDS,
    SLIGHT,
    BestForm,
    find_best_form,
    gather_squares,
)
from softfinger.mismatch.search.replicates import draw_products, set_apart


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
    tails = list(zip(columns.bare_rows, columns.freedom, strict=True))
    drawn = draw_products(whole, base, prior, rng, replicates, tails)
    squares, largest = gather_squares(columns, whole, d), np.empty(replicates)
    for k, product in enumerate(drawn):
        best, alone = find_best_form(columns, squares, product, prior, base.fit.omega)
        largest[k] = max(best.gain, 0.0)
        if best.columns.size:  # the best form by its score gains what a fit of it does
            try:
                again = _refit(columns, whole, product, prior, base.fit.omega, best) - alone
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
    best: BestForm,
) -> float:
    """Log evidence [nats] of one form, Ω fitted anew.

    What differs between trials may shrink.
    """
    d, more = len(omega), best.columns
    sd = columns.sd[more] * np.where(columns.law[more], best.size, 1.0)
    wider = prior._replace(
        mean=np.append(prior.mean, np.zeros(len(more))),
        precision=np.append(prior.precision, sd**-2.0),
    )
    kept = np.append(np.arange(d), d + more)
    gram = np.zeros((len(product), len(kept) + 1, len(kept) + 1))
    gram[:, :-1, :-1] = whole[:, kept[:, None], kept]
    gram[:, :-1, -1] = gram[:, -1, :-1] = product[:, kept]
    return fit_linear(gram, wider, omega, rounds=ROUNDS, tolerance=SLIGHT).log_evidence


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
