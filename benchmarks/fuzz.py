"""Hostile and damaged inputs, drawn from seeds: each must end in sentences or in angles.

``python -m benchmarks.fuzz COUNT`` goes on where the last call ended (results/fuzz/state.json). An
input is a whole campaign, or a document of another kind, spoiled one to three times. A failure is
a traceback, an answer after more than a minute, or angles that no finger has. Its input is
minimised line by line and kept in results/fuzz/failures/ with a test that shows it.
"""

from __future__ import annotations

import json
import shutil
import signal
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import FrameType

import numpy as np

from benchmarks._hostile import spoil_text
from benchmarks._workbook import write_book
from softfinger.artifacts import list_faults, open_artifact, save_artifact
from softfinger.artifacts.specs.angles import SPEC
from softfinger.config import read_config
from softfinger.doubts import find_doubts
from softfinger.failure import describe_failure
from softfinger.faults import Fault
from softfinger.importing import (
    ImportDescription,
    read_import_description,
    read_recordings,
    write_campaign,
)
from softfinger.mechanics.effects.model_file import read_model_file
from softfinger.provenance import PROJECT, describe_run
from softfinger.rig.plan import read_plan
from softfinger.stages.check import check
from softfinger.tracking import assemble_angles

EXAMPLE = PROJECT / "data/example"
RESULTS = PROJECT / "results/fuzz"
LONGEST_S = 60  # of this process's own time
PATIENCE_S = 600  # for making a failed input smaller
BUSY = 10  # times as long by the clock
KINDS = {
    "campaign": 0.6, "source": 0.16, "config": 0.05, "model": 0.05, "plan": 0.05, "import": 0.05,
    "artifact": 0.04,
}  # fmt: skip
IMPORT = """\
version: 1
tables: {decimal: ".", files: ["*.csv"]}
clock: {column: t, unit: s}
motion: {columns: [angle], unit: deg, sign: 1}
load: {column: force, unit: N}
covariates: [{name: room_c, column: temperature}]
"""
MODEL = """\
version: 1
joint: three_element
torque: constant_arm
effects:
- {id: second_retardation, form: own_compliance, joints: [2], priors: {}}
fitted_to: null
"""


def measure() -> dict[str, float]:
    """How many inputs were tried in all calls so far, and how many of them failed."""
    tried = run(400)
    return {"fuzz_inputs": float(sum(tried.values())), "fuzz_failures": float(tried["failed"])}


def run(count: int) -> Counter:
    """Try some more seeds; the counts of all answers, from the first call on."""
    state_file = RESULTS / "state.json"
    RESULTS.mkdir(parents=True, exist_ok=True)
    state = json.loads(state_file.read_text()) if state_file.exists() else {"next": 0, "said": {}}
    said = Counter(state["said"])
    for seed in range(state["next"], state["next"] + count):
        with tempfile.TemporaryDirectory() as folder:
            said[try_seed(seed, Path(folder))] += 1
        if seed % 50 == 49 or seed == state["next"] + count - 1:
            state_file.write_text(json.dumps({"next": seed + 1, "said": said}))
    return said


def try_seed(seed: int, folder: Path) -> str:
    """Make one spoiled input and judge what is made of it: refused, aside, used or failed."""
    rng = np.random.default_rng([seed, 20261124])
    place, target, judge = make_input(rng, folder)
    answer = judge_safely(judge, place)
    if answer != "failed":
        return answer
    kept = RESULTS / f"failures/{seed}"
    shutil.rmtree(kept, ignore_errors=True)
    kept.mkdir(parents=True)
    minimise(target, lambda: judge_safely(judge, place) == "failed")
    (shutil.copytree if place.is_dir() else shutil.copy)(place, kept / "input")
    (kept / "why.txt").write_text(_explain(judge, place), encoding="utf-8")
    (kept / f"test_seed_{seed}.py").write_text(TEST.format(seed=seed), encoding="utf-8")
    return "failed"


TEST = '''\
"""An input that failed; it must end in sentences or in angles."""

from pathlib import Path

from benchmarks.fuzz import try_seed


def test_seed_{seed}(tmp_path: Path):
    assert try_seed({seed}, tmp_path) != "failed"
'''


Judge = Callable[[Path], str]


def make_input(rng: np.random.Generator, folder: Path) -> tuple[Path, Path, Judge]:
    """What is read, the file that was spoiled, the judge."""
    kind = rng.choice(list(KINDS), p=list(KINDS.values()))
    if kind == "campaign":
        place = shutil.copytree(EXAMPLE, folder / "campaign")
        files = sorted(path for path in place.rglob("*") if path.is_file())
        # Every file is worth a look, but the description and the list of trials more.
        weight = np.array([6.0 if path.parent == place else 1.0 for path in files])
        target = files[int(rng.choice(len(files), p=weight / weight.sum()))]
        judge: Judge = judge_campaign
    elif kind == "source":
        place = target = write_source(folder, rng)
        judge = judge_source
    elif kind == "artifact":
        place = target = shutil.copy(_make_artifact(), folder / "angles.nc")
        judge = judge_artifact
    else:
        place = target = folder / f"{kind}.yaml"
        text, read = {
            "config": ((PROJECT / "config/quick.yaml").read_text(encoding="utf-8"), read_config),
            "model": (MODEL, read_model_file),
            "plan": ((PROJECT / "docs/rig/plan.yaml").read_text(encoding="utf-8"), read_plan),
            "import": (IMPORT, read_import_description),
        }[kind]
        target.write_text(text, encoding="utf-8")

        def judge(path: Path) -> str:
            read(path)
            return "used"

    content = target.read_bytes()
    for _ in range(int(rng.integers(1, 4))):
        content = spoil_text(content, rng)
    target.write_bytes(content)
    return place, target, judge


def write_source(folder: Path, rng: np.random.Generator) -> Path:
    """Recordings of others, in one of four layouts."""
    rows = [["Zeit [s]", "Trial", "Winkel [deg]", "Kraft [N]"]]
    for trial in ("a", "b"):
        for k in range(40):
            motion = 12.0 * (1.0 - 2.0 ** (-k / 8))
            rows.append([f"{0.1 * k:.1f}", trial, f"{motion:.4f}", f"{2.0 * (k > 0):.1f}"])
    layout = str(rng.choice(["comma", "semicolon", "tab", "workbook"]))
    if layout == "workbook":
        write_book(folder / "source.xlsx", {"one": rows})
        return folder / "source.xlsx"
    comma = layout == "semicolon"
    between = {"comma": ",", "semicolon": ";", "tab": "\t"}[layout]
    text = "\n".join(between.join(row) for row in rows)
    path = folder / "source.csv"
    path.write_text(text.replace(".", ",") if comma else text, encoding="utf-8")
    return path


@cache
def _make_artifact() -> Path:
    path = Path(tempfile.mkdtemp(prefix="fuzz_")) / "angles.nc"
    run = describe_run("angles", {}, {})
    save_artifact(assemble_angles(check(EXAMPLE)[0], []), SPEC, path, run)
    return path


def judge_source(path: Path) -> str:
    """Import recordings, and read the campaign that they become."""
    found = read_recordings(path, ImportDescription())
    folder = path.parent / "imported"
    shutil.rmtree(folder, ignore_errors=True)
    write_campaign(folder, found.description, found.trials, found.guessed)
    return judge_campaign(folder)


def judge_artifact(path: Path) -> str:
    """Open an artifact; what is damaged must be refused."""
    found = open_artifact(path, SPEC)
    if not found.identical(open_artifact(_make_artifact(), SPEC)):
        raise AssertionError("a damaged artifact was used")
    return "used"


def judge_campaign(folder: Path) -> str:
    """Read a campaign as `check` does; what is used must be angles that a finger may have."""
    campaign, reasons, doubts = check(folder)
    angles = assemble_angles(campaign, [])
    if list_faults(SPEC, angles):
        raise AssertionError("; ".join(list_faults(SPEC, angles)))
    find_doubts(angles)
    sentences = [*reasons.values(), *(doubt.statement for doubt in doubts)]
    if not all(sentence.strip() and sentence.isprintable() for sentence in sentences):
        raise AssertionError(f"no sentence: {sentences!r}")
    return "aside" if reasons else "doubted" if doubts else "used"


def judge_safely(judge: Callable[[Path], str], place: Path) -> str:
    """The judge's answer; `refused` after a fault of the input, `failed` after anything else."""
    try:
        with warnings.catch_warnings(), _limit(LONGEST_S):
            warnings.simplefilter("error")
            return judge(place)
    except Fault as fault:
        return "refused" if str(fault).strip() else "failed"
    except Exception:  # what it is stands in the explanation
        return "failed"


@contextmanager
def _limit(seconds: int) -> Iterator[None]:
    """End what computes too long, or waits far too long: the computer may be busy with others."""

    def end(number: int, frame: FrameType | None) -> None:
        raise TimeoutError(f"no answer after {seconds} s")

    limits = {
        signal.SIGPROF: (signal.ITIMER_PROF, seconds),
        signal.SIGALRM: (signal.ITIMER_REAL, BUSY * seconds),
    }
    before = {number: signal.signal(number, end) for number in limits}
    for timer, limit in limits.values():
        signal.setitimer(timer, limit)
    try:
        yield
    finally:
        for number, (timer, _) in limits.items():
            signal.setitimer(timer, 0)
            signal.signal(number, before[number])


def minimise(target: Path, fails: Callable[[], bool]) -> None:
    """Remove lines from a file as long as it still fails, and not for ever."""
    until = time.monotonic() + PATIENCE_S
    lines = target.read_bytes().splitlines(keepends=True)
    size = max(len(lines) // 2, 1)
    while size:
        start = 0
        while start < len(lines) and time.monotonic() < until:
            fewer = lines[:start] + lines[start + size :]
            target.write_bytes(b"".join(fewer))
            if fails():
                lines = fewer
            else:
                start += size
        size //= 2
    target.write_bytes(b"".join(lines))


def _explain(judge: Callable[[Path], str], place: Path) -> str:
    try:
        judge(place)
    except Exception as error:
        return f"{type(error).__name__}: {error}\n{describe_failure(error)}\n"
    return "it took too long, or warned\n"


if __name__ == "__main__":
    began = time.monotonic()
    answers = run(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000)
    print(", ".join(f"{count} {answer}" for answer, count in sorted(answers.items())))
    print(f"{sum(answers.values())} inputs in all; this call took {time.monotonic() - began:.0f} s")
    sys.exit(1 if answers["failed"] else 0)
