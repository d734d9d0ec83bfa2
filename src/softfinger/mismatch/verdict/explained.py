"""What listed effects explain, whatever else may be missing."""

import numpy as np
from scipy.stats import norm

from softfinger.artifacts.verdict import Explained, NotTried
from softfinger.inference.problem import Candidate, Problem
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.checks.summary import compute_excess, compute_square_excess
from softfinger.mismatch.checks.turned import list_turned
from softfinger.mismatch.search.settle import Posterior
from softfinger.mismatch.search.stepwise import Search


def list_explained(
    problem: Problem, search: Search, posterior: Posterior, needed: float
) -> list[Explained]:
    """List the best sets of effects, most evidence first.

    Of the evidence that is missing under the base model a set explains its gain g over it; what
    is missing under the set itself is half of that part of χ² which lasts from bin to bin. Noise
    of another size than was measured changes both alike, and so not the share. The best set of
    the search comes first, or what further effects make of it.

    Parameters
    ----------
    needed
        Gain [nats] that a set must have to be listed.
    """
    base, best = search.base, search.best
    found = {ids: c for ids, c in posterior.best.items() if ids and c.fit is not None}
    found |= {c.model.ids - base.model.ids: c for c in search.beyond}
    gains = {ids: c.log_evidence - base.log_evidence for ids, c in found.items()}
    order = sorted(gains, key=lambda ids: (not found[ids].model.ids >= best.model.ids, -gains[ids]))
    listed = [ids for ids in order if gains[ids] > needed][: BUDGET.explained]
    return [
        Explained(
            effects=sorted(ids),
            gain_nats=gains[ids],
            share=gains[ids] / (gains[ids] + measure_left(problem, found[ids])),
            amplitudes_cover_zero=covers_zero(found[ids]),
            turned_back=list_turned(problem, found[ids]),
        )
        for ids in listed
    ]


def measure_left(problem: Problem, candidate: Candidate) -> float:
    """Missing evidence [nats]: half the lasting part of χ².

    With e the variance of what lasts over that of what does not (`compute_excess`), the part is
    e / (1 + e).
    """
    rows = problem.trials.size[problem.trials.protocol]
    lasting = max(compute_excess(problem, candidate)[0], 0.0)
    square = (1.0 + compute_square_excess(candidate.fit, rows)) * float(rows.sum())
    return 0.5 * square * lasting / (1.0 + lasting)


def covers_zero(candidate: Candidate) -> bool:
    """Whether every amplitude's 90 % interval contains zero."""
    model, fit = candidate.model, candidate.fit
    sd = np.sqrt(np.diag(fit.shared_covariance))
    places = np.asarray(model.amplitudes)
    return bool((np.abs(fit.shared[places]) <= norm.ppf(0.95) * sd[places]).all())


def list_not_tried(refused: dict[str, str]) -> list[NotTried]:
    """List effects that cannot show, and why."""
    return [NotTried(id=name, reason=reason) for name, reason in sorted(refused.items())]
