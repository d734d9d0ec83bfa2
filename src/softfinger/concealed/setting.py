"""All that is drawn before the finger moves."""

from dataclasses import dataclass, field, replace

import numpy as np

from softfinger.concealed.arrays import Array
from softfinger.concealed.effects import Circumstances, Dose
from softfinger.concealed.forward import simulate_trial
from softfinger.concealed.noise import Noise, draw_frame_times, draw_missing, draw_noise
from softfinger.concealed.nuisances import NUISANCES, Fault
from softfinger.concealed.oracle import TOLERANCE_RAD, Recording
from softfinger.concealed.population import Population, draw_individuals, draw_population
from softfinger.concealed.protocols import Load, draw_loads
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.rig import Rig, draw_rig
from softfinger.concealed.suite import CaseSpec

# What a filmed campaign's oracle takes for the tracker's error; the film itself has camera noise.
TRACKED_SD_RAD = 0.001


@dataclass(frozen=True)
class Setting:
    """A campaign's finger, trials, noise, effects' shapes."""

    rig: Rig
    population: Population
    individuals: Array  # (trial, parameter, joint)
    trials: list[Circumstances]
    times: list[Array]  # (frame,) of every trial
    noise: Noise
    doses: dict[str, Dose]  # of strength zero
    humidity: Array  # (trial,) [%], which nothing follows
    faults: dict[str, Fault] = field(default_factory=dict)  # the measurement's


def draw_setting(spec: CaseSpec) -> Setting:
    """Draw a campaign's setting from its seed."""
    rng = np.random.default_rng([spec.seed, 0])
    rig = draw_rig(rng, filmed=spec.filmed)
    population = draw_population(rng)
    loads, duration = draw_loads(spec.protocol, spec.trials, rng)
    if spec.duration_s != duration:
        loads = [Load(load.time * spec.duration_s / duration, load.tension) for load in loads]
        duration = spec.duration_s
    sd = TRACKED_SD_RAD if spec.filmed else float(np.exp(rng.uniform(*np.log([0.001, 0.005]))))
    noise = Noise(spec.noise, sd, 1.0 / rig.fps)
    trials = _draw_circumstances(loads, duration, rng)
    doses = {}
    none = (0.0,) * len(spec.effects)
    scatters = dict(zip(spec.effects, spec.scatters or none, strict=True))
    for name, joints in zip(spec.effects, spec.joints, strict=True):
        shape = {key: s.draw(rng) for key, s in EFFECTS[name].shape.items()}
        doses[name] = Dose(0.0, shape, joints, scatters[name])
    individuals = draw_individuals(population, spec.trials, rng)
    faults = _draw_faults(spec)
    for name, fault in faults.items():
        if people := NUISANCES[name].people:
            own = np.random.default_rng([spec.seed, 4])
            individuals = people(individuals, population, fault, own)
    return Setting(
        rig=rig,
        population=population,
        individuals=individuals,
        trials=trials,
        times=[draw_frame_times(noise, duration, rng) for _ in trials],
        noise=noise,
        doses=doses,
        humidity=np.round(45.0 + 5.0 * rng.normal(size=spec.trials), 1),
        faults=faults,
    )


def _draw_circumstances(
    loads: list[Load], duration: float, rng: np.random.Generator
) -> list[Circumstances]:
    """Draw each trial's warmth, which drifts, rest and luck."""
    n = len(loads)
    warmth = 2.0 * np.sin(np.linspace(0.0, rng.uniform(2.0, 6.0), n) + rng.uniform(0, 6))
    warmth += rng.normal(0.0, 1.0, n)
    rest = rng.uniform(5.0, 60.0, n)
    rest[0] = 3600.0
    return [
        Circumstances(
            number=k,
            count=n,
            load=loads[k],
            duration=duration,
            warmth=round(float(warmth[k]), 2),
            rest=round(float(rest[k])),
            luck=tuple(rng.uniform(size=3)),
        )
        for k in range(n)
    ]


def _draw_faults(spec: CaseSpec) -> dict[str, Fault]:
    """Draw nuisances, by random numbers of their own."""
    rng = np.random.default_rng([spec.seed, 3])
    return {name: NUISANCES[name].draw(rng) for name in spec.nuisances}


def set_strengths(doses: dict[str, Dose], strengths: dict[str, float]) -> dict[str, Dose]:
    """Doses with these strengths, without those that are zero."""
    return {
        name: replace(dose, strength=strengths[name])
        for name, dose in doses.items()
        if strengths[name] != 0.0
    }


def choose_trials(count: int, few: int) -> Array:
    """Places of at most a few trials, spread evenly.

    >>> choose_trials(10, 4)
    array([0, 3, 6, 9])
    """
    return np.unique(np.linspace(0, count - 1, min(count, few)).round().astype(int))


def record_cleanly(setting: Setting, doses: dict[str, Dose], chosen: Array) -> list[Recording]:
    """Recordings of some trials, free of noise and complete."""
    return [
        Recording(
            setting.times[k],
            simulate_trial(
                setting.individuals[k],
                doses,
                setting.trials[k],
                setting.rig,
                setting.times[k],
                TOLERANCE_RAD,
            ),
            setting.trials[k],
        )
        for k in chosen
    ]


def disturb(setting: Setting, recordings: list[Recording], seed: int) -> list[Recording]:
    """The recordings with noise, missing frames NaN."""
    rng = np.random.default_rng([seed, 1])
    disturbed = []
    for recording in recordings:
        angle = recording.angle + draw_noise(setting.noise, recording.time, setting.rig.joints, rng)
        angle[draw_missing(setting.noise, recording.time.size, rng)] = np.nan
        disturbed.append(replace(recording, angle=angle))
    return disturbed
