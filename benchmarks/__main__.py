"""Run the benchmarks and put their figures into results/benchmarks.json, one object, key → number.

A module's `measure` takes minutes; its `measure_long`, where it has one, up to hours (`--long`).
`python -m benchmarks jobs --long` runs the modules that it names, and no other.
Keys that are not measured in this run keep the figure of an earlier one; those of the proofs are
read from the proofs' results. In the end comes a table of goals, values and rivals.
"""

from __future__ import annotations

import importlib
import json
import pkgutil
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import benchmarks
from benchmarks._goals import print_table, read_proofs

RESULTS = Path(__file__).resolve().parents[1] / "results/benchmarks.json"


def merge_figures(measured: Mapping[str, float], without: tuple[str, ...] = ()) -> None:
    """Put figures into results/benchmarks.json; old keys that begin with any `without` go."""
    figures = json.loads(RESULTS.read_text()) if RESULTS.is_file() else {}
    kept = {k: v for k, v in figures.items() if not k.startswith(without)}
    RESULTS.parent.mkdir(exist_ok=True)
    RESULTS.write_text(json.dumps(kept | dict(measured), indent=2, sort_keys=True) + "\n")


def main(entry: str, asked: Sequence[str] = ()) -> None:
    """Measure with the modules asked for, or with all.

    They are those that have the entry; the figures are written after each.
    """
    known = sorted(m.name for m in pkgutil.iter_modules(benchmarks.__path__) if m.name[0] != "_")
    if unknown := set(asked).difference(known):
        sys.exit(f"no benchmark {', '.join(sorted(unknown))}; there are {', '.join(known)}")
    names = [name for name in known if name in asked] if asked else known
    begin = time.monotonic()
    for place, name in enumerate(names):
        measure = getattr(importlib.import_module(f"benchmarks.{name}"), entry, None)
        if measure is None:
            continue
        passed = time.monotonic() - begin
        print(f"benchmark {name}, module {place + 1} of {len(names)}, {passed:.0f} s", flush=True)
        measured = measure()
        for key, value in measured.items():
            print(f"  {key}: {value:.6g}", flush=True)
        merge_figures(measured)
    merge_figures(read_proofs())
    print_table(json.loads(RESULTS.read_text()))


if __name__ == "__main__":
    given = sys.argv[1:]
    named = [word for word in given if word != "--long"]
    main("measure_long" if "--long" in given else "measure", named)
