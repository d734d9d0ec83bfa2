"""Right campaigns: every condition of the measurement, concealed physics, the virtual rig.

The first two are made by the proof's generator, without what the proof adds to score an answer.
A campaign that is in its folder already is not made again.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from softfinger.concealed.nuisances import NUISANCES
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.setting import draw_setting, record_cleanly, set_strengths
from softfinger.concealed.spoil import spoil
from softfinger.concealed.suite import CaseSpec, draw_suite
from softfinger.concealed.unkind import draw_clean
from softfinger.concealed.writer import write_campaign
from softfinger.config import read_config
from softfinger.provenance import PROJECT
from softfinger.stages.virtual_rig import virtual_rig

LONGEST = 12  # trials
WHAT = "what.txt"  # written last: the campaign is whole
PROTOCOLS = {
    "step": ([0.0, 20.0], [8.0, 8.0]),
    "levels": ([0.0, 2.0, 2.001, 8.0, 8.001, 14.0, 14.001, 20.0],
               [0.0, 0.0, 4.0, 4.0, 8.0, 8.0, 1.0, 1.0]),
}  # fmt: skip


def make_unkind(folder: Path, count: int, seed: int) -> Iterator[Path]:
    """Write clean campaigns under every condition of the unkind generator, in turn."""
    for number, spec in enumerate(draw_clean(seed, count)):
        yield _write(folder / f"unkind_{seed}_{number}", spec, {})


def make_concealed(folder: Path, count: int, seed: int) -> Iterator[Path]:
    """Write campaigns with concealed physics: half of them with one or two nuisances."""
    names = sorted(NUISANCES)
    for number, spec in enumerate(draw_suite(seed, count, filmed=0, longest=LONGEST)):
        rng = np.random.default_rng([seed, number])
        few = int(rng.integers(1, 3)) if number % 2 else 0
        nuisances = tuple(sorted(rng.choice(names, size=few, replace=False).tolist()))
        strengths = {
            name: float(np.exp(rng.uniform(*np.log([0.2 * e.typical, e.largest]))))
            for name, e in ((name, EFFECTS[name]) for name in spec.effects)
        }
        spec = replace(spec, nuisances=nuisances)
        yield _write(folder / f"concealed_{seed}_{number}", spec, strengths)


def _write(place: Path, spec: CaseSpec, strengths: Mapping[str, float]) -> Path:
    if (place / WHAT).is_file():
        return place
    setting = draw_setting(spec)
    doses = set_strengths(setting.doses, dict(strengths))
    sights = spoil(
        setting, doses, record_cleanly(setting, doses, np.arange(spec.trials)), spec.seed
    )
    rng = np.random.default_rng([spec.seed, 2])
    write_campaign(
        place,
        setting,
        [sight.recording for sight in sights],
        [sight.rows for sight in sights],
        declares_noise=bool(rng.uniform() < 0.5),
        film=None,
        seed=int(rng.integers(2**31)),
    )
    said = f"{dict(strengths)} {spec.nuisances} {spec.protocol} {spec.noise} {spec.trials} trials\n"
    (place / WHAT).write_text(said)
    return place


def make_virtual(folder: Path, seeds: range) -> Iterator[Path]:
    """Write campaigns of the virtual rig under both protocols."""
    for seed in seeds:
        protocol = list(PROTOCOLS)[seed % len(PROTOCOLS)]
        yield make_campaign(folder / f"virtual_{seed}", protocol, seed)


def make_campaign(folder: Path, protocol: str, seed: int) -> Path:
    """Write a campaign of eight trials of the virtual rig, at the level of angles."""
    time, tension = PROTOCOLS[protocol]
    if (folder / WHAT).is_file():
        return folder / "campaign"
    knobs: Mapping = read_config()["virtual_rig"] | {
        "n_trials": 8,
        "level": "angles",
        "duration_s": time[-1],
        "load_time_s": time,
        "load_tension_n": tension,
    }
    folder.mkdir(parents=True, exist_ok=True)
    virtual_rig(truth=folder / "truth.nc", folder=folder / "campaign", config=knobs, seed=seed)
    (folder / WHAT).write_text(f"{protocol}\n")
    return folder / "campaign"


def list_recorded(data: Path | None) -> list[Path]:
    """Campaigns that come with the project, and those of a folder of real ones."""
    found = [PROJECT / "data/example"]
    if data is not None:
        found += sorted(path.parent for path in data.glob("*/campaign.yaml"))
    return found
