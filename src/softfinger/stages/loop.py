"""`softfinger loop`: what a round asks its rig, and keeps."""

import base64
import html
import json
import shlex
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from softfinger.artifacts import write_atomically
from softfinger.artifacts.verdict import Verdict, read_verdict
from softfinger.campaign import read_campaign
from softfinger.campaign.tables import read_text_table
from softfinger.faults import CampaignFault, Fault

FOLLOWED = 0.05
"""Mean difference of a load from its plan, as a share of the peak, that is not worth a word."""
POINTS = 500
"""Times at which they are compared."""


def is_settled(verdict: Verdict) -> bool:
    """Whether no further round would help.

    An ambiguous verdict is not settled, nor an adequate one with effects that could not show.
    What is unlisted is: no plan foresees it.
    """
    if verdict.decision == "adequate":
        return not verdict.not_testable
    return verdict.decision != "ambiguous"


def record(command: str, plan: Path, folder: Path, number: int) -> None:
    """Let a rig record a plan, in a process of its own.

    Parameters
    ----------
    command
        With {plan}, {out} and {round} in the places of the plan's file, the campaign folder that
        it writes, and the number of the round.

    Raises
    ------
    Fault
        The command fails, or leaves no campaign.
    """
    missing = [name for name in ("{plan}", "{out}") if name not in command]
    if missing:
        raise Fault(f"--rig {command}: it lacks {' and '.join(missing)}; the rig must know them")
    places = {"{plan}": str(plan), "{out}": str(folder), "{round}": str(number)}
    words = shlex.split(command)
    for key, value in places.items():
        words = [word.replace(key, value) for word in words]
    try:
        done = subprocess.run(words, capture_output=True, text=True, check=False)
    except OSError as error:
        raise Fault(f"--rig {words[0]}: it cannot be run ({error.strerror})") from None
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or ["nothing was said"])[-1]
        raise Fault(f"--rig {words[0]}: it ended with status {done.returncode}: {last}")
    try:
        read_campaign(folder)
    except CampaignFault as fault:
        raise Fault(f"--rig {words[0]}: it left no campaign in {folder}: {fault}") from None


def list_deviations(folder: Path, loads: Sequence[Mapping[str, Any]]) -> list[str]:
    """Trials whose load did not follow the plan, in sentences.

    Their logs count, whatever was planned.
    """
    campaign, said = read_campaign(folder), []
    peak = max(max(load["load"]) for load in loads)
    for trial in campaign.trials:
        if trial.load is None:
            said.append(
                f"{trial.name}: no load was logged, so nobody knows whether it was as asked"
            )
            continue
        log = read_text_table(trial.load)
        logged, value = (log[name].astype(float) for name in ("time_s", log.columns[1]))
        time = np.linspace(0.0, max(load["time_s"][-1] for load in loads), POINTS)
        seen = np.interp(time, logged, value)
        away = min(
            float(np.abs(seen - np.interp(time, load["time_s"], load["load"])).mean())
            for load in loads
        )
        if away > FOLLOWED * peak:
            said.append(
                f"{trial.name}: the load differs from the plan by {away:.3g} on average; the log "
                "counts"
            )
    return said


def tell_loop(rounds: Sequence[Path], page: Path) -> None:
    """Write the page of all rounds.

    Parameters
    ----------
    rounds
        Folders, in turn: results/verdict.json, and of later ones plan.json, plan.png,
        deviations.json.
    """
    parts = ["<!doctype html><html lang='en'><meta charset='utf-8'><title>The loop</title>"]
    parts.append("<style>body{font:16px/1.5 sans-serif;max-width:46em;margin:2em auto}"
                 "img{max-width:100%}</style><h1>The loop</h1>")  # fmt: skip
    for number, folder in enumerate(rounds):
        parts.append(f"<h2>Round {number}</h2>")
        if (folder / "plan.json").is_file():
            asked = json.loads((folder / "plan.json").read_text(encoding="utf-8"))
            parts.append(f"<p>Asked: {html.escape(asked['statement'])}</p>")
            picture = base64.b64encode((folder / "plan.png").read_bytes()).decode()
            parts.append(f"<img alt='The plan' src='data:image/png;base64,{picture}'>")
            told = json.loads((folder / "deviations.json").read_text(encoding="utf-8"))
            parts += [f"<p><b>Warning:</b> {html.escape(line)}</p>" for line in told]
        verdict = read_verdict(folder / "results/verdict.json")
        parts.append(f"<p>{verdict.n_trials} trials. Verdict: <b>{verdict.decision}</b></p>")
        parts += [f"<p>{html.escape(effect.statement)}</p>" for effect in verdict.effects]
        if verdict.decision == "ambiguous":
            alike = "; ".join(" + ".join(ids) or "none" for ids in verdict.equivalent)
            parts.append(f"<p>Not told apart: {html.escape(alike)}.</p>")
    with write_atomically(page) as temporary:
        temporary.write_text("\n".join([*parts, "</html>"]) + "\n", encoding="utf-8")
