"""Cost against the number of trials: seconds and memory of the fit, and the size of the report.

Synthetic angles of the paper's population, 30 s at 30 frames a second, three joints. Each number of
trials is measured in a process of its own, whose largest memory is then the fit's. The outcome is
kept in growth.json, which the documentation draws. ``python -m benchmarks.growth 10 100`` measures
these numbers of trials anew; without any, all.

What is timed is what every fit in blocks does: reduce the recordings, find the pilot fit, compile,
sample. Draws are as many as it takes, or R-hat and effective draws tell.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import xarray as xr

from benchmarks.posterior import LIMITS, SHORT, build_campaign, describe, diagnose
from softfinger.config import read_config
from softfinger.estimation.posterior import prepare_fit, sample_posterior
from softfinger.report import write_report
from softfinger.stages.linear_algebra import on_one_thread

RESULTS = Path(__file__).with_name("growth.json")
TRIALS = (10, 100, 1000, 10_000)
DRAWS = SHORT | {"draws": 600}
FEW = DRAWS | {"tune": 1, "draws": 1}  # to compile


def measure_long() -> dict[str, float]:
    """Measure all numbers of trials; the figures of the largest, if its chains agree."""
    measured = measure_all(TRIALS)
    largest = measured[str(TRIALS[-1])]
    if largest["r_hat"] > LIMITS["r_hat_max"] or largest["effective_draws"] < LIMITS["ess_min"]:
        return {}
    return {
        "posterior_10000_trials_seconds": largest["seconds"],
        "posterior_10000_trials_gib": largest["memory_gib"],
    }


def measure_all(numbers: tuple[int, ...]) -> dict[str, dict[str, float]]:
    """Measure each number of trials in a process of its own, and keep what was found."""
    measured = json.loads(RESULTS.read_text()) if RESULTS.is_file() else {}
    for trials in numbers:
        command = [sys.executable, "-m", "benchmarks.growth", "--alone", str(trials)]
        said = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
        measured[str(trials)] = json.loads(said.splitlines()[-1])
        print(f"  {trials} trials: {said.strip()}", flush=True)
        RESULTS.write_text(json.dumps(measured, indent=1) + "\n")
    return measured


@on_one_thread
def measure_once(trials: int) -> dict[str, float]:
    """Wall seconds of each step, CPU seconds and largest memory of a fit; size of the report."""
    angles, _ = build_campaign(trials, 3)
    clock, cpu = [time.perf_counter()], time.process_time()
    prepared = prepare_fit(angles)
    clock.append(time.perf_counter())
    posterior, stats = sample_posterior(prepared, FEW, np.random.default_rng(4))
    clock.append(time.perf_counter())
    posterior, stats = sample_posterior(prepared, DRAWS, np.random.default_rng(4))
    clock.append(time.perf_counter())
    cpu = time.process_time() - cpu
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    found = diagnose(posterior, stats)
    print(describe(found), flush=True)
    prepare, compilation, sampling = np.diff(clock).tolist()
    return {
        "seconds": clock[-1] - clock[0],
        "prepare_seconds": prepare,
        "compile_seconds": compilation,
        "sample_seconds": sampling,
        "cpu_seconds": cpu,
        "memory_gib": memory,
        "report_mib": measure_report(angles),
        "r_hat": float(found["r_hat"].max()),
        "effective_draws": float(min(found["ess_bulk"].min(), found["ess_tail"].min())),
    }


def measure_report(angles: xr.Dataset) -> float:
    """Size [MiB] of a report on the recordings alone, the part that could grow with them."""
    none, unknown = np.array([], object), np.full(angles.sizes["trial"], np.nan)
    angles = angles.assign(
        set_aside_reason=("set_aside_trial", none),
        started_at=("trial", unknown),
        covariate_value=(("trial", "covariate"), np.empty((len(unknown), 0))),
    ).assign_coords(set_aside_trial=none, covariate=none)
    angles.attrs |= {"campaign": "growth", "source": "synthetic", "stage": "angles"}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "report.html"
        write_report({"angles": angles}, read_config(None), path)
        return path.stat().st_size / 2**20


if __name__ == "__main__":
    numbers = [int(word) for word in sys.argv[1:] if word.isdecimal()]
    if "--alone" in sys.argv[1:]:
        print(json.dumps(measure_once(numbers[0])))
    else:
        measure_all(tuple(numbers) or TRIALS)
