"""A concealed finger that records what a plan asks.

It runs in a process of its own, reads the truth, and gives a campaign folder and nothing else:

    python -m softfinger.concealed.answer TRUTH PLAN OUT ROUND
"""

import json
import sys
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import numpy as np
import pandas as pd

from softfinger.concealed.arrays import Array
from softfinger.concealed.effects import Circumstances
from softfinger.concealed.noise import draw_frame_times
from softfinger.concealed.population import draw_individuals
from softfinger.concealed.protocols import Load
from softfinger.concealed.setting import Setting, draw_setting, record_cleanly, set_strengths
from softfinger.concealed.spoil import spoil
from softfinger.concealed.suite import CaseSpec
from softfinger.concealed.writer import write_campaign
from softfinger.gate import read_document

STREAM = 7
"""Of the random numbers of later rounds: the first campaign uses those before it."""


def answer_plan(truth: Path, plan: Path, folder: Path, number: int) -> None:
    """Record a plan with the finger of a truth.

    The same finger, population, physics and noise; every trial has parameters of its own, and
    trials go on counting from the first campaign.

    Parameters
    ----------
    truth
        As `generate_campaign` wrote it.
    plan
        A plan of the rig, whose profiles are paths.
    folder
        The campaign folder; must not exist yet.
    number
        Of the round, from 1: every round has random numbers of its own.
    """
    known = json.loads(truth.read_text(encoding="utf-8"))
    spec = read_spec(known["case"])
    loads, rest = read_loads(plan)
    rng = np.random.default_rng([spec.seed, STREAM, number])
    setting = _continue(draw_setting(spec), loads, rest, number, rng)
    doses = set_strengths(setting.doses, {e["name"]: e["strength"] for e in known["effects"]})
    clean = record_cleanly(setting, doses, np.arange(len(loads)))
    sights = spoil(setting, doses, clean, int(rng.integers(2**62)))
    write_campaign(
        folder,
        setting,
        [sight.recording for sight in sights],
        [sight.rows for sight in sights],
        declares_noise=False,
    )
    _date(folder / "trials.csv", number)


def read_spec(case: dict) -> CaseSpec:
    """A case as it was before it was written.

    >>> spec = CaseSpec(1, ("inertia",), ((),), (0.5,), "levels", 10, "white")
    >>> read_spec(json.loads(json.dumps(spec.to_json()))) == spec
    True
    """
    parts = {k: tuple(v) if isinstance(v, list) else v for k, v in case.items()}
    return CaseSpec(**parts | {"joints": tuple(tuple(j) for j in case["joints"])})


def read_loads(plan: Path) -> tuple[list[Load], float]:
    """Every trial's load, and the rest between trials [s]."""
    content = read_document(plan).content
    loads = []
    for profile in content["profiles"]:
        time, tension = (np.array(profile[key], float) for key in ("time_s", "tension_n"))
        if tension[0] > 0.0:  # a jump when the trial starts, from a slack wire
            time, tension = np.append(0.0, time), np.append(0.0, tension)
        loads.append(Load(time, tension))
    recording = content["recording"]
    return loads * int(recording["repeats"]), float(recording["rest_s"])


def _continue(
    first: Setting, loads: list[Load], rest: float, number: int, rng: np.random.Generator
) -> Setting:
    """The setting of further trials."""
    before = len(first.trials) + (number - 1) * len(loads)
    trials = [
        Circumstances(
            number=before + k,
            count=len(first.trials),
            load=load,
            duration=float(load.time[-1]),
            warmth=round(float(rng.normal(0.0, 1.0)), 2),
            rest=rest,
            luck=tuple(rng.uniform(size=3)),
        )
        for k, load in enumerate(loads)
    ]
    humidity: Array = np.round(45.0 + 5.0 * rng.normal(size=len(trials)), 1)
    return replace(
        first,
        individuals=draw_individuals(first.population, len(trials), rng),
        trials=trials,
        times=[draw_frame_times(first.noise, trial.duration, rng) for trial in trials],
        humidity=humidity,
    )


def _date(table: Path, number: int) -> None:
    """A day later for every round."""
    rows = pd.read_csv(table)
    started = pd.to_datetime(rows["started_at"], format="ISO8601") + timedelta(days=number)
    rows.assign(started_at=[moment.isoformat() for moment in started]).to_csv(table, index=False)


if __name__ == "__main__":
    answer_plan(Path(sys.argv[1]), Path(sys.argv[2]), Path(sys.argv[3]), int(sys.argv[4]))
