"""How much evidence an effect has that was added to real recordings.

An oracle would take the addition off again, and have the recordings as they were. So the effect's
evidence is what the model that a diagnosis found for the plain recordings loses when it is fitted
to those with the effect: log Z(plain) − log Z(added), with the noise of the plain recordings.
"""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from softfinger.artifacts import open_artifact
from softfinger.artifacts.specs.angles import SPEC as ANGLES
from softfinger.concealed.added import Addition, Body, write_added
from softfinger.concealed.added.apply import strengthen
from softfinger.concealed.added.body import Scale
from softfinger.concealed.kernel import RunawayError
from softfinger.config import read_config
from softfinger.faults import CampaignFault
from softfinger.inference.mixed_effects_laplace import Fit
from softfinger.inference.problem import Problem, pose_problem
from softfinger.measurement.trials import prepare_trials
from softfinger.mechanics.effects.model_file import read_model_file
from softfinger.stages.prepare import prepare_angles

LEAST_NATS, MOST_NATS = 25.0, 2500.0
TRIES = 5
CLOSE = 2.0  # factor about the aim


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
    problem, fit = read_plain(known)
    share = np.random.default_rng([addition.seed, 2]).uniform()
    aim = LEAST_NATS * (MOST_NATS / LEAST_NATS) ** share
    chosen, best, nats = addition, addition, -np.inf
    for number in range(TRIES):
        found = weigh(folder, bodies, scale, chosen, (problem, fit), place / f"try_{number}")
        if number == 0 or _miss(found, aim) < _miss(nats, aim):
            best, nats = chosen, found
        if aim / CLOSE < found < aim * CLOSE:
            break
        # evidence grows about as the square of the strength
        factor = np.clip(np.sqrt(aim / max(found, 1.0)), 0.1, 4.0)
        if not np.isfinite(found):  # so strong that nothing can be fitted
            factor = 0.3
        stronger = strengthen(chosen, chosen.dose.strength * float(factor))
        if stronger.dose.strength == chosen.dose.strength:
            break
        chosen = stronger
    return best, nats


def read_plain(known: Path) -> tuple[Problem, Fit]:
    """The plain recordings with the model that their diagnosis found."""
    plain = open_artifact(known / "angles.nc", ANGLES)
    return pose_problem(plain, read_model_file(known / "model.yaml"), priors=False)


def _miss(nats: float, aim: float) -> float:
    return abs(float(np.log(max(nats, 1e-9) / aim)))


def weigh(
    folder: Path,
    bodies: list[Body],
    scale: Scale,
    addition: Addition,
    known: tuple[Problem, Fit],
    place: Path,
) -> float:
    """Evidence [nats] of an addition; −∞ where the campaign with it cannot be fitted."""
    problem, fit = known
    out = place.with_suffix(".out")
    out.mkdir()
    try:
        write_added(folder, place, bodies, scale, addition)
        prepared = prepare_angles(place, out, read_config())
    except (CampaignFault, RunawayError):  # it moves farther than any finger
        return -np.inf
    finally:
        shutil.rmtree(place)
    angles = open_artifact(prepared, ANGLES)
    again = pose_again(problem, angles)
    if again is None:
        return -np.inf
    other = again.fit(problem.base, (fit.own, fit.shared, fit.omega), steps=60)
    return -np.inf if other is None else _measure(problem, fit) - _measure(again, other)


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
    return fit.log_evidence - 0.5 * float(problem.trials.logdet.sum())
