"""Recordings with nuisances, and the oracle's own."""

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from softfinger.concealed.arrays import Array
from softfinger.concealed.blur import build_blur, keep_frames
from softfinger.concealed.effects import Dose
from softfinger.concealed.forward import compute_plain_angles, simulate_trial
from softfinger.concealed.noise import draw_missing, draw_noise
from softfinger.concealed.nuisances import NUISANCES, Mark, Scene
from softfinger.concealed.oracle import TOLERANCE_RAD, Recording
from softfinger.concealed.protocols import Load, read_rows, write_rows
from softfinger.concealed.setting import Setting, disturb


@dataclass(frozen=True)
class Sight:
    """One trial as written, with its nuisances' marks."""

    recording: Recording  # with the stated times and the load that acted; NaN where nothing shows
    rows: Array  # (row, 2) of the load log as it is written
    known: Array  # (row, 2) of the log as the oracle knows it
    marks: dict[str, Mark]


def spoil(
    setting: Setting, doses: dict[str, Dose], clean: list[Recording], seed: int
) -> list[Sight]:
    """Add noise and nuisances to recordings free of both.

    Without nuisances the recordings are those of `setting.disturb`.
    """
    if not setting.faults:
        disturbed = disturb(setting, clean, seed)
        logs = [write_rows(recording.trial.load) for recording in disturbed]
        return [Sight(r, rows, rows, {}) for r, rows in zip(disturbed, logs, strict=True)]
    rng = np.random.default_rng([seed, 1])
    return [_spoil_trial(setting, doses, recording, seed, rng) for recording in clean]


def _spoil_trial(
    setting: Setting,
    doses: dict[str, Dose],
    clean: Recording,
    seed: int,
    rng: np.random.Generator,
) -> Sight:
    trial, time, faults = clean.trial, clean.time, setting.faults
    rows, taken = write_rows(trial.load), time
    for name, fault in faults.items():
        nuisance = NUISANCES[name]
        if nuisance.log:
            rows = nuisance.log(rows, fault, trial, _listen(name, seed, trial.number))
        if nuisance.clock:
            taken = nuisance.clock(taken, fault, trial, _listen(name, seed, trial.number))
    motion = clean.angle
    if taken is not time:
        motion = _simulate_at(setting, doses, clean, taken)
    scene = _set_scene(setting, clean, rows)
    marks = {
        name: nuisance.mark(scene, fault, _listen(name, seed, trial.number))
        for name, fault in faults.items()
        if (nuisance := NUISANCES[name]).mark
    }
    shock = np.prod(
        [np.ones(time.size), *(np.ones(time.size) * m.shock for m in marks.values())], 0
    )
    angle = motion.copy()
    noise = draw_noise(setting.noise, time, setting.rig.joints, rng, shock)
    for mark in marks.values():
        noise, angle = noise * mark.scale, angle + mark.offset
    angle += noise
    for name, fault in faults.items():
        if finish := NUISANCES[name].finish:
            angle = finish(angle, fault, _listen(name, seed, trial.number))
    angle = angle.copy()
    angle[draw_missing(setting.noise, time.size, rng)] = np.nan
    written = rows
    for name, fault in faults.items():
        if write := NUISANCES[name].write:
            written = write(written, fault, trial, _listen(name, seed, trial.number))
    return Sight(replace(clean, angle=angle), written, rows, marks)


def _simulate_at(setting: Setting, doses: dict[str, Dose], clean: Recording, taken: Array) -> Array:
    """Motion at the true times of the frames."""
    order = np.argsort(taken, kind="stable")
    individual = setting.individuals[clean.trial.number]
    rig, motion = setting.rig, np.empty_like(clean.angle)
    motion[order] = simulate_trial(individual, doses, clean.trial, rig, taken[order], TOLERANCE_RAD)
    return motion


def _set_scene(setting: Setting, clean: Recording, rows: Array) -> Scene:
    trial, offset = clean.trial, setting.rig.wire_offset
    individual = setting.individuals[trial.number].copy()
    individual[3] = 0.0

    def respond(load: Load) -> Array:
        return compute_plain_angles(individual, replace(trial, load=load), offset, clean.time)

    return Scene(clean.time, clean.angle, setting.noise, trial, rows, respond)


def recall(
    setting: Setting, sights: list[Sight], seed: int, knowing: Collection[str] | None = None
) -> list[Recording]:
    """Recordings as the oracle gets them.

    Frames that show nothing, or are of no use, are left out; the load is the one of the log.
    """
    names = list(setting.faults) if knowing is None else [n for n in setting.faults if n in knowing]
    return [_recall_trial(setting, sight, seed, names) for sight in sights]


def _recall_trial(setting: Setting, sight: Sight, seed: int, names: list[str]) -> Recording:
    recording = sight.recording
    kept = np.isfinite(recording.angle).all(axis=1)
    if not setting.faults:
        return replace(recording, time=recording.time[kept], angle=recording.angle[kept])
    trial, time = recording.trial, recording.time
    for name in names:
        if NUISANCES[name].clock_known:
            clock = NUISANCES[name].clock
            time = clock(time, setting.faults[name], trial, _listen(name, seed, trial.number))
    if any(NUISANCES[name].log for name in setting.faults):
        trial = replace(trial, load=read_rows(sight.known))
    marks = [sight.marks[name] for name in names if name in sight.marks]
    for mark in marks:
        if mark.left_out is not None:
            kept &= ~mark.left_out
    blur = build_blur(setting.noise, time, setting.rig.joints, marks)
    return Recording(time[kept], recording.angle[kept], trial, keep_frames(blur, kept))


def _listen(name: str, seed: int, trial: int) -> np.random.Generator:
    """A nuisance's random numbers in one trial."""
    return np.random.default_rng([seed, 3, list(NUISANCES).index(name), trial])
