"""Right campaigns: concealed physics of any strength, and every condition of the measurement.

They are made by the proof's generator, without what the proof adds to score an answer.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from softfinger.concealed.nuisances import NUISANCES
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.setting import draw_setting, record_cleanly, set_strengths
from softfinger.concealed.spoil import spoil
from softfinger.concealed.suite import draw_suite
from softfinger.concealed.writer import write_campaign

LONGEST = 12  # trials


def make_right(folder: Path, count: int, seed: int) -> Iterator[Path]:
    """Write right campaigns: half of them kind, the others with one or two nuisances."""
    rng = np.random.default_rng(seed)
    names = sorted(NUISANCES)
    for number, spec in enumerate(draw_suite(seed, count, filmed=0, longest=LONGEST)):
        few = int(rng.integers(0, 3)) if number % 2 else 0
        nuisances = tuple(sorted(rng.choice(names, size=few, replace=False).tolist()))
        setting = draw_setting(replace(spec, nuisances=nuisances))
        strengths = {
            name: float(np.exp(rng.uniform(*np.log([0.2 * e.typical, e.largest]))))
            for name, e in ((name, EFFECTS[name]) for name in spec.effects)
        }
        doses = set_strengths(setting.doses, strengths)
        clean = record_cleanly(setting, doses, np.arange(spec.trials))
        sights = spoil(setting, doses, clean, spec.seed)
        place = folder / f"right_{seed}_{number}"
        write_campaign(
            place,
            setting,
            [sight.recording for sight in sights],
            [sight.rows for sight in sights],
            declares_noise=bool(rng.uniform() < 0.5),
            film=None,
            seed=int(rng.integers(2**31)),
        )
        (place / "what.txt").write_text(f"{strengths} {nuisances} {spec.protocol}\n")
        yield place
