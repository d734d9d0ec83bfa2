"""A process that diagnoses a campaign, knowing nothing."""

import hashlib
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

COMMAND = (sys.executable, "-c", "from softfinger.cli import main; main()", "diagnose")
CRASHED = {"decision": "crashed", "effects": [], "equivalent": [], "location": None, "elpd": None}


def diagnose_blind(
    campaign: Path,
    diagnosis: Path,
    patience: float,
    command: Sequence[str] = COMMAND,
    *,
    mcmc: bool = False,
    threads: int = 1,
) -> dict:
    """Diagnose a copy of a campaign, isolated.

    Parameters
    ----------
    diagnosis
        Folder that is made and gets whatever the diagnosis wrote.
    patience : float [s]
        After which it is stopped.
    command
        Takes a campaign folder and ``--out`` folder, and writes ``verdict.json`` there.
    mcmc
        Whether it samples the repaired model's parameters.
    threads
        Of the diagnosis; one, where campaigns run side by side.

    Returns
    -------
    dict
        `verdict`, whose decision is ``crashed`` where there is none; `reason`, then, else null;
        `seconds` and `cpu_seconds` that it took.
    """
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        shutil.copytree(campaign, place / "campaign")
        out = place / "out"
        out.mkdir()
        told = ["campaign", "--out", "out", "--mcmc" if mcmc else "--no-mcmc", "--no-report"]
        reason = _run([*command, *told], place, patience, threads)
        seconds = time.monotonic() - begin
        found = out / "verdict.json"
        if reason is None and not found.is_file():
            reason = "it ended without a verdict"
        verdict = CRASHED if reason else json.loads(found.read_text(encoding="utf-8"))
        shutil.copytree(out, diagnosis, dirs_exist_ok=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {
        "verdict": verdict,
        "reason": reason,
        "seconds": round(seconds, 2),
        "cpu_seconds": round(spent, 2),
    }


def _run(command: Sequence[str], place: Path, patience: float, threads: int) -> str | None:
    """Why a command failed, in a line; else None."""
    told = {"NUMBA_NUM_THREADS": str(threads), "OMP_NUM_THREADS": "1"}
    try:
        done = subprocess.run(
            command, cwd=place, capture_output=True, text=True, timeout=patience, check=False,
            env=os.environ | told,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return f"it took more than {patience:g} s"
    if done.returncode == 0:
        return None
    said = [line.strip() for line in done.stderr.splitlines() if line.strip()]
    return said[-1] if said else f"it ended with status {done.returncode}"


def write_answer(answer: dict, path: Path, digest_path: Path) -> str:
    """Write an answer and its SHA-256, and return that.

    The digest shows later that the answer was not changed.
    """
    text = json.dumps(answer, indent=1, sort_keys=True) + "\n"
    path.write_text(text, encoding="utf-8")
    digest = hashlib.sha256(text.encode()).hexdigest()
    digest_path.write_text(digest + "\n", encoding="utf-8")
    return digest


def read_answer(path: Path, digest: str) -> dict:
    """Read an answer, if its digest fits.

    Raises
    ------
    ValueError
        It was changed after its digest was written.
    """
    content = path.read_bytes()
    found = hashlib.sha256(content).hexdigest()
    if found != digest:
        raise ValueError(
            f"{path}: the answer was changed: its digest is {found[:16]}…, but {digest[:16]}… was "
            "written before the seal was opened"
        )
    return json.loads(content)
