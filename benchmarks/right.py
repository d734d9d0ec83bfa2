"""How often `softfinger check` doubts a right campaign.

``python -m benchmarks.right [--data FOLDER] [--keep FOLDER]`` judges some 350 of them, prints
those that it doubts, and writes the keys into results/benchmarks.json. Real campaigns are in
``--data``, or in the folder that SOFTFINGER_REALDATA names. In ``--keep`` the campaigns remain,
and the next call judges them without making them again.
"""

from __future__ import annotations

import argparse
import os
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack
from itertools import chain
from pathlib import Path

from benchmarks.__main__ import merge_figures
from benchmarks._judge import judge
from benchmarks._right import list_recorded, make_concealed, make_unkind, make_virtual
from softfinger.concealed.nuisances import NUISANCES
from softfinger.concealed.unkind import SEVERAL

SEED = 3
CONDITIONS = len(NUISANCES) + SEVERAL
VARIABLE = "SOFTFINGER_REALDATA"


def measure() -> dict[str, float]:
    """Share of right campaigns that are doubted: one of each condition, and some others."""
    with tempfile.TemporaryDirectory() as folder:
        return _count(
            make_right(Path(folder), rounds=1, concealed=24, virtual=12, data=find_data())
        )


def measure_long(data: Path | None = None, keep: Path | None = None) -> dict[str, float]:
    """The same over some 350 campaigns."""
    with ExitStack() as stack:
        folder = keep or Path(stack.enter_context(tempfile.TemporaryDirectory()))
        made = make_right(folder, rounds=8, concealed=160, virtual=40, data=data or find_data())
        return _count(made)


def find_data() -> Path | None:
    """The folder of real campaigns, where there is one."""
    named = os.environ.get(VARIABLE)
    return Path(named) if named else None


def make_right(
    folder: Path, rounds: int, concealed: int, virtual: int, data: Path | None
) -> Iterator[Path]:
    """Right campaigns of every source."""
    return chain(
        list_recorded(data),
        make_virtual(folder, range(100, 100 + virtual)),
        make_unkind(folder, rounds * CONDITIONS, SEED),
        make_concealed(folder, concealed, SEED),
    )


def _count(campaigns: Iterator[Path]) -> dict[str, float]:
    said = {}
    for path in campaigns:
        said[path] = judge(path)
        if said[path]:
            what = path / "what.txt"
            detail = what.read_text().strip() if what.is_file() else ""
            print(f"{path}: {said[path]}  {detail}", flush=True)
    doubted = sum(map(bool, said.values()))
    return {"right_campaigns": float(len(said)), "right_warned_share": doubted / len(said)}


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, help="folder of real campaigns")
    parser.add_argument("--keep", type=Path, help="folder in which the campaigns remain")
    options = parser.parse_args()
    measured = measure_long(options.data, options.keep)
    print(measured)
    merge_figures(measured)
