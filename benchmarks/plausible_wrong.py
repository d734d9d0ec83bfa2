"""How many plausible mistakes `softfinger check` doubts.

`python -m benchmarks.plausible_wrong` prints every mistake in every form with what was said, and
writes the keys into results/benchmarks.json.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.__main__ import merge_figures
from benchmarks._judge import judge
from benchmarks._right import PROTOCOLS, make_campaign
from benchmarks._wrong import MISTAKES, make_mistake, read_tables, write_tables


def measure() -> dict[str, float]:
    """Share of mistakes that are doubted or refused."""
    with tempfile.TemporaryDirectory() as folder:
        return count(list(try_mistakes(Path(folder))))


def count(found: list[tuple[str, str, str, str]]) -> dict[str, float]:
    """Figures of what was said."""
    return {
        "plausible_wrong_kinds": float(len(MISTAKES)),
        "plausible_wrong_warned_share": float(np.mean([bool(said) for *_, said in found])),
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


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        tried = []
        for case in try_mistakes(Path(place)):
            tried.append(case)
            protocol, name, form, said = case
            print(f"{protocol:7} {name:26} {form:5} {said or 'UNNOTICED'}", flush=True)
    unnoticed = sum(not said for *_, said in tried)
    print(f"{unnoticed} of {len(tried)} unnoticed, {len(MISTAKES)} kinds", file=sys.stderr)
    merge_figures(count(tried))
