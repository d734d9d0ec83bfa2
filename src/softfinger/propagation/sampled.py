"""Answers from samples, whatever the forward model.

Whole fingers are drawn, as many for each of some draws of the posterior. Effects are no parameters
of a trial: they differ between draws only. Fingers that the model could not move do not count.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.mechanics import OWN
from softfinger.progress import track_progress
from softfinger.propagation.kernel_density import estimate_density_array
from softfinger.propagation.new_trials import (
    Source,
    draw_standard_array,
    move_fingers,
    place_scores_array,
    take_root_array,
)
from softfinger.propagation.populations import choose_evenly
from softfinger.propagation.protocols import Protocol
from softfinger.propagation.subsets import EVERY, SUBSETS, Shares, Subset

WHOLE = np.ones(OWN)


class DrawnFingers(NamedTuple):
    """A draw of the posterior, with its fingers.

    place of the draw; correlation (4 · joint, 4 · joint); normal (n, copy · 4 · joint).
    """

    place: int
    correlation: NDArray[np.float64]
    normal: NDArray[np.float64]


def compute_moments(
    source: Source, protocol: Protocol, time: NDArray[np.float64], left: NDArray = WHOLE
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Estimate mean and variance of the joint angles."""
    moments = [
        (np.nanmean(angle, axis=0), np.nanvar(angle, axis=0))
        for angle in _move_draws(source, protocol, time, left)
    ]
    mean, variance = zip(*moments, strict=True)
    return np.stack(mean), np.stack(variance)


def share_variance(source: Source, protocol: Protocol, time: NDArray[np.float64]) -> Shares:
    """Estimate what share of the variance each set explains.

    With two copies x, x′ of the parameters that share x_u, and x″ that shares nothing with x,
    v(u) = E[(q(x) − q̄)(q(x′) − q(x″))] = Var q − E[(q(x) − q(x′))²]/2: the first is better for
    little that is shared, the second for much; for two of four parameters the mean of both.

    Returns
    -------
    dict
        Every set → (draw, joint, n) in 0 … 1, and no less than for a part of the set.

    References
    ----------
    Saltelli et al. (2010), Computer Physics Communications 181, 259,
    doi:10.1016/j.cpc.2009.09.018.
    """
    blocks = track_progress(
        _draw_blocks(source, 2), "splitting the spread", total=_count_draws(source)
    )
    found = [_share_block(source, block, protocol, time) for block in blocks]
    return {subset: np.stack([shares[subset] for shares in found]) for subset in SUBSETS}


def find_quantiles(
    source: Source, protocol: Protocol, time: NDArray[np.float64], probability: NDArray
) -> NDArray[np.float64]:
    """Estimate new trials' quantiles (joint, n, p) [rad]."""
    angle = np.stack(list(_move_draws(source, protocol, time)))
    return np.moveaxis(np.nanquantile(angle, probability, axis=(0, 1)), 0, -1)


def compute_densities(
    source: Source, protocol: Protocol, time: NDArray[np.float64], angle: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Estimate kernel densities, as the exact route computes densities.

    That of a new trial is smoothed as the fingers of all draws together allow, those of the draws
    as their own do.
    """
    moved = np.stack(list(_move_draws(source, protocol, time)))
    shape = (len(moved), *angle.shape)
    each, pooled = np.empty(shape), np.empty(angle.shape)
    for joint, row in np.ndindex(*angle.shape[:2]):
        sample, places = moved[:, :, joint, row], angle[joint, row]
        pooled[joint, row] = estimate_density_array(sample.ravel(), places)
        for draw, own in enumerate(sample):
            each[draw, joint, row] = estimate_density_array(own, places)
    return pooled, each


def _count_draws(source: Source) -> int:
    return min(source.population.sizes["draw"], source.knobs.sampled_draws)


def _draw_blocks(source: Source, copies: int) -> Iterator[DrawnFingers]:
    """Yield draws and numbers for `copies` of fingers."""
    places = choose_evenly(source.population.sizes["draw"], source.knobs.sampled_draws)
    dims = copies * source.joints * OWN
    rng = np.random.default_rng(source.seed)
    normal = draw_standard_array(source.knobs.draw_samples, dims, rng, len(places))
    correlation = source.population["correlation"].to_numpy()[places]
    return (DrawnFingers(*block) for block in zip(places, correlation, normal, strict=True))


def _move_draws(
    source: Source, protocol: Protocol, time: NDArray, left: NDArray = WHOLE
) -> Iterator[NDArray[np.float64]]:
    """Yield draws' angles (finger, joint, time) [rad]."""
    for block in _draw_blocks(source, 1):
        score = block.normal @ take_root_array(block.correlation)
        yield _move_scores(source, block.place, score, protocol, time, left)


def _move_scores(
    source: Source,
    place: int,
    score: NDArray,
    protocol: Protocol,
    time: NDArray,
    left: NDArray = WHOLE,
) -> NDArray[np.float64]:
    """Scores' angles (finger, joint, time) in one draw."""
    mu, sigma = (source.population[name].to_numpy()[place] for name in ("mu", "sigma"))
    own = place_scores_array(mu, sigma * left, score, source.knobs.c_p_truncation_sd)
    return move_fingers(source, np.full(len(own), place), own, protocol, time)


def _share_block(
    source: Source, block: DrawnFingers, protocol: Protocol, time: NDArray
) -> dict[Subset, NDArray[np.float64]]:
    """Shares (joint, time) of one draw."""
    one, two = np.split(block.normal, 2, axis=1)
    first = one @ take_root_array(block.correlation)
    sets = [(), *SUBSETS[:-1]]  # all of them known is all of the variance
    scores = [first, *(_copy_scores(block.correlation, subset, first, two) for subset in sets)]
    moved = _move_scores(source, block.place, np.concatenate(scores), protocol, time)
    angle, other, *copies = moved.reshape(len(scores), len(first), *moved.shape[1:])
    both = np.concatenate([angle, other])
    centre, variance = np.nanmean(both, axis=0), np.nanvar(both, axis=0)
    variance[variance == 0.0] = np.nan  # what does not vary has no shares
    shares = {}
    for subset, copy in zip(SUBSETS, copies, strict=False):
        little = np.nanmean((angle - centre) * (copy - other), axis=0)
        much = variance - np.nanmean((angle - copy) ** 2, axis=0) / 2
        value = {1: little, 2: (little + much) / 2, 3: much}[len(subset)]
        parts = [shares[p] for p in shares if set(p) < set(subset)]
        shares[subset] = np.max([np.clip(value / variance, 0.0, 1.0), *parts], axis=0)
    return {**shares, EVERY: variance / variance}


def _copy_scores(
    correlation: NDArray, subset: Subset, score: NDArray, normal: NDArray
) -> NDArray[np.float64]:
    """Scores (n, 4 · joint) that share u."""
    u = np.flatnonzero(np.isin(np.arange(len(correlation)) % OWN, subset))
    gain = np.linalg.solve(correlation[np.ix_(u, u)], correlation[u])
    rest = correlation - correlation[:, u] @ gain
    return score[:, u] @ gain + normal @ take_root_array(rest)
