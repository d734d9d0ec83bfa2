"""Two routes to every answer: closed forms, or samples."""

from collections.abc import Callable
from typing import NamedTuple

from softfinger.inference.motion import move_paper_joint
from softfinger.propagation import exact, sampled
from softfinger.propagation.new_trials import Source
from softfinger.propagation.populations import are_independent


class Route(NamedTuple):
    """Answers about new trials, alike on both routes."""

    compute_moments: Callable
    """(source, protocol, time, left of each spread) → mean, variance (draw, joint, time)"""
    share_variance: Callable
    """(source, protocol, time) → share of each set of parameters (draw, joint, time)"""
    find_quantiles: Callable
    """(source, protocol, time, probability) → (joint, time, p)"""
    compute_densities: Callable
    """(source, protocol, time, angle) → (joint, time, angle), (draw, joint, time, angle)"""


EXACT = Route(
    exact.compute_moments, exact.share_variance, exact.find_quantiles, exact.compute_densities
)
SAMPLED = Route(
    sampled.compute_moments,
    sampled.share_variance,
    sampled.find_quantiles,
    sampled.compute_densities,
)
# densities of correlated parameters have no closed form
CORRELATED = SAMPLED._replace(
    compute_moments=exact.compute_correlated_moments,
    share_variance=exact.share_correlated_variance,
)


def choose_route(source: Source) -> Route:
    """Choose closed forms if the source's model has them.

    The paper's joint has them if its parameters are independent, and most of them for correlated
    parameters whose c_p is not cut.
    """
    if source.move is not move_paper_joint:
        return SAMPLED
    if are_independent(source.population):
        return EXACT
    return CORRELATED if source.knobs.c_p_truncation_sd is None else SAMPLED
