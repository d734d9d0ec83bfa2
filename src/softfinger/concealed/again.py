"""Records a concealed finger again, under loads that are asked for.

A rig behind a process boundary: `python -m softfinger.concealed.again TRUTH PLAN OUT ROUND` reads
the sealed truth, and leaves a campaign folder with recordings and nothing else.
"""

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from softfinger.concealed.noise import draw_frame_times
from softfinger.concealed.population import draw_individuals
from softfinger.concealed.protocols import Load
from softfinger.concealed.setting import Setting, draw_setting, record_cleanly, set_strengths
from softfinger.concealed.spoil import spoil
from softfinger.concealed.suite import CaseSpec
from softfinger.concealed.writer import write_campaign


def record_again(
    spec: CaseSpec,
    strengths: Mapping[str, float],
    loads: Sequence[Load],
    duration: float,
    number: int,
    folder: Path,
) -> None:
    """Record one trial for each load, of the same finger and population.

    Parameters
    ----------
    spec, strengths
        What was concealed, and the strength of each effect.
    duration
        Of a trial [s].
    number
        Of the round, from 1: its trials are numbered after those of the rounds before.
    folder
        The campaign folder that is written.
    """
    setting = _continue(draw_setting(spec), spec, loads, duration, number)
    doses = set_strengths(setting.doses, dict(strengths))
    clean = record_cleanly(setting, doses, np.arange(len(loads)))
    sights = spoil(setting, doses, clean, spec.seed + number)
    write_campaign(
        folder,
        setting,
        [sight.recording for sight in sights],
        [sight.rows for sight in sights],
        declares_noise=False,
        day=number,
    )


def read_loads(plan: Path) -> tuple[list[Load], float]:
    """Loads of a plan, one for each trial, and the duration of a trial [s]."""
    asked = json.loads(plan.with_suffix(".json").read_text(encoding="utf-8"))
    drawn = [Load(np.array(one["time_s"]), np.array(one["load"])) for one in asked["loads"]]
    return [drawn[k % len(drawn)] for k in range(asked["n_trials"])], asked["duration_s"]


def read_spec(case: Mapping[str, Any]) -> CaseSpec:
    """A case as it was written to JSON."""
    fields = {key: tuple(v) if isinstance(v, list) else v for key, v in case.items()}
    fields["joints"] = tuple(tuple(joints) for joints in case["joints"])
    return CaseSpec(**fields)


def _continue(
    setting: Setting, spec: CaseSpec, loads: Sequence[Load], duration: float, number: int
) -> Setting:
    """The setting with new trials of the same population."""
    rng = np.random.default_rng([spec.seed, 6, number])
    first = spec.trials + (number - 1) * len(loads)
    trials = [
        replace(
            setting.trials[k % spec.trials],
            number=first + k,
            load=load,
            duration=duration,
            warmth=round(float(rng.normal(0.0, 2.0)), 2),
            rest=round(float(rng.uniform(5.0, 60.0))) if k else 3600.0,
            luck=tuple(rng.uniform(size=3)),
        )
        for k, load in enumerate(loads)
    ]
    return replace(
        setting,
        individuals=draw_individuals(setting.population, len(loads), rng),
        trials=trials,
        times=[draw_frame_times(setting.noise, duration, rng) for _ in loads],
        humidity=np.round(45.0 + 5.0 * rng.normal(size=len(loads)), 1),
    )


def main() -> None:
    """Record a plan, as a rig would."""
    truth, plan, out, number = sys.argv[1:]
    sealed = json.loads(Path(truth).read_text(encoding="utf-8"))
    loads, duration = read_loads(Path(plan))
    record_again(
        read_spec(sealed["case"]), sealed["strengths"], loads, duration, int(number), Path(out)
    )


if __name__ == "__main__":
    main()
