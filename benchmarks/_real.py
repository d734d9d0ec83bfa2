"""Diagnose real recordings of others, plain and with an effect added: python -m benchmarks._real.

Plain recordings are judged by the `expected.yaml` beside them, added effects by whether the
verdict gains their id. Every campaign is diagnosed in a process of its own; its answer is a file
in OUT, and what has an answer is not diagnosed again, so that a run may end at any time.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from ruamel.yaml import YAML

from benchmarks.__main__ import RESULTS, merge_figures
from benchmarks._real_page import write_page
from benchmarks._real_weigh import choose_strength, measure_lead, read_plain
from softfinger.concealed.added import (
    Addition,
    accepts,
    claims,
    draw_additions,
    is_confident,
    read_bodies,
    write_added,
)
from softfinger.concealed.blind import diagnose_blind
from softfinger.faults import Fault
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.effect import Setting
from softfinger.provenance import PROJECT, code_hash

VISIBLE_NATS = 15.0
PATIENCE_S = 3600.0
THREADS = 2  # one campaign after the other
OUT = PROJECT / "results/proof_real"


def list_campaigns(data: Path) -> list[Path]:
    """Folders that have a campaign and answers that an expert would accept."""
    return sorted(path.parent for path in data.glob("*/campaign.yaml"))


def answer_plain(folder: Path, out: Path) -> None:
    """Diagnose real recordings as they are."""
    place = out / "diagnoses" / folder.name
    found = diagnose_blind(folder, place, PATIENCE_S, threads=THREADS)
    expected = folder / "expected.yaml"
    known = YAML(typ="safe").load(expected) if expected.is_file() else {}
    accepted = [str(answer) for answer in known.get("accept", [])]
    verdict = found["verdict"]
    found |= {
        "campaign": folder.name,
        "added": None,
        "accept": accepted,
        "right": accepts(accepted, verdict) if accepted else None,
        "confident_wrong": bool(accepted) and is_confident(verdict)
        and not accepts(accepted, verdict),
    }  # fmt: skip
    _write(found, out / f"{folder.name}.json")


def answer_added(folder: Path, addition: Addition, out: Path) -> None:
    """Add an effect to real recordings, weigh it, and diagnose them."""
    name = name_case(folder, addition)
    known = set(_read(out / f"{folder.name}.json")["claims"])
    bodies, scale = read_bodies(folder)
    with tempfile.TemporaryDirectory() as place:
        chosen, nats = choose_strength(
            folder, bodies, scale, addition, out / "diagnoses" / folder.name, Path(place)
        )
        found = {"campaign": folder.name, "added": addition.effect, "nats": nats}
        found |= {"strength": chosen.dose.strength, "shape": chosen.dose.shape}
        if nats < VISIBLE_NATS:
            _write(found | {"verdict": None, "right": None}, out / f"{name}.json")
            return
        write_added(folder, Path(place) / "added", bodies, scale, chosen)
        answered = diagnose_blind(
            Path(place) / "added", out / "diagnoses" / name, PATIENCE_S, threads=THREADS
        )
    right = addition.effect in claims(answered["verdict"]) - known
    places = (out / "diagnoses" / each for each in (folder.name, name))
    found |= answered | {"right": right, "lead": None if right else measure_lead(*places)}
    _write(found, out / f"{name}.json")


def name_case(folder: Path, addition: Addition) -> str:
    """Name of a case: campaign and effect."""
    return f"{folder.name}+{addition.effect}"


def list_cases(folders: list[Path], out: Path) -> Iterator[tuple[Path, Addition]]:
    """Additions that are new to their recordings, quick campaigns first and in turn.

    What the verdict on the plain recordings has already could not be gained, nor an effect of the
    same place: one free law is both. Nor could what the recordings cannot show, whatever they are,
    as one trial under one load shows no law of the motion: the verdict has it under `not_tried`.
    """
    waiting = []
    for folder in folders:
        plain = _read(out / f"{folder.name}.json")
        try:
            bodies, scale = read_bodies(folder)
            setting = read_plain(out / "diagnoses" / folder.name).problem.setting
        except (ValueError, Fault) as error:
            print(f"{folder.name}: {error}", flush=True)
            continue
        taken = {find_place(effect, setting) for effect in plain["claims"]}
        every = draw_additions(folder.name, len(bodies), scale)
        drawn = [
            a
            for a in every
            if find_place(a.effect, setting) not in taken and can_show(a.effect, setting)
        ]
        waiting.append((plain["cpu_seconds"], folder, drawn))
    waiting.sort(key=lambda entry: entry[0])
    for turn in range(max((len(drawn) for *_, drawn in waiting), default=0)):
        for place, (_, folder, drawn) in enumerate(waiting):
            if turn < len(drawn):  # each campaign begins with another effect
                yield folder, drawn[(turn + 3 * place) % len(drawn)]


def can_show(effect: str, setting: Setting) -> bool:
    """Whether such recordings show an effect; with it comes the covariate that it depends on."""
    warm = replace(setting, covariates={"temperature_c": setting.number})
    return not isinstance(list_effects()[effect].list_forms(warm), str)


def find_place(effect: str, setting: Setting) -> str:
    """Name of the place that an effect shares with others there; else its id."""
    known = list_effects().get(effect)
    return known.find_place(setting) if known else effect


def summarise(out: Path) -> dict[str, float]:
    """Figures of all that was answered."""
    found = [_read(path) for path in sorted(out.glob("*.json")) if path.name != "figures.json"]
    plain = [one for one in found if one["added"] is None and one["accept"]]
    added = [one for one in found if one["added"] is not None and one["right"] is not None]
    figures = {
        "real_campaigns": len(plain),
        "real_confident_wrong": sum(one["confident_wrong"] for one in plain),
        "real_added_cases": len(added),
    }
    if plain:
        figures["real_accepted_share"] = sum(one["right"] for one in plain) / len(plain)
        figures["real_seconds_most"] = max(one["seconds"] for one in plain)
        figures["real_cpu_seconds_most"] = max(one["cpu_seconds"] for one in plain)
    if added:
        right = sum(one["right"] for one in added)
        figures["real_added_named_share"] = right / len(added)
        missed = sum(not one["right"] and one["lead"] >= VISIBLE_NATS for one in added)
        figures["real_added_named_share_of_nameable"] = right / max(right + missed, 1)
    write_page(plain, [one for one in found if one["added"] is not None], figures, out)
    (out / "figures.json").write_text(json.dumps(figures, indent=2, sort_keys=True) + "\n")
    return figures


def main() -> None:
    """Answer what has no answer yet; write figures and page after each."""
    options = _parse()
    out, folders = options.out, list_campaigns(options.data)
    if not folders:
        sys.exit(f"{options.data}: no folder there has a campaign.yaml; name one by --data")
    if options.one:
        _answer_one(options.one, folders, out)
        return
    out.mkdir(parents=True, exist_ok=True)
    for folder in folders:
        _run(folder.name, options)
    left = options.cases
    for folder, addition in list_cases([f for f in folders if _has(out, f.name)], out):
        if left <= 0:
            break
        name = name_case(folder, addition)
        left -= not _has(out, name)
        _run(name, options)
    for key, value in summarise(out).items():
        print(f"  {key}: {value:.6g}", flush=True)
    merge_figures(json.loads((out / "figures.json").read_text()), without=("real_",))
    print(f"the table is {out / 'report.html'}, the figures are in {RESULTS}")


def _parse() -> argparse.Namespace:
    beside = os.environ.get("SOFTFINGER_REALDATA", PROJECT.parent / "shared/realdata")
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, default=Path(beside), help="folder of campaigns")
    parser.add_argument("--out", type=Path, default=OUT, help="folder for the answers")
    parser.add_argument("--cases", type=int, default=1000, help="new added cases at most")
    parser.add_argument("--one", help="answer this one only, in this process")
    return parser.parse_args()


def _run(name: str, options: argparse.Namespace) -> None:
    if _has(options.out, name):
        return
    command = [sys.executable, "-m", "benchmarks._real", "--one", name]
    command += ["--data", str(options.data), "--out", str(options.out)]
    done = subprocess.run(command, check=False)
    if done.returncode:
        print(f"{name}: no answer, status {done.returncode}", flush=True)
        return
    found = _read(options.out / f"{name}.json")
    nats = "" if found["added"] is None else f", {found['nats']:.0f} nats"
    print(f"{name}{nats}: {found['answer']} → {found['right']}", flush=True)
    summarise(options.out)


def _answer_one(name: str, folders: list[Path], out: Path) -> None:
    campaign, _, effect = name.partition("+")
    folder = next(f for f in folders if f.name == campaign)
    if not effect:
        answer_plain(folder, out)
        return
    bodies, scale = read_bodies(folder)
    drawn = draw_additions(campaign, len(bodies), scale)
    answer_added(folder, next(a for a in drawn if a.effect == effect), out)


def _has(out: Path, name: str) -> bool:
    return (out / f"{name}.json").is_file()


def _read(path: Path) -> dict:
    return json.loads(path.read_text(encoding="utf-8"))


def _write(found: dict, path: Path) -> None:
    from softfinger.concealed.table import describe_answer

    verdict = found["verdict"]
    found["answer"] = "not visible" if verdict is None else describe_answer(verdict)
    found["claims"] = [] if verdict is None else sorted(claims(verdict))
    found["code"] = code_hash("diagnose")
    half = path.with_suffix(".half")
    half.write_text(json.dumps(found, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    half.replace(path)


if __name__ == "__main__":
    main()
