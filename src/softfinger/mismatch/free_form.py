"""A free-form term for what no effect explains: splines in the argument that they fit best.

Within trials the term adds to a joint's angle a cubic B-spline of time, of the time since the last
change of load, of the load or of the angle itself, the same in every trial. Between trials it adds
to a joint's parameters a spline of the trial number, of the load or of a covariate. Coefficients
are normal; their sd is the one of a grid that the evidence prefers.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from softfinger.mismatch.locate import PARAMETERS, list_trial_covariates, time_since_change
from softfinger.mismatch.problem import OWN, Problem
from softfinger.mismatch.rank import Candidate
from softfinger.mismatch.reduce import reduce_trials
from softfinger.mismatch.setting import load_at
from softfinger.population.mixed_effects import fit_linear
from softfinger.population.mixed_effects_laplace import centre_gram

KNOTS = 9
SIZES_RAD = (0.001, 0.004, 0.016, 0.064)
SIZES_LOG = (0.1, 0.3, 1.0)
GRID = 41


class FreeForm(NamedTuple):
    """The best free-form term: its gain [nats], argument, and shape with its uncertainty."""

    gain: float
    argument: str
    joints: list[int]
    shape: xr.Dataset


def evaluate_basis_array(values: NDArray[np.float64], count: int = KNOTS) -> NDArray[np.float64]:
    """Evaluate a clamped cubic B-spline basis (…, count) on [0, 1].

    >>> evaluate_basis_array(np.array([0.0, 0.3, 1.0])).sum(axis=-1).round(12)
    array([1., 1., 1.])
    """
    inner = np.linspace(0.0, 1.0, count - 2)
    knots = np.concatenate([[0.0] * 3, inner, [1.0] * 3])
    flat = BSpline.design_matrix(np.clip(values.ravel(), 0.0, 1.0), knots, 3).toarray()
    return flat.reshape(*values.shape, count)


def fit_free_form(problem: Problem, candidate: Candidate) -> FreeForm | None:
    """Fit a free-form term in every argument on top of a fitted model; the best, or None."""
    angle, slope = problem.simulate(candidate.model, candidate.fit.own, candidate.fit.shared)
    found = []
    for name, values in list_arguments(problem, angle).items():
        low, high = np.nanmin(values), np.nanmax(values)
        if not high > low:
            continue
        scaled = (values - low) / (high - low)
        found.append(_fit_within(problem, candidate, (angle, slope), name, scaled, (low, high)))
    for name, values in list_trial_covariates(problem).items():
        if len(np.unique(values[np.isfinite(values)])) >= 4:
            found.append(_fit_between(problem, candidate, name, values))
    return max(found, key=lambda term: term.gain, default=None)


def list_arguments(problem: Problem, angle: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """What a term within trials may depend on, at the nodes: (trial, joint, node)."""
    trials = problem.trials
    shape = (len(trials.name), trials.joints, trials.node.shape[1], 2)
    since, load = np.zeros(shape), np.zeros(shape)
    for i, bins in enumerate(trials.bins):
        since[i, :, :bins] = time_since_change(problem, i)[None, :, None]
        load[i, :, :bins] = load_at(trials, i)[None, :, None]
    time = np.broadcast_to(trials.node[:, None], shape)
    flat = (shape[0], shape[1], -1)
    return {
        "time_s": time.reshape(flat),
        "time_since_change_s": np.log1p(np.maximum(since, 0.0) / trials.interval).reshape(flat),
        "load": load.reshape(flat),
        "angle_rad": angle,
    }


def _fit_within(
    problem: Problem,
    candidate: Candidate,
    motion: tuple[NDArray, NDArray],
    name: str,
    scaled: NDArray,
    span: tuple[float, float],
) -> FreeForm:
    angle, slope = motion
    joints = problem.trials.joints
    basis = evaluate_basis_array(np.nan_to_num(scaled))
    columns = np.zeros((*angle.shape, joints * KNOTS))
    for j in range(joints):
        columns[:, j, :, j * KNOTS : (j + 1) * KNOTS] = basis[:, j]
    gram = reduce_trials(problem.trials, angle, np.concatenate([slope, columns], axis=3))
    gain, mean, covariance = _weigh(problem, candidate, gram, joints * KNOTS, SIZES_RAD)
    labels = [f"joint_angle_{j + 1}" for j in range(joints)]
    return _describe(gain, name, span, labels, mean, covariance, "rad")


def _fit_between(problem: Problem, candidate: Candidate, name: str, values: NDArray) -> FreeForm:
    known = np.isfinite(values)
    low, high = values[known].min(), values[known].max()
    scaled = np.where(known, (values - low) / (high - low), 0.5)
    basis = evaluate_basis_array(scaled, KNOTS) - evaluate_basis_array(scaled, KNOTS).mean(axis=0)
    basis *= known[:, None]
    d = candidate.fit.own.shape[1]
    old = candidate.fit.gram
    moving = [k for k in range(d) if k % OWN != OWN - 1]
    spread = np.zeros((len(values), old.shape[1], len(moving) * KNOTS))
    for place, k in enumerate(moving):
        spread[:, k, place * KNOTS : (place + 1) * KNOTS] = basis
    wide = np.concatenate(
        [
            np.broadcast_to(
                np.eye(old.shape[1])[:, :-1], (len(old), old.shape[1], old.shape[1] - 1)
            ),
            spread,
            np.broadcast_to(np.eye(old.shape[1])[:, -1:], (len(old), old.shape[1], 1)),
        ],
        axis=2,
    )
    gram = wide.transpose(0, 2, 1) @ old @ wide
    gain, mean, covariance = _weigh(problem, candidate, gram, len(moving) * KNOTS, SIZES_LOG)
    labels = [f"{PARAMETERS[k % OWN]}_{k // OWN + 1}" for k in moving]
    return _describe(gain, name, (low, high), labels, mean, covariance, "1")


def _weigh(
    problem: Problem, candidate: Candidate, gram: NDArray, count: int, sizes: tuple[float, ...]
) -> tuple[float, NDArray, NDArray]:
    """Gain averaged over the grid of sizes; mean and covariance of the coefficients at the best."""
    prior = problem.build_prior(candidate.model)
    absent = np.zeros(count)
    wide = prior._replace(
        mean=np.concatenate([prior.mean, absent]),
        precision=np.concatenate([prior.precision, absent]),
    )
    shared = np.concatenate([candidate.fit.shared, absent])
    moved, wide, _ = centre_gram(gram, wide, candidate.fit.own, shared)
    start = len(candidate.fit.omega) + len(candidate.fit.shared)
    without = np.delete(np.delete(moved, np.s_[start:-1], axis=1), np.s_[start:-1], axis=2)
    narrow = wide._replace(mean=wide.mean[:start], precision=wide.precision[:start])
    base = fit_linear(without, narrow, candidate.fit.omega).log_evidence
    gains, fits = [], []
    for size in sizes:
        precision = np.concatenate([wide.precision[:start], np.full(count, size**-2.0)])
        wider = wide._replace(precision=precision)
        fits.append(fit_linear(moved, wider, candidate.fit.omega, rounds=2, tolerance=0.1))
        gains.append(fits[-1].log_evidence - base)
    best = fits[int(np.argmax(gains))]
    gain = np.logaddexp.reduce(gains) - np.log(len(gains))
    return float(gain), best.shared[start:], best.shared_covariance[start:, start:]


def _describe(
    gain: float,
    name: str,
    span: tuple[float, float],
    labels: list[str],
    mean: NDArray,
    covariance: NDArray,
    unit: str,
) -> FreeForm:
    grid = np.linspace(0.0, 1.0, GRID)
    basis = evaluate_basis_array(grid)
    blocks = [slice(k * KNOTS, (k + 1) * KNOTS) for k in range(len(labels))]
    value = np.stack([basis @ mean[b] for b in blocks])
    sd = np.stack(
        [np.sqrt(np.einsum("gk,kl,gl->g", basis, covariance[b, b], basis)) for b in blocks]
    )
    place = span[0] + grid * (span[1] - span[0])
    if name == "time_since_change_s":
        place = np.expm1(place)
    strong = np.max(np.abs(value) / np.maximum(sd, 1e-300), axis=1) > 3.0
    joints = sorted(
        {int(label.rsplit("_", 1)[1]) for label, s in zip(labels, strong, strict=True) if s}
    )
    shape = xr.Dataset(
        {
            "value": (("quantity", "place"), value, {"units": unit}),
            "sd": (("quantity", "place"), sd, {"units": unit}),
        },
        coords={"quantity": labels, "place": place},
        attrs={"argument": name},
    )
    return FreeForm(gain, name, joints, shape)
