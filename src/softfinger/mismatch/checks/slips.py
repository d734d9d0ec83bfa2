"""Slips in single trials.

From some moment on, angles are off by a constant.

Each joint's residual, frame by frame, is weighed against a step of normal size at any moment at
which the finger is quiet. The trial's own parameters are free to adapt, and the evidence is
averaged over joints, moments and sizes. A slip has to beat two rivals (Fox 1972), weighed in the
same way, which noise with heavy tails brings: one wrong frame, and one large innovation, which
AR(1) noise forgets only slowly. The evidence is averaged over the unknown probability of a slip
as well. Each joint is weighed by itself: what its noise shares with its neighbours' is not used.

References
----------
Fox (1972), J. R. Stat. Soc. B 34, 350. Chen, Liu (1993), J. Am. Stat. Assoc. 88, 284.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.disturbed import locate_disturbances
from softfinger.inference.problem import LAYOUT, Candidate, Problem, simulate_frames
from softfinger.measurement.memory import list_memories, whiten_array
from softfinger.measurement.quiet import find_quiet_array
from softfinger.measurement.repeats import compute_step
from softfinger.mechanics import OWN
from softfinger.mismatch.checks.onsets import Onset, project_onsets
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.priors import PRIORS

Array = NDArray[np.float64]


class Slips(NamedTuple):
    """Slips' evidence [nats], trials, joints (from 1)."""

    gain: float
    trials: list[str]
    joints: list[int]


class Series(NamedTuple):
    """One joint in one trial.

    rows (n, OWN + 1) of [∂F/∂η | residual], whitened; pull (OWN,) = Ω⁻¹(μ − η) and precision Ω⁻¹ of
    η; quiet (n,); step to which angles are rounded, over the noise.
    """

    rows: Array
    pull: Array
    precision: Array
    quiet: NDArray[np.bool_]
    step: float = 0.0


def find_slips(problem: Problem, candidate: Candidate, angles: xr.Dataset) -> Slips:
    """Weigh slips in single trials of `angles`."""
    trials = problem.trials
    evidence = np.full((len(trials.name), trials.joints), -np.inf)
    rival = evidence.copy()
    for i, j, series, onsets in _list_series(problem, candidate, angles):
        sizes = np.array(PRIORS.slip_sizes_rad) / float(problem.noise["noise_sd"][j])
        evidence[i, j], *rivals = (weigh_shapes(series, *onset, sizes) for onset in onsets)
        rival[i, j] = np.logaddexp(*rivals) - np.log(2.0)
    seen = np.isfinite(evidence).any(axis=1)
    if not seen.any():
        return Slips(0.0, [], [])
    trial, other = (_average(x[seen]) for x in (evidence, rival))
    trial = trial - np.maximum(other, 0.0)
    mixed = [np.logaddexp(np.log1p(-p), np.log(p) + trial).sum() for p in PRIORS.slip_shares]
    slipping = np.flatnonzero(seen)[trial > DECISIONS.slip_nats]
    joints = sorted({int(evidence[i].argmax()) + 1 for i in slipping})
    gain = float(np.logaddexp.reduce(mixed) - np.log(len(mixed)))
    return Slips(gain, [trials.name[i] for i in slipping], joints)


def weigh_shapes(series: Series, product: Array, square: Array, sizes: Array) -> float:
    """Evidence [nats] of a shape, over moments, sizes.

    Rounded angles leap by a step where the truth creeps: a shape has what it has more.
    """
    own, left = series.rows[:, :-1], series.rows[:, -1]
    cross, pull = product[series.quiet, :-1], product[series.quiet, -1]
    inner = np.linalg.inv(series.precision + own.T @ own)
    adapted = inner @ (own.T @ left + series.pull)  # where η would go without the shape
    norm = np.maximum(square[series.quiet] - np.einsum("sa,ab,sb->s", cross, inner, cross), 0.0)
    pull = np.maximum(np.abs(pull - cross @ adapted) - series.step * norm, 0.0)
    each = [0.5 * (pull**2 / (norm + s**-2.0) - np.log1p(norm * s**2)) for s in sizes]
    return float(np.logaddexp.reduce(np.ravel(each)) - np.log(np.size(each)))


def _average(evidence: Array) -> Array:
    """Average over the joints (trial, joint) that were seen."""
    return np.logaddexp.reduce(evidence, axis=1) - np.log(np.isfinite(evidence).sum(axis=1))


def _list_series(
    problem: Problem, candidate: Candidate, angles: xr.Dataset
) -> Iterator[tuple[int, int, Series, tuple[Onset, ...]]]:
    """Series with enough seen: place, values, what may begin in them."""
    trials, fit = problem.trials, candidate.fit
    sds, memories = problem.noise["noise_sd"].values, list_memories(problem.noise)
    factor = problem.noise["noise_factor"].sel(trial=trials.name).transpose(*LAYOUT).values
    chosen = angles.sel(trial=trials.name)
    recorded = chosen["joint_angle"].transpose(*LAYOUT).values
    time = chosen["time"].transpose("trial", "frame").values
    recorded = recorded - locate_disturbances(problem, candidate, time)
    angle, slope = simulate_frames(problem, candidate, angles, gradient=True)
    for i, used in enumerate(trials.used):
        quiet = find_quiet_array(time[i, used], trials.load_time[i], trials.load_torque[i])
        edge = DECISIONS.slip_frames
        quiet[:edge] = quiet[max(len(quiet) - edge, 0) :] = False  # a few frames may be a burst
        gap = np.diff(time[i, used], prepend=-np.inf) / trials.interval
        if quiet.sum() < DECISIONS.slip_frames:
            continue
        for j in np.flatnonzero(trials.present[i]):
            sd = sds[j]
            own = slice(OWN * j, OWN * (j + 1))
            residual = recorded[i, j, used] - angle[i, j, used]
            rows = np.column_stack([slope[i, j, used, own], residual]) / sd
            rows, _ = whiten_array(rows / factor[i, j, used, None], gap, memories[j])
            precision = np.linalg.inv(fit.omega[own, own])
            series = Series(
                rows,
                precision @ (fit.mean[own] - fit.own[i, own]),
                precision,
                quiet,
                compute_step(float(problem.noise["rounding_sd"][j])) / sd,
            )
            onsets = project_onsets(rows, 1.0 / factor[i, j, used], gap, memories[j])
            yield i, int(j), series, onsets
