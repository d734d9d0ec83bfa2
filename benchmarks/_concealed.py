"""Put the figures of a proof among the benchmarks: python -m benchmarks._concealed FILE.

FILE is results/PROOF/seed_N/benchmarks.json. Figures that this proof does not measure stay as they
are.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from benchmarks.__main__ import RESULTS, merge_figures
from benchmarks._goals import PROOFS

if __name__ == "__main__":
    path = Path(sys.argv[1]).resolve()
    prefixes, told = PROOFS[path.parent.parent.name], json.loads(path.read_text(encoding="utf-8"))
    measured = {key: value for key, value in told.items() if key.startswith(prefixes)}
    # a share that this proof could not measure must not stand there from another one
    merge_figures(measured, without=prefixes)
    print(f"{RESULTS.name}: {len(measured)} figures of the proof")
