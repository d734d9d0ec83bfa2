"""How much evidence an effect has that was added to real recordings.

An oracle would take the addition off again, and have the recordings as they were. So the effect's
evidence is what the model that a diagnosis found for the plain recordings loses when it is fitted
to those with the effect, log Z(plain) − log Z(added), with the measurement of the plain recordings.
No model fits real recordings: what it leaves may lie with the addition or against it. So the mean
counts of what the change costs when it is added and when it is taken off.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from softfinger.artifacts import open_artifact
from softfinger.artifacts.specs.angles import SPEC as ANGLES
from softfinger.concealed.added import Addition, Body, write_added
from softfinger.concealed.added.apply import strengthen
from softfinger.concealed.added.body import Scale
from softfinger.concealed.kernel import RunawayError
from softfinger.config import read_config
from softfinger.faults import CampaignFault, Fault
from softfinger.inference.disturbed import admit_known
from softfinger.inference.mixed_effects_laplace import Fit
from softfinger.inference.problem import Problem, pose_problem
from softfinger.measurement.mend import mend_recordings
from softfinger.measurement.trials import prepare_trials
from softfinger.mechanics.effects.measurement_file import MeasurementEntry
from softfinger.mechanics.effects.model_file import read_model_file
from softfinger.stages.prepare import prepare_angles

LEAST_NATS, MOST_NATS = 25.0, 2500.0
TRIES = 5
STEPS = 200  # a model with many disturbances comes to rest slowly
CLOSE = 2.0  # factor about the aim


class Plain(NamedTuple):
    """Recordings as they are, with the model and the measurement that their diagnosis found.

    Attributes
    ----------
    problem
        Without the disturbances of the measurement.
    fit
        With them.
    evidence
        [nats] With them.
    sizes
        Of disturbances, and of effects' spreads between trials.
    """

    angles: xr.Dataset
    problem: Problem
    fit: Fit
    evidence: float
    measurement: MeasurementEntry
    sizes: dict[str, float]


def read_plain(folder: Path) -> Plain:
    """Read what a diagnosis left in its folder."""
    content = read_model_file(folder / "model.yaml")
    angles = open_artifact(folder / "angles.nc", ANGLES)
    problem, fit = pose_problem(angles, content, priors=False)
    found, known = fit, content.measurement or MeasurementEntry()
    sizes = {**known.disturbances, **content.spreads}
    for _ in range(2):  # the second time with directions in which they move the model that is found
        softer, found = _fit_softer(problem, found, sizes)
    return Plain(angles, problem, found, _measure(softer, found), known, sizes)


def measure_lead(known: Path, found: Path) -> float:
    """What the addition's removal explains beyond an answer [nats].

    Of the same frames, with the noise of the plain recordings.

    Parameters
    ----------
    known, found
        Folders of the diagnoses without and with the addition: evidence is that of their models.
    """
    plain, other = read_plain(known), read_plain(found)
    again = pose_again(replace(other.problem, noise=plain.problem.noise), other.angles)
    if again is None:
        return plain.evidence - other.evidence
    return plain.evidence - _measure(*_fit_softer(again, other.fit, other.sizes))


def choose_strength(
    folder: Path, bodies: list[Body], scale: Scale, addition: Addition, known: Path, place: Path
) -> tuple[Addition, float]:
    """Give an effect a size at which its evidence is near a drawn aim.

    Parameters
    ----------
    known
        Folder with the diagnosis of the plain recordings.
    place
        Folder for campaigns on the way.

    Returns
    -------
    addition, nats
    """
    plain = read_plain(known)
    share = np.random.default_rng([addition.seed, 2]).uniform()
    aim = LEAST_NATS * (MOST_NATS / LEAST_NATS) ** share
    chosen, best, nats = addition, addition, -np.inf
    for number in range(TRIES):
        found = weigh(folder, bodies, scale, chosen, plain, place / f"try_{number}")
        if number == 0 or _miss(found, aim) < _miss(nats, aim):
            best, nats = chosen, found
        if aim / CLOSE < found < aim * CLOSE:
            break
        # evidence grows about as the square of the strength
        factor = np.clip(np.sqrt(aim / max(found, 1.0)), 0.1, 4.0)
        if not np.isfinite(found):  # so strong that nothing can be fitted
            factor = 0.3
        stronger = strengthen(chosen, chosen.dose.strength * float(factor), scale)
        if stronger.dose.strength == chosen.dose.strength:
            break
        chosen = stronger
    return best, nats


def _miss(nats: float, aim: float) -> float:
    return abs(float(np.log(max(nats, 1e-9) / aim)))


def weigh(
    folder: Path,
    bodies: list[Body],
    scale: Scale,
    addition: Addition,
    plain: Plain,
    place: Path,
) -> float:
    """Evidence [nats] of an addition; −∞ where a campaign with it cannot be fitted."""
    lost = []
    for times in (1.0, -1.0):
        out = place.with_name(f"{place.name}_{times:+.0f}")
        out.mkdir()
        try:
            write_added(folder, out / "campaign", bodies, scale, addition, times)
            prepared = prepare_angles(out / "campaign", out, read_config())
        except (CampaignFault, RunawayError):  # it moves farther than any finger
            return -np.inf
        right = mend_recordings(open_artifact(prepared, ANGLES), plain.measurement)
        lost.append(_weigh_change(plain, right))
    return sum(lost) / len(lost)


def _weigh_change(plain: Plain, angles: xr.Dataset) -> float:
    """What a model's evidence loses with other angles [nats]; −∞ where it cannot be fitted."""
    again = pose_again(plain.problem, angles)
    if again is None:
        return -np.inf
    try:
        return plain.evidence - _measure(*_fit_softer(again, plain.fit, plain.sizes))
    except (Fault, np.linalg.LinAlgError):  # far from any fit that has numbers
        return -np.inf


def _fit_softer(problem: Problem, fit: Fit, sizes: dict[str, float]) -> tuple[Problem, Fit]:
    """Fit a model with the disturbances that move it where it was fitted before."""
    softer, fit = admit_known(problem, fit, sizes)
    again = softer.fit(softer.base, (fit.own, fit.shared, fit.omega), steps=STEPS)
    if again is None:
        raise Fault("the model cannot be fitted; the recordings move too far")
    return softer, again


def pose_again(problem: Problem, angles: xr.Dataset) -> Problem | None:
    """The problem of the same frames and noise with other angles; None where frames differ."""
    names = problem.trials.name
    if not set(names) <= set(angles["trial"].values.tolist()):
        return None
    chosen = angles.sel(trial=names)
    if chosen.sizes["frame"] != problem.noise.sizes["frame"]:
        return None
    trials = prepare_trials(chosen, problem.noise)
    return replace(problem, trials=trials) if trials.name == names else None


def _measure(problem: Problem, fit: Fit) -> float:
    trials = problem.trials
    return fit.log_evidence + float(trials.tails.sum() - 0.5 * trials.logdet.sum())
