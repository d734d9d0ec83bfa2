"""Put the figures of a proof among the benchmarks: python -m benchmarks._concealed FILE."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from benchmarks.__main__ import RESULTS, merge_figures

if __name__ == "__main__":
    measured = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    # a share that this proof could not measure must not stand there from another one
    merge_figures(measured, without="concealed_")
    print(f"{RESULTS.name}: {len(measured)} figures of the proof")
