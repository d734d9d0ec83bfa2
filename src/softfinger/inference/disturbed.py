"""Recordings whose noise is larger along some directions.

They are those in which an error of log, clock or picture moves the angles (`disturbances`).
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.inference.disturbance_sizes import fit_disturbances
from softfinger.inference.disturbances import find_kind, list_disturbances
from softfinger.inference.mixed_effects_laplace import Fit
from softfinger.inference.problem import Candidate, Problem
from softfinger.inference.reduce import whiten_residual, whiten_slope
from softfinger.inference.spreads import is_spread, list_spreads
from softfinger.measurement.measure import add_components
from softfinger.mechanics.effects.measurement_file import LINK_TURN

Array = NDArray[np.float64]

SLIGHT = 1e-6  # of the noise's variance, that a direction adds


def admit_disturbances(
    problem: Problem, size: Mapping[str, float], directions: Mapping[str, Array]
) -> Problem:
    """Enlarge the noise along some directions by their sizes."""
    trials = problem.trials
    scaled = np.concatenate([size[name] * directions[name] for name in size], axis=3)
    parts, gained = [], []
    for i in range(len(trials.name)):
        vectors, sd, _ = np.linalg.svd(whiten_slope(trials, scaled, i), full_matrices=False)
        gained.append(np.log1p(sd**2).sum())
        kept = sd**2 > SLIGHT
        shrink = 1.0 - 1.0 / np.sqrt(1.0 + sd[kept] ** 2)
        parts.append(vectors[:, kept] * np.sqrt(shrink))
    soft = np.zeros((len(parts), trials.size.max(), max(part.shape[1] for part in parts)))
    for whole, part in zip(soft, parts, strict=True):
        whole[: len(part), : part.shape[1]] = part
    softer = trials._replace(soft=soft, logdet=trials.logdet + np.array(gained))
    return replace(problem, trials=softer, directions=scaled, disturbed=dict(size))


def forget_spreads(plain: Problem, softer: Problem, candidate: Candidate) -> Problem:
    """Keep the disturbances of a problem without its effects' spreads.

    A model that lacks an effect has no use for how the effect's parameters differ between trials:
    as noise they would take what the effect explains.

    Parameters
    ----------
    plain, softer
        Without disturbances, and with those of the candidate.
    """
    size = {name: sd for name, sd in softer.disturbed.items() if find_kind(name)}
    if len(size) == len(softer.disturbed):
        return softer
    trials = plain.trials._replace(trust=softer.trials.trust, tails=softer.trials.tails)
    stiff = replace(plain, trials=trials)
    if not size:
        return stiff
    spreads = [name for name in softer.disturbed if name not in size]
    again = admit_disturbances(stiff, size, list_disturbances(stiff, candidate, set(size)))
    return replace(again, noise=softer.noise.drop_sel(component=spreads))


def admit_found(
    problem: Problem, fit: Fit, few: tuple[Problem, Fit], spreads: Mapping[str, float]
) -> tuple[Problem, Fit]:
    """Admit what the residual of the base model shows.

    Parameters
    ----------
    few
        Problem and fit of some of the trials, in which it is sought.
    spreads
        Those of the effects' parameters, which are known.

    Returns
    -------
    problem, fit
        As they are where the residual shows nothing, or nothing can be fitted with it.
    """
    some, fitted = few
    size, evidence, _ = fit_disturbances(some, Candidate(some.base, fitted, fitted.log_evidence))
    size = {name: sd for name, sd in size.items() if find_kind(name)}
    found = _fit_softer(problem, fit, size | dict(spreads)) if size or spreads else None
    if found is None:
        return problem, fit
    softer, again = found
    nats = {name: evidence[name] for name in size}
    return replace(softer, noise=add_components(problem.noise, size, nats)), again


def admit_known(problem: Problem, fit: Fit, size: Mapping[str, float]) -> tuple[Problem, Fit]:
    """Admit known disturbances and spreads; fit the base again."""
    if not size:
        return problem, fit
    _refuse_links(size, problem.trials.joints)
    found = _fit_softer(problem, fit, size)
    if found is None:
        raise Fault(
            f"the model cannot be fitted with the disturbances {', '.join(size)} of the model "
            "file (its `measurement` and `spreads`); remove them there"
        )
    return found


def _refuse_links(size: Mapping[str, float], joints: int) -> None:
    links = [f"{LINK_TURN}{link}" for link in range(1, joints + 1) if joints > 1]
    strange = [name for name in size if name.startswith(LINK_TURN) and name not in links]
    if strange:
        raise Fault(
            f"measurement.disturbances.{strange[0]} of the model file: these recordings have "
            f"{joints} {'joint' if joints == 1 else 'joints'} and no such drift; remove it there"
        )


def _fit_softer(
    problem: Problem, fit: Fit, size: Mapping[str, float]
) -> tuple[Problem, Fit] | None:
    """Fit the base again with disturbances; None if that fails."""
    candidate = Candidate(problem.base, fit, fit.log_evidence)
    directions = list_disturbances(problem, candidate, set(size))
    if any(map(is_spread, size)):
        slope = problem.simulate(candidate.model, fit.own, fit.shared)[1]
        directions |= list_spreads(candidate, slope)
    size = {name: sd for name, sd in size.items() if name in directions}
    if not size:
        return problem, fit
    softer = admit_disturbances(problem, size, directions)
    again = softer.fit(problem.base, (fit.own, fit.shared, fit.omega))
    return None if again is None else (softer, again._replace(first=again.log_evidence))


def spread_disturbances(problem: Problem, like: NDArray[np.int64], time: Array) -> Array:
    """Interpolate trials' directions to times.

    The times are (trial, moment) [s] of trials `like`, their places; the result is
    (trial, joint, moment, k) [rad], each column times a standard normal number.
    """
    trials, directions = problem.trials, problem.directions
    if directions is None:
        return np.zeros((len(like), trials.joints, time.shape[1], 0))
    found = np.zeros((len(like), trials.joints, time.shape[1], directions.shape[3]))
    for row, trial in enumerate(like):
        node = trials.node[trial].ravel()
        for joint, column in np.ndindex(trials.joints, directions.shape[3]):
            moved = np.interp(time[row], node, directions[trial, joint, :, column])
            found[row, joint, :, column] = moved
    return found


def locate_disturbances(problem: Problem, candidate: Candidate, time: Array) -> Array:
    """Most probable disturbance (trial, joint, frame) [rad] at times.

    The times are (trial, frame) [s].

    The modes of η and φ are given; between the bins' nodes it follows straight lines.
    """
    trials, fit, moved = problem.trials, candidate.fit, problem.directions
    found = np.zeros((len(trials.name), trials.joints, time.shape[1]))
    if moved is None:
        return found
    angle = problem.simulate(candidate.model, fit.own, fit.shared, np.zeros(0, np.int64))[0]
    stiff = trials._replace(soft=trials.soft[:, :, :0])
    for i in range(len(trials.name)):
        white, left = whiten_slope(trials, moved, i), whiten_residual(stiff, angle, i)
        left = left[:, trials.present[i]].ravel()
        inner = np.eye(white.shape[1]) + white.T @ white
        shift = moved[i] @ np.linalg.solve(inner, white.T @ left)
        for j in range(trials.joints):
            found[i, j] = np.interp(time[i], trials.node[i].ravel(), shift[j])
    return found
