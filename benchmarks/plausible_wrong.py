"""How many plausible mistakes `softfinger check` doubts, and how often it doubts right campaigns.

`python -m benchmarks.plausible_wrong` prints every mistake in every form with what was said.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import xarray as xr

from benchmarks._right import make_right
from benchmarks._wrong import MISTAKES, make_mistake, read_tables, write_tables
from softfinger.campaign import read_campaign
from softfinger.config import read_config
from softfinger.doubts import find_doubts
from softfinger.faults import Fault
from softfinger.stages.virtual_rig import virtual_rig
from softfinger.tracking import assemble_angles

PROTOCOLS = {
    "step": ([0.0, 20.0], [8.0, 8.0]),
    "levels": ([0.0, 2.0, 2.001, 8.0, 8.001, 14.0, 14.001, 20.0],
               [0.0, 0.0, 4.0, 4.0, 8.0, 8.0, 1.0, 1.0]),
}  # fmt: skip
VIRTUAL_SEEDS = range(100, 112)
CONCEALED = 48
CONCEALED_LONG = 340


def measure() -> dict[str, float]:
    """Share of mistakes that are doubted or refused, and of right campaigns that are doubted."""
    with tempfile.TemporaryDirectory() as folder:
        found = list(try_mistakes(Path(folder)))
        virtual = [judge(path) for path in make_virtual(Path(folder), VIRTUAL_SEEDS)]
    return {
        "plausible_wrong_kinds": float(len(MISTAKES)),
        "plausible_wrong_warned_share": float(np.mean([bool(said) for *_, said in found])),
    } | measure_right(CONCEALED, virtual)


def measure_long() -> dict[str, float]:
    """Share of right campaigns that are doubted, of more of them."""
    return measure_right(CONCEALED_LONG, [])


def measure_right(count: int, others: list[str]) -> dict[str, float]:
    """Share of right campaigns that are doubted: concealed physics and unkind measurement."""
    with tempfile.TemporaryDirectory() as folder:
        said = [*others, *(judge(path) for path in make_right(Path(folder), count, seed=3))]
    return {
        "right_campaigns": float(len(said)),
        "right_warned_share": float(np.mean([bool(s) for s in said])),
    }


def try_mistakes(folder: Path) -> Iterator[tuple[str, str, str, str]]:
    """Protocol, mistake, form, and what was said of it: nothing where it went unnoticed."""
    for number, protocol in enumerate(PROTOCOLS):
        right = make_campaign(folder / protocol, protocol, seed=21 + number)
        tables = read_tables(right)
        for name, (_, forms) in MISTAKES.items():
            for form in forms:
                wrong = folder / "wrong"
                write_tables(make_mistake(tables, name, form), wrong)
                yield protocol, name, form, judge(wrong)


def make_virtual(folder: Path, seeds: range) -> Iterator[Path]:
    """Right campaigns of the virtual rig under both protocols."""
    for seed in seeds:
        protocol = list(PROTOCOLS)[seed % len(PROTOCOLS)]
        yield make_campaign(folder / f"right_{seed}", protocol, seed)


def make_campaign(folder: Path, protocol: str, seed: int) -> Path:
    """Write a right campaign of eight trials at the level of angles."""
    time, tension = PROTOCOLS[protocol]
    knobs: Mapping = read_config()["virtual_rig"] | {
        "n_trials": 8,
        "level": "angles",
        "duration_s": time[-1],
        "load_time_s": time,
        "load_tension_n": tension,
    }
    folder.mkdir(parents=True)
    virtual_rig(truth=folder / "truth.nc", folder=folder / "campaign", config=knobs, seed=seed)
    return folder / "campaign"


def judge(folder: Path) -> str:
    """What `check` says of a campaign: the ids of its doubts, its refusal, or nothing."""
    try:
        angles: xr.Dataset = assemble_angles(read_campaign(folder), [])
    except Fault as fault:
        return f"refused: {str(fault).splitlines()[-1].strip()[:100]}"
    said = (
        [f"set aside {angles.sizes['set_aside_trial']}"] if angles.sizes["set_aside_trial"] else []
    )
    return ", ".join([*said, *sorted({doubt.id for doubt in find_doubts(angles)})])


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        unnoticed = 0
        for protocol, name, form, said in try_mistakes(Path(place)):
            unnoticed += not said
            print(f"{protocol:7} {name:26} {form:5} {said or 'UNNOTICED'}", flush=True)
        print(f"{unnoticed} unnoticed of {len(MISTAKES)} kinds in their forms", file=sys.stderr)
