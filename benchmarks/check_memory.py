"""Peak memory of `softfinger check` on ten million rows, in one file and in ten.

``python -m benchmarks.check_memory`` writes the keys into results/benchmarks.json.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks.__main__ import merge_figures
from softfinger.doubts.response import compute_terms
from softfinger.provenance import PROJECT

ROWS = 10_000_000
PIECE = 200_000
INTERVAL_S = 1e-3
CODE = "from softfinger.cli import main; main()"
DESCRIPTION = """\
version: 1
name: long
source: synthetic
finger: {joints: 3, link_length_m: [0.025, 0.025, 0.025], link_mass_kg: [0.005, 0.005, 0.005],
  joint_length_m: 0.008, wire_offset_m: 0.005}
"""


def measure_long() -> dict[str, float]:
    """Peak resident memory [GiB] of the verb."""
    found = {"check_rows": float(ROWS)}
    for files in (1, 10):
        with tempfile.TemporaryDirectory() as place:
            write_long(Path(place), files, ROWS // files)
            peak, took = watch(Path(place))
        found |= {f"check_peak_gib_{files}_files": peak}
        print(f"{files} files: {peak:.3g} GiB, {took:.0f} s", flush=True)
    return found


def write_long(folder: Path, files: int, rows: int) -> None:
    """Write a right campaign whose trials are very long."""
    (folder / "campaign.yaml").write_text(DESCRIPTION)
    for name in ("angles", "load"):
        (folder / name).mkdir(exist_ok=True)
    lines = ["trial,angles,load"]
    for number in range(files):
        lines.append(f"t{number},angles/t{number}.csv,load/t{number}.csv")
        _write_trial(folder, number, rows)
    (folder / "trials.csv").write_text("\n".join(lines) + "\n")


def _write_trial(folder: Path, number: int, rows: int) -> None:
    rng = np.random.default_rng(number)
    span = rows * INTERVAL_S
    knots = np.array([0.0, 0.1, 0.1, 0.6, 0.6, 1.0]) * span
    tension = np.array([0.0, 0.0, 8.0, 8.0, 2.0, 2.0])
    load = pd.DataFrame({"time_s": knots, "tension_n": tension})
    load.to_csv(folder / f"load/t{number}.csv", index=False)
    own = np.array([6.0, 9.0, 4.0])[:, None] * np.exp(0.1 * rng.standard_normal((3, 3)))
    times = np.array([0.0, 0.02, 0.2]) * span
    with (folder / f"angles/t{number}.csv").open("w") as stream:
        stream.write("time_s,q1_rad,q2_rad,q3_rad\n")
        for first in range(0, rows, PIECE):
            time_s = INTERVAL_S * np.arange(first, min(first + PIECE, rows))
            error = 0.002 * rng.standard_normal((4, time_s.size)) / np.sqrt(2)
            motion = own @ compute_terms(time_s, knots, 0.005 * tension, times).T
            table = np.column_stack([time_s, (motion + np.diff(error, axis=0)).T])
            pd.DataFrame(table).to_csv(stream, index=False, header=False, float_format="%.7g")


def watch(folder: Path) -> tuple[float, float]:
    """Peak resident memory [GiB] and time [s] of `softfinger check` on a folder."""
    began = time.monotonic()
    environment = os.environ | {"PYTHONPATH": str(PROJECT / "src")}
    command = [sys.executable, "-c", CODE, "check", str(folder)]
    child = os.posix_spawn(sys.executable, command, environment)
    _, status, used = os.wait4(child, 0)
    if status:
        raise RuntimeError(f"check ended with status {os.waitstatus_to_exitcode(status)}")
    return used.ru_maxrss / 2**20, time.monotonic() - began


if __name__ == "__main__":
    measured = measure_long()
    print(measured)
    merge_figures(measured)
