"""Diagnose the campaigns of another version's proof: python -m benchmarks._before FOLDER.

FOLDER has that version's campaigns, answers and truths (a seed's results of `make concealed`). The
answers of this version go into OUT; what has an answer is not diagnosed again. A table in the end
lists both answers campaign by campaign.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path

from softfinger.concealed.blind import diagnose_blind
from softfinger.concealed.judge import judge
from softfinger.provenance import PROJECT

OUT = PROJECT / "results/before"
PATIENCE_S = 1800.0


def answer_all(folder: Path, out: Path) -> None:
    """Diagnose what only the other version has answered."""
    out.mkdir(parents=True, exist_ok=True)
    for path in sorted((folder / "answer").glob("*.json")):
        answer = out / path.name
        if answer.is_file():
            continue
        campaign = folder / "campaign" / path.stem
        found = diagnose_blind(campaign, out / "diagnoses" / path.stem, PATIENCE_S)
        answer.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        print(f"  {path.stem}: {describe_answer(found['verdict'])}", flush=True)


def describe_answer(verdict: dict) -> str:
    """Decision, and ids with their probabilities."""
    effects = (f"{e['id']} {e['probability']:.3g}" for e in verdict["effects"])
    groups = ("/".join(group) for group in verdict["equivalent"])
    return "; ".join([verdict["decision"], *effects, *groups])


def list_rows(folder: Path, out: Path) -> Iterator[list[str]]:
    """List truth, both answers and their judgement."""
    for path in sorted(out.glob("*.json")):
        truth = json.loads((folder / "truth" / path.name).read_text())
        answers = [
            json.loads((place / path.name).read_text()) for place in (folder / "answer", out)
        ]
        ids = [f"{e['id']} {e['gain_nats']:.0f}" for e in truth["effects"]]
        right = ["right" if judge(a["verdict"], truth).right else "wrong" for a in answers]
        case = truth["case"]
        setting = f"{case['protocol']}, {case['trials']} trials, {case['noise']}"
        yield [
            path.stem,
            setting,
            " + ".join(ids) or "clean",
            *(describe_answer(a["verdict"]) for a in answers),
            *right,
        ]


def main(folder: Path) -> None:
    """Diagnose, and print the table as CSV with tabs."""
    answer_all(folder, OUT / folder.name)
    rows = list(list_rows(folder, OUT / folder.name))
    print("\t".join(["campaign", "setting", "true", "before", "after", "was", "is"]))
    for row in rows:
        print("\t".join(row))
    for place, name in ((5, "before"), (6, "after")):
        print(f"{name}: {sum(row[place] == 'right' for row in rows)} of {len(rows)} right")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
