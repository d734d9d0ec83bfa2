"""The diagnosis as a user types it, in a process of its own, on committed campaigns.

The report is written too, and everything is warm: a run that had to compile is repeated. What is
measured is kept beside the results, so that a run that is stopped, or that reaches its time limit,
goes on where it ended. It is forgotten when the code of the diagnosis changes. Figures are given
when all are measured.

The rival is a naive search over the same catalogue, on the same angles, in a process of its own.
Beside the times is how many of the drawn campaigns got their right name.
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

from benchmarks._campaigns import DRAWN, list_campaigns
from softfinger.provenance import PROJECT, code_hash

SEARCH = (sys.executable, "-m", "benchmarks.rivals.naive_search")
COMMAND = (sys.executable, "-c", "from softfinger.cli import main; main()", "diagnose")
FOLDER = PROJECT / "results/benchmark_diagnosis"
CODE = {
    "--no-mcmc": "softfinger.stages.diagnose",
    "--mcmc": "softfinger.stages.diagnose",
    "--search": "benchmarks.rivals.naive_search",
}
LIMIT_S, LONG_LIMIT_S = 420.0, 7200.0


class Spent(NamedTuple):
    """CPU and wall seconds of a command, its decision and the effects that it names."""

    cpu: float
    wall: float
    decision: str
    effects: list[str]


def measure() -> dict[str, float]:
    """CPU seconds without sampling, median and worst, and the share of right names."""
    return _describe("diagnosis", measure_all("--no-mcmc", LIMIT_S))


def measure_long() -> dict[str, float]:
    """The same without limit, of the rival too, and wall seconds with sampling."""
    figures = _describe("diagnosis", measure_all("--no-mcmc", LONG_LIMIT_S))
    figures |= _describe("diagnosis_naive_search", measure_all("--search", LONG_LIMIT_S))
    sampled = [spent.wall for spent in measure_all("--mcmc", LONG_LIMIT_S).values()]
    return figures | _sum_up("diagnosis_sampled_seconds", sampled)


def _describe(key: str, spent: dict[str, Spent]) -> dict[str, float]:
    if not spent:
        return {}
    right = [
        set(spent[name].effects) == {effect for effect, _ in drawn.effects}
        for name, drawn in DRAWN.items()
    ]
    seconds = _sum_up(f"{key}_cpu_seconds", [one.cpu for one in spent.values()])
    return {**seconds, f"{key}_right_name_share": statistics.fmean(right)}


def _sum_up(key: str, seconds: list[float]) -> dict[str, float]:
    if not seconds:
        return {}
    return {f"{key}_median": statistics.median(seconds), f"{key}_worst": max(seconds)}


def measure_all(option: str, limit_s: float) -> dict[str, Spent]:
    """What each campaign took; none where the limit came before the last."""
    record, code = FOLDER / f"measured{option}.json", code_hash(CODE[option])
    kept = json.loads(record.read_text()) if record.is_file() else {}
    known: dict[str, list] = kept["spent"] if kept.get("code") == code else {}
    spent, begin = {}, time.monotonic()
    for name, campaign in list_campaigns(FOLDER / "campaigns"):
        if name not in known:
            if time.monotonic() - begin > limit_s:
                print(f"  {limit_s:g} s are over at {name}; the next run goes on here", flush=True)
                return {}
            known[name] = list(run_warm(campaign, FOLDER / "out" / name, option))
            record.write_text(json.dumps({"code": code, "spent": known}, indent=1) + "\n")
        spent[name] = Spent(*known[name])
        cpu, wall, decision, effects = spent[name]
        print(f"  {name}: {cpu:.1f} s of CPU, {wall:.1f} s, {decision} {effects}", flush=True)
    return spent


def run_warm(campaign: Path, out: Path, option: str) -> Spent:
    """Diagnose a campaign; again where code was compiled."""
    before = count_compiled()
    spent = run(campaign, out, option)
    return run(campaign, out, option) if count_compiled() > before else spent


def count_compiled() -> int:
    """Number of compiled functions that are kept."""
    return sum(1 for _ in (PROJECT / "src").rglob("*.nbc"))


def run(campaign: Path, out: Path, option: str) -> Spent:
    """Diagnose a campaign as a user does, or by the rival from the angles that this left."""
    out.mkdir(parents=True, exist_ok=True)
    if option == "--search":
        answer = out / "search.json"
        spent = _run_alone([*SEARCH, str(out / "angles.nc"), str(answer)], out)
        said = json.loads(answer.read_text())["bic"]
    else:
        answer = out / "verdict.json"
        spent = _run_alone([*COMMAND, str(campaign), "--out", str(out), option], out)
        said = json.loads(answer.read_text())
    effects = sorted({effect["id"] for effect in said["effects"]})
    return Spent(*spent, said["decision"], effects)


def _run_alone(command: list[str], out: Path) -> tuple[float, float]:
    """CPU seconds, with all that it starts, and wall seconds of a command."""
    begin = time.perf_counter()
    with (out / "messages.txt").open("w") as messages:
        child = subprocess.Popen(command, stdout=messages, stderr=messages, cwd=PROJECT)
        _, status, usage = os.wait4(child.pid, 0)
    wall = time.perf_counter() - begin
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        raise ChildProcessError(f"{' '.join(command)} failed; see {out}/messages.txt")
    return usage.ru_utime + usage.ru_stime, wall
