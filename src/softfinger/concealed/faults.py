"""The oracle's evidence of each nuisance."""

from dataclasses import replace

import numpy as np
from scipy.optimize import minimize_scalar

from softfinger.concealed.effects import Dose
from softfinger.concealed.noise import Noise
from softfinger.concealed.nuisances import NUISANCES
from softfinger.concealed.oracle import Array, Fit, Recording, compute_angles, fit_model
from softfinger.concealed.setting import Setting
from softfinger.concealed.spoil import Sight, recall

LONGEST_MEMORY = 0.995  # correlation over a frame that noise is given in place of a fault


def weigh_faults(
    setting: Setting, sights: list[Sight], doses: dict[str, Dose], seed: int
) -> dict[str, float]:
    """Evidence [nats] for each nuisance over its absence.

    The true physics and the other nuisances are known.

    In its place the oracle fits noise with the sd and the autocorrelation that fit best. A nuisance
    that leaves no mark in the likelihood (rounded angles, the population's law) is not weighed.
    """
    if not setting.faults:
        return {}
    known = recall(setting, sights, seed)
    fit = fit_model(known, setting.rig, setting.noise, doses, setting.individuals)
    whole = add_up(known, fit)
    weighed = {}
    for name in setting.faults:
        if not (NUISANCES[name].mark or NUISANCES[name].clock_known):
            continue
        without = recall(setting, sights, seed, set(setting.faults) - {name})
        weighed[name] = whole - _fit_ignorant(without, setting, doses)
    return weighed


def add_up(recordings: list[Recording], fit: Fit) -> float:
    """Log evidence, comparable under different noise."""
    pairs = zip(recordings, fit.residuals, strict=True)
    return fit.log_evidence + sum(r.blur.add_nats(residual) for r, residual in pairs)


def _fit_ignorant(recordings: list[Recording], setting: Setting, doses: dict[str, Dose]) -> float:
    """Best evidence by noise alone, without a nuisance."""
    individuals, turned, best = setting.individuals, doses, -np.inf
    for _ in range(2):
        rest = [
            r.angle - compute_angles(individual, turned, r, setting.rig)
            for r, individual in zip(recordings, individuals, strict=True)
        ]
        noise = fit_noise(recordings, rest, setting.noise)
        told = [_tell(recording, noise) for recording in recordings]
        fit = fit_model(told, setting.rig, noise, doses, individuals)
        individuals, turned = fit.solution.own.reshape(individuals.shape), fit.doses
        best = max(best, add_up(told, fit))
    return best


def _tell(recording: Recording, noise: Noise) -> Recording:
    return Recording(recording.time, recording.angle, recording.trial, recording.blur.change(noise))


def fit_noise(recordings: list[Recording], rest: list[Array], like: Noise) -> Noise:
    """Most probable sd and autocorrelation of residuals."""
    values = sum(residual.size for residual in rest)

    def scale(memory: float) -> tuple[float, float]:
        noise = replace(like, memory=memory)
        square = nats = 0.0
        for recording, residual in zip(recordings, rest, strict=True):
            blur = recording.blur.change(noise)
            white = blur.whiten(residual)
            square += float((white**2).sum())
            nats += blur.add_nats(white)
        sd = np.sqrt(square / values)
        return 0.5 * values * (2.0 * np.log(sd) + 1.0) - nats, sd

    found = minimize_scalar(
        lambda memory: scale(memory)[0],
        bounds=(0.0, LONGEST_MEMORY),
        method="bounded",
        options={"xatol": 1e-3},
    )
    memory = float(found.x)
    return replace(like, sd=like.sd * scale(memory)[1], memory=memory)
