"""Cost against the number of trials: seconds and memory of the fit, and the size of the report.

Synthetic angles of the paper's population, 30 s at 30 frames a second, three joints. Each number of
trials is measured in a process of its own, whose largest memory is then the fit's. The outcome is
kept in growth.json, which the documentation draws. ``python -m benchmarks.growth 10 100`` measures
these numbers of trials anew; without any, all.

Up to 100 trials are filmed and tracked as well, again in a process of its own: CPU time and memory
of following the markers alone.

What is timed is what every fit by Gibbs sampling does: measure the recordings, fit the mode,
sample. Draws are as many as it takes, or R-hat and effective draws show.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from benchmarks.posterior import LIMITS, SHORT, build_campaign, diagnose
from softfinger.artifacts import open_artifact
from softfinger.artifacts.specs.truth import SPEC
from softfinger.campaign import read_campaign
from softfinger.config import read_config
from softfinger.inference.posterior import prepare_fit, sample_posterior
from softfinger.report import write_report
from softfinger.stages.film import film
from softfinger.stages.linear_algebra import on_one_thread
from softfinger.stages.virtual_rig import virtual_rig
from softfinger.summary import judge_run, summarise
from softfinger.summary.config import read_config as read_limits
from softfinger.tracking import track_trials

RESULTS = Path(__file__).with_name("growth.json")
TRIALS = (10, 100, 1000, 10_000)
MOST_FILMED = 100
DRAWS = SHORT | {"draws": 1000}
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
        costs = _run_alone("--fit", trials)
        if trials <= MOST_FILMED:
            with tempfile.TemporaryDirectory() as folder:
                _run_alone("--film", trials, folder)
                costs |= _run_alone("--track", trials, folder)
        measured[str(trials)] = costs
        print(f"  {trials} trials: {costs}", flush=True)
        RESULTS.write_text(json.dumps(measured, indent=1) + "\n")
    return measured


def _run_alone(task: str, *arguments: object) -> dict[str, float]:
    """Run a task of this module in a process of its own: the object that it prints."""
    command = [sys.executable, "-m", "benchmarks.growth", task, *map(str, arguments)]
    return json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout)


def film_trials(trials: int, folder: str) -> dict[str, float]:
    """Film the default campaign's first trials, as the workflow does."""
    config = read_config(None)["virtual_rig"] | {"n_trials": trials}
    truth, campaign = Path(folder) / "truth.nc", Path(folder) / "campaign"
    virtual_rig(truth=truth, folder=campaign, config=config, seed=1)
    names = open_artifact(truth, SPEC)["trial"].to_numpy()
    film(truth=truth, videos=[campaign / f"video/{n}.avi" for n in names], config=config, seed=1)
    return {}


def measure_tracking(trials: int, folder: str) -> dict[str, float]:
    """CPU seconds and largest memory of following the markers of all trials, one after another."""
    campaign = read_campaign(Path(folder) / "campaign")
    begin = time.process_time()
    found = track_trials(campaign, [trial.name for trial in campaign.trials])
    assert not found["set_aside_reason"].astype(bool).any()
    return {"track_cpu_seconds": time.process_time() - begin, "track_memory_gib": _read_memory()}


def _read_memory() -> float:
    """Largest memory of this process so far [GiB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20


@on_one_thread
def measure_fit(trials: int) -> dict[str, float]:
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
    memory = _read_memory()
    found = diagnose(posterior, stats)
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


def sum_up(angles: xr.Dataset, config: Mapping[str, Any]) -> dict[str, Any]:
    """The artifacts of a report on recordings alone."""
    limits = read_limits(config["report"])
    made = {
        "checks": judge_run({"angles": angles}, limits, np.random.default_rng(0)),
        "summary": summarise({"angles": angles}, limits, {}),
    }
    for tree in made.values():
        tree.attrs |= {"ci_prob": limits.ci_prob, "stage": "summarise", "note": ""}
    return {"angles": angles, **made}


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
        config = read_config(None)
        write_report(sum_up(angles, config), config, path)
        return path.stat().st_size / 2**20


if __name__ == "__main__":
    tasks = {"--fit": measure_fit, "--film": film_trials, "--track": measure_tracking}
    task, *rest = sys.argv[1:] or [""]
    if task in tasks:
        print(json.dumps(tasks[task](int(rest[0]), *rest[1:])))
    else:
        measure_all(tuple(int(word) for word in sys.argv[1:]) or TRIALS)
