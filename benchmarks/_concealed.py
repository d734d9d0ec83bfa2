"""Put the figures of a proof among the benchmarks: python -m benchmarks._concealed FILE [PREFIX].

With a prefix only figures whose key begins with it are put there: a proof of one kind of campaign
leaves the others' figures as they are.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from benchmarks.__main__ import RESULTS, merge_figures
from benchmarks._goals import PROOFS

if __name__ == "__main__":
    prefixes = tuple(sys.argv[2:]) or PROOFS["concealed_long"]
    told = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    measured = {key: value for key, value in told.items() if key.startswith(prefixes)}
    # a share that this proof could not measure must not stand there from another one
    merge_figures(measured, without=prefixes)
    print(f"{RESULTS.name}: {len(measured)} figures of the proof")
