"""What survivors predict of trials not yet recorded.

Each trial is reduced to the span of the survivors' motions and slopes. There its noise is white
and of sd 1; outside of it all survivors predict the same.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.budget import BUDGET as INFERENCE
from softfinger.inference.problem import Problem
from softfinger.inference.reduce import reduce_trials
from softfinger.inference.simulate import build_recording
from softfinger.measurement.planned import assume_noise
from softfinger.measurement.trials import Trials, prepare_trials
from softfinger.mechanics import OWN
from softfinger.mechanics.forward.simulate import simulate_joint_angle_array
from softfinger.mechanics.forward.slots import SlotArrays
from softfinger.mismatch.experiment.protocols import PlannedProtocol
from softfinger.mismatch.experiment.survivors import Survivor


class Foreseen(NamedTuple):
    """What one survivor predicts of n trials.

    c numbers a trial, of unit noise.

    Attributes
    ----------
    centre
        (trial, c) at the population's mean: F + J (μ − η) of trials like those recorded.
    own
        (trial, c, d) J = ∂F/∂η.
    moved
        (trial, c, d + p) [J | ∂F/∂φ].
    omega
        (d, d) Ω.
    covariance
        (d + p, d + p) of θ.
    """

    centre: NDArray[np.float64]
    own: NDArray[np.float64]
    moved: NDArray[np.float64]
    omega: NDArray[np.float64]
    covariance: NDArray[np.float64]


class PlannedTrials(NamedTuple):
    """Trials of a plan, without angles.

    Attributes
    ----------
    trials
        Frames, bins, noise and loads.
    like
        (trial,) recorded trial whose own parameters and circumstances each has.
    """

    trials: Trials
    like: NDArray[np.int64]


def plan_trials(
    problem: Problem, protocol: PlannedProtocol, count: int, interval: float
) -> PlannedTrials:
    """Lay out the trials of a protocol.

    Its histories take turns. The trials are like the last ones that were recorded.

    Parameters
    ----------
    interval
        Of the camera's frames [s]. The noise of a frame stays what it was.
    """
    history = np.arange(count) % len(protocol.load_time)
    recorded = len(problem.trials.name)
    like = (recorded - min(count, recorded) + np.arange(count) % min(count, recorded)).astype(int)
    time = np.arange(0.0, protocol.load_time.max() + 1e-9, interval)
    names = [f"planned_{i + 1}" for i in range(count)]
    knots = protocol.load_time[history], protocol.load_torque[history]
    angles = build_recording(time, *knots, problem.trials.joints, names)
    shape = (count, problem.trials.joints, len(time))
    angles = angles.assign(joint_angle=(angles["joint_angle"].dims, np.zeros(shape)))
    noise = assume_noise(angles, problem.noise)
    slower = interval / problem.trials.interval
    noise = noise.assign(noise_autocorrelation=noise["noise_autocorrelation"] ** slower)
    return PlannedTrials(prepare_trials(angles, noise), like)


def foresee(
    problem: Problem, survivors: Sequence[Survivor], planned: PlannedTrials
) -> list[Foreseen]:
    """Predict planned trials by every survivor."""
    parts = [_linearise(problem, survivor, planned) for survivor in survivors]
    first = parts[0][0]
    columns = [slope for _, slope in parts]
    columns += [(angle - first)[..., None] for angle, _ in parts[1:]]
    nothing = np.zeros_like(first)
    gram = reduce_trials(planned.trials, nothing, np.concatenate(columns, axis=3))[:, :-1, :-1]
    root = np.stack([_root(part) for part in gram])
    found, place = [], 0
    behind = sum(slope.shape[3] for _, slope in parts)
    for number, (survivor, (_, slope)) in enumerate(zip(survivors, parts, strict=True)):
        fit = survivor.candidate.fit
        d = fit.own.shape[1]
        moved = root[:, place : place + slope.shape[3]].transpose(0, 2, 1)
        place += slope.shape[3]
        motion = root[:, behind + number - 1] if number else np.zeros_like(root[:, 0])
        away = fit.mean - fit.own[planned.like]
        centre = motion + np.einsum("tcd,td->tc", moved[..., :d], away)
        found.append(Foreseen(centre, moved[..., :d], moved, fit.omega, survivor.covariance))
    return found


def _linearise(
    problem: Problem, survivor: Survivor, planned: PlannedTrials
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    model, fit = survivor.candidate.model, survivor.candidate.fit
    angle, slope = _simulate(
        problem,
        planned.trials,
        fit.own[planned.like],
        _take(model.fill_slots(fit.shared), planned.like),
        [_take(tangent, planned.like) for tangent in model.fill_tangents(fit.shared)],
    )
    if not (np.isfinite(angle).all() and np.isfinite(slope).all()):
        raise ArithmeticError(f"{survivor.label} has no motion under a planned protocol")
    return angle, slope


def linearise_motion(
    problem: Problem, survivor: Survivor, planned: PlannedTrials
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Angles (trial, joint, bin) [rad], and slopes (…, d + p) by θ."""
    angle, slope = _linearise(problem, survivor, planned)
    return (
        angle.reshape(*angle.shape[:2], -1, 2).mean(axis=-1),
        slope.reshape(*slope.shape[:2], -1, 2, slope.shape[3]).mean(axis=3),
    )


def _simulate(
    problem: Problem,
    trials: Trials,
    own: NDArray,
    slots: SlotArrays,
    tangents: list[SlotArrays] | None,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return simulate_joint_angle_array(
        own.reshape(len(own), trials.joints, OWN),
        slots,
        tangents or [],
        problem.finger,
        trials.node.reshape(len(own), -1),
        trials.load_time,
        trials.load_torque,
        by_own=tangents is not None,
        tolerance=INFERENCE.angle_error,
    )


def measure_largest_angle(
    problem: Problem,
    survivors: Sequence[Survivor],
    protocol: PlannedProtocol,
    rng: np.random.Generator | None = None,
) -> float:
    """Largest angle [rad] that any survivor predicts.

    Of trials like those recorded, under every history; with `rng` of trials drawn anew from the
    population and the posterior.
    """
    recorded = len(problem.trials.name)
    histories = len(protocol.load_time)
    like = np.repeat(np.arange(recorded), histories)
    time = np.unique(np.concatenate([protocol.load_time.ravel(), _list_moments(protocol)]))
    largest = 0.0
    for survivor in survivors:
        model, fit = survivor.candidate.model, survivor.candidate.fit
        own, shared = fit.own, fit.shared
        if rng is not None:
            drawn = rng.multivariate_normal(
                np.r_[fit.mean, fit.shared], survivor.covariance, method="eigh"
            )
            spread = rng.multivariate_normal(
                np.zeros(len(fit.mean)), fit.omega, recorded, method="eigh"
            )
            own = drawn[: len(fit.mean)] + spread
            shared = np.clip(drawn[len(fit.mean) :], model.low, model.high)
        angle, _ = simulate_joint_angle_array(
            own[like].reshape(len(like), problem.trials.joints, OWN),
            _take(model.fill_slots(shared), like),
            [],
            problem.finger,
            time,
            np.tile(protocol.load_time, (recorded, 1)),
            np.tile(protocol.load_torque, (recorded, 1)),
            by_own=False,
            tolerance=INFERENCE.angle_error,
        )
        known = angle[np.isfinite(angle)]  # a trial drawn far off may have no motion
        largest = max(largest, float(np.abs(known).max(initial=0.0)))
    return largest


def _list_moments(protocol: PlannedProtocol) -> NDArray[np.float64]:
    knots = np.unique(protocol.load_time)
    return (knots[:-1] + knots[1:]) / 2


def _take(slots: SlotArrays, rows: NDArray[np.int64]) -> SlotArrays:
    return SlotArrays(*(np.ascontiguousarray(array[rows]) for array in slots))


def _root(gram: NDArray[np.float64]) -> NDArray[np.float64]:
    """Coordinates (column, c) of columns with this Gram matrix."""
    size = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    values, vectors = np.linalg.eigh(gram / np.outer(size, size))
    return size[:, None] * (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
