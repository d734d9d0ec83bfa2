"""Rule `score`: open seals, score, write the page."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from softfinger.artifacts import open_artifact
from softfinger.artifacts.specs.repair import SPEC as REPAIR
from softfinger.concealed.blind import read_answer
from softfinger.concealed.score import collect_benchmarks, shuffle_truths
from softfinger.concealed.score import score as score_verdicts
from softfinger.concealed.seal import open_seal
from softfinger.concealed.table import tabulate_cases, tabulate_measured
from softfinger.report.concealed import Proof, render_proof
from softfinger.summary.buried import average_residual

Paths = Sequence[Path]


def score(
    *,
    truth: Paths,
    salt: Paths,
    seal: Paths,
    answer: Paths,
    digest: Paths,
    limits: Paths,
    rivals: Paths,
    measured: Paths,
    diagnoses: Paths,
    score: Path,
    table: Path,
    figures: Path,
    seed: int,
    known: Mapping[str, Any],
) -> None:
    """Write the proof's page, table and benchmark figures.

    Parameters
    ----------
    truth, salt, seal, answer, digest, diagnoses
        Files and folders of every campaign, in one order.
    rivals, limits
        Answers of two rivals, and what the oracle could name, of all campaigns or some.
    measured
        Answers to the real recordings that are there.
    score, table, figures
        The page, the table of campaigns (CSV) and key → number (JSON), which are written.
    known
        The `folder` of the real recordings, and what is `known` of each.
    """
    names = [Path(path).stem for path in truth]
    seals, digests = [_read_line(path) for path in seal], [_read_line(path) for path in digest]
    answers = [read_answer(Path(p), d) for p, d in zip(answer, digests, strict=True)]
    truths = [open_seal(Path(t), Path(s), d) for t, s, d in zip(truth, salt, seals, strict=True)]
    verdicts = [found["verdict"] for found in answers]
    asked = {Path(path).stem: _read_json(path) for path in limits}
    weighed = [asked.get(name, {}) for name in names]
    curves = [_read_curves(Path(path) / "laws.nc") for path in diagnoses]
    scored = _score(verdicts, truths, weighed, answers, curves, seed)
    cases = tabulate_cases(names, truths, answers, weighed)
    pd.DataFrame(cases).to_csv(table, index=False)
    found = collect_benchmarks(scored) | {"concealed_campaigns": len(cases)}
    Path(figures).write_text(json.dumps(found, indent=2, sort_keys=True) + "\n", encoding="utf-8")
    page = render_proof(
        Proof(
            seed=seed,
            score=scored,
            rivals=_score_rivals(rivals, names, truths, weighed),
            cases=cases,
            seals=list(zip(names, seals, digests, strict=True)),
            measured=_tabulate_measured(measured, known),
            buried=_find_buried(cases, verdicts, diagnoses),
        )
    )
    Path(score).write_text(page, encoding="utf-8")


def _score(
    verdicts: Sequence[dict],
    truths: Sequence[dict],
    weighed: Sequence[dict],
    answers: Sequence[dict],
    curves: Sequence[xr.Dataset | None],
    seed: int,
) -> xr.Dataset:
    seconds = [found["seconds"] for found in answers]
    scored = score_verdicts(verdicts, truths, weighed, curves=curves, seconds=seconds)
    spent = [found["cpu_seconds"] for found in answers]
    cost = {
        "seconds_median": float(np.median(seconds)),
        "seconds_most": max(seconds),
        "cpu_seconds_median": float(np.median(spent)),
    }
    chance = shuffle_truths(verdicts, truths, np.random.default_rng(seed))
    return scored.assign_attrs(source="synthetic", chance=chance, **cost)


def _score_rivals(
    rivals: Paths, names: Sequence[str], truths: Sequence[dict], weighed: Sequence[dict]
) -> dict[str, xr.Dataset]:
    if not rivals:
        return {}
    said = [_read_json(path) for path in rivals]
    asked = [names.index(Path(path).stem) for path in rivals]
    truths, weighed = [truths[k] for k in asked], [weighed[k] for k in asked]
    columns = {"loo": "frame-wise LOO", "bic": "per-trial BIC"}
    return {
        name: score_verdicts([answer[key] for answer in said], truths, weighed)
        for key, name in columns.items()
    }


def _tabulate_measured(answers: Paths, known: Mapping[str, Any]) -> list[dict] | str:
    if not answers:
        return f"Skipped: the folder {known['folder']} with the real recordings is not there."
    said = {Path(path).stem: _read_json(path) for path in answers}
    return [tabulate_measured(name, known["known"][name], found) for name, found in said.items()]


def _find_buried(
    cases: Sequence[Mapping], verdicts: Sequence[dict], diagnoses: Paths
) -> tuple[str, str, xr.Dataset] | None:
    """Find the strongest named case buried in noise."""
    masked = [k for k, case in enumerate(cases) if case["masked"] and case["contains"]]
    if not masked:
        return None
    k = max(masked, key=lambda k: (cases[k]["right"], cases[k]["oracle_nats"]))
    case = cases[k]
    said = " ".join(effect["statement"] for effect in verdicts[k]["effects"])
    sentence = (
        f"Campaign {case['campaign']} ({case['trials']} trials, {case['protocol']}) concealed "
        f"{case['truth']}. The base model's residual is at the noise: its parameters have "
        f"absorbed the effect. The oracle gains {case['oracle_nats']:.0f} nats. The verdict: "
        f"{said}"
    )
    repair = open_artifact(Path(diagnoses[k]) / "repair.nc", REPAIR)
    return case["campaign"], sentence, average_residual(repair)


def _read_curves(path: Path) -> xr.Dataset | None:
    return xr.load_dataset(path, engine="h5netcdf") if path.is_file() else None


def _read_json(path: Path) -> dict:
    return json.loads(Path(path).read_text(encoding="utf-8"))


def _read_line(path: Path) -> str:
    return Path(path).read_text(encoding="utf-8").strip()
