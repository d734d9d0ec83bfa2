"""Run the benchmarks and put their figures into results/benchmarks.json, one object, key → number.

Keys that are not measured in this run keep the figure of an earlier one.
"""

from __future__ import annotations

import importlib
import json
import pkgutil
from pathlib import Path

import benchmarks

RESULTS = Path(__file__).resolve().parents[1] / "results/benchmarks.json"


def main() -> None:
    """Measure with every module of this package and write the figures after each."""
    figures = json.loads(RESULTS.read_text()) if RESULTS.is_file() else {}
    names = sorted(m.name for m in pkgutil.iter_modules(benchmarks.__path__) if m.name[0] != "_")
    for name in names:
        print(f"benchmark {name}", flush=True)
        measured = importlib.import_module(f"benchmarks.{name}").measure()
        for key, value in measured.items():
            print(f"  {key}: {value:.6g}", flush=True)
        figures |= measured
        RESULTS.write_text(json.dumps(figures, indent=2, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
