"""The page of the proof.

It shows what was concealed, what was answered, and the score.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from softfinger.figures.concealed import (
    draw_buried_case,
    draw_confusion,
    draw_reliability,
    draw_right_by_evidence,
)
from softfinger.report.blocks import (
    Cell,
    Listing,
    Paragraph,
    Picture,
    Section,
    Table,
    Tile,
    number,
    text,
)
from softfinger.report.concealed_figures import FIGURES, STATISTICS
from softfinger.report.concealed_protocols import build_conditions, build_protocols
from softfinger.report.formatting import fix, format_number, format_percent
from softfinger.report.page import render_page


@dataclass(frozen=True)
class Proof:
    """What the page is written from.

    Attributes
    ----------
    score
        Of the diagnosis, as from `softfinger.concealed.score`; ``chance`` among its attributes is
        the share of right names when answers are dealt out at random.
    rivals
        Name of a rival → its score on the same campaigns, or on some of them.
    cases
        Rows of the table: of every campaign what was concealed, answered and spent.
    seals
        Rows (campaign, digest of the truth with its salt, digest of the answer).
    measured
        Rows of the real recordings, or one sentence why there are none.
    buried
        Name, sentence and mean residual of one buried case, if one was named.
    """

    seed: int
    score: xr.Dataset
    rivals: Mapping[str, xr.Dataset]
    cases: Sequence[Mapping[str, Any]]
    seals: Sequence[tuple[str, str, str]]
    measured: Sequence[Mapping[str, Any]] | str
    buried: tuple[str, str, xr.Dataset] | None


def render_proof(proof: Proof) -> str:
    """The page of the proof as self-contained HTML."""
    build = (_tell_question, _tell_score, _tell_buried, _tell_cases, _tell_measured, _tell_seals)
    return render_page(
        title=f"The proof, seed {proof.seed}: {len(proof.cases)} concealed campaigns",
        kind="Soft finger proof",
        ask="Does the diagnosis find physics that was concealed from it, and only that?",
        source="synthetic",
        tiles=_judge(proof),
        sections=[section for part in build for section in part(proof)],
    )


def _judge(proof: Proof) -> list[Tile]:
    tiles = []
    for name in ("named", "false_alarm", "unlisted", "set_contains_truth"):
        meaning, goal, more = STATISTICS[name]
        share, count = _pick(proof.score, name)
        passed = None if not count else bool(share >= goal if more else share <= goal)
        answer = format_percent(share) if count else "not measured"
        detail = f"of {count}; the goal is {'≥' if more else '≤'} {format_percent(goal)}"
        tiles.append(Tile(meaning, answer, passed, detail, "score"))
    return tiles


def _pick(score: xr.Dataset, name: str) -> tuple[float, int]:
    row = score.sel(statistic=name)
    return float(row["share"]), int(row["share_count"])


def _tell_question(proof: Proof) -> list[Section]:
    clean = sum(row["truth"] == "clean" for row in proof.cases)
    outside = sum("not in the catalogue" in row["truth"] for row in proof.cases)
    return [
        Section(
            "question",
            "What was done",
            (
                Paragraph(
                    f"{len(proof.cases)} campaigns were made by a generator with an integrator, "
                    "physical forms and random draws of its own: "
                    f"{clean} clean, {outside} with physics that the catalogue does not hold, the "
                    "rest with one or two of its effects, in another form than the one that is "
                    "fitted. Each truth was sealed before its diagnosis began; the diagnosis ran "
                    "in a process that got a copy of the campaign folder and nothing else; its "
                    "answer was hashed before the seals were opened."
                ),
                Paragraph(
                    "How strong an effect is, the oracle measures: the evidence that the true "
                    "physics in its true form gains over the base model, each trial's own "
                    "parameters integrated over the population. No tool can do better. From 15 "
                    "nats on an effect counts as visible. A crash counts as wrong."
                ),
                Paragraph(
                    "Visible is not nameable: a recording that starts late and a tension that "
                    "lags may do the same to the angles. So the oracle also fits, in the place of "
                    "what was concealed, the effects of the catalogue that come closest, in the "
                    "forms that the generator gives them, to the same campaign free of noise. It "
                    "could name an effect to which it would give a probability of 0.95; and where "
                    "that effect is from outside the catalogue, nothing in the catalogue comes as "
                    "close."
                ),
            ),
        )
    ]


def _tell_score(proof: Proof) -> list[Section]:
    score = proof.score
    pictures = (
        Picture(
            "right",
            "Right answers against the oracle's evidence",
            draw_right_by_evidence(score),
            "Share of right answers rising with the oracle's evidence, beside the oracle's limit.",
            "Campaigns with one or two effects of the catalogue. The limit: the probability that "
            "the oracle itself gives the truth against the base model and what comes closest in "
            "the catalogue (below 15 nats, and where it was not asked: against the base model). "
            "95 % Clopper–Pearson intervals; rule score.",
        ),
        Picture(
            "confusion",
            "What was concealed and what was answered",
            draw_confusion(score),
            "Matrix of counts, truths as rows and answers as columns.",
            "Counts; every campaign, also those in which nothing can be seen. Rule score.",
        ),
        Picture(
            "reliability",
            "Stated probabilities and what was true",
            draw_reliability(score),
            "Share of stated effects that were there, by stated probability, beside the diagonal.",
            "Every effect in every verdict; numbers beside the points are counts. 95 % "
            "Clopper–Pearson intervals; rule score.",
        ),
    )
    lines = Listing(_tell_remarks(score))
    tables = _build_shares(proof), build_protocols(proof.cases), build_conditions(proof.cases)
    return [Section("score", "The score", (*tables, lines, *pictures))]


def _tell_remarks(score: xr.Dataset) -> tuple[str, ...]:
    gap, chance = score.attrs["gap_closed_median"], score.attrs["chance"]
    lines = []
    if np.isfinite(gap):
        lines.append(
            "Of the elpd gap between the base model and the oracle's, the repaired model closes "
            f"{format_percent(gap)} (median over visible listed campaigns)."
        )
    figures = score.attrs["measurement"] | score.attrs["laws"]
    lines += [f"{say}: {format_percent(figures[k])}." for k, say in FIGURES.items() if k in figures]
    if np.isfinite(chance):
        lines.append(
            "Labels shuffled: dealt out at random among the campaigns with a visible effect, the "
            f"same answers name {format_percent(chance)} right."
        )
    lines.append(
        f"A diagnosis took {format_number(score.attrs['seconds_median'])} s (median; at most "
        f"{format_number(score.attrs['seconds_most'])} s), "
        f"{format_number(score.attrs['cpu_seconds_median'])} s of CPU."
    )
    return tuple(lines)


def _build_shares(proof: Proof) -> Table:
    rows = []
    for name, (meaning, goal, more) in STATISTICS.items():
        row = proof.score.sel(statistic=name)
        aim = "" if goal is None else f"{'≥' if more else '≤'} {format_percent(goal)}"
        bounds = [format_percent(float(row[f"share_{end}"])) for end in ("lower", "upper")]
        count = int(row["share_count"])
        rows.append(
            (
                text(meaning),
                _share(proof.score, name),
                text("–".join(bounds) if count else "not measured"),
                number(f"{count}", count),
                text(aim),
                *(_share(rival, name) for rival in proof.rivals.values()),
            )
        )
    asked = {rival.sizes["case"] for rival in proof.rivals.values()}
    whose = "the same" if asked == {len(proof.cases)} else f"{max(asked, default=0)} of the"
    return Table(
        "shares",
        "The score",
        "Shares with 95 % Clopper–Pearson intervals; rule score"
        + (f". Beside it two ways that one would otherwise write, on {whose} campaigns: the best "
           "frame-wise leave-one-out score with white noise, and BIC on per-trial least squares."
           if proof.rivals else "."),
        ("what", "share", "interval", "of", "goal", *proof.rivals),
        tuple(rows),
    )  # fmt: skip


def _share(score: xr.Dataset, name: str) -> Cell:
    share, count = _pick(score, name)
    rare = 0.0 < share < 0.01  # one of hundreds must not read as none
    return number(format_percent(share, 1 if rare else 0), share) if count else text("–")


def _tell_buried(proof: Proof) -> list[Section]:
    if proof.buried is None:
        words = "No visible effect whose residual is at the noise was named in this sample."
        return [Section("buried", "One buried case", (Paragraph(words, "note"),))]
    name, sentence, residual = proof.buried
    picture = Picture(
        "buried",
        f"Campaign {name} before and after",
        draw_buried_case(residual),
        "Mean residuals over time by joint, under the base model and under the repaired model.",
        f"Means over {int(residual['trials'])} trials in units of their own sd under noise alone; "
        "the band is ± 2. Rule diagnose, artifact repair.",
    )
    return [Section("buried", "One buried case", (Paragraph(sentence), picture))]


COLUMNS = {
    "truth": "concealed", "oracle_nats": "oracle [nats]", "right": "right",
    "contains": "in the set", "stand_in": "comes closest [nats]", "answer": "answered",
    "campaign": "campaign", "condition": "nuisance", "protocol": "protocol", "trials": "trials",
    "noise": "noise",
    "cpu_seconds": "CPU [s]", "seconds": "wall [s]", "reason": "reason",
}  # fmt: skip


def _tell_cases(proof: Proof) -> list[Section]:
    rows = sorted(proof.cases, key=lambda row: (row["truth"], -row["oracle_nats"]))
    return [Section("cases", "Campaign by campaign", (_build_rows("cases", rows, "synthetic"),))]


def _tell_measured(proof: Proof) -> list[Section]:
    if isinstance(proof.measured, str):
        blocks = (Paragraph(proof.measured, "note"),)
    else:
        blocks = (_build_rows("measured", proof.measured, "measured"),)
    return [Section("measured", "Real recordings", blocks)]


def _build_rows(name: str, rows: Sequence[Mapping[str, Any]], source: str) -> Table:
    used = {
        key: head for key, head in COLUMNS.items() if any(row.get(key, "") != "" for row in rows)
    }
    return Table(
        name,
        f"Every campaign ({source})",
        "What was concealed or is known, what the diagnosis answered, and what it took; rules "
        "conceal, diagnose_blind and score.",
        tuple(used.values()),
        tuple(tuple(_cell(row.get(key, "")) for key in used) for row in rows),
    )


def _cell(value: object) -> Cell:
    if isinstance(value, bool):
        return text("yes" if value else "no")
    if isinstance(value, int | float):
        return number(fix(value, 0) if abs(value) >= 100 else format_number(value), value)
    return text(value)


def _tell_seals(proof: Proof) -> list[Section]:
    table = Table(
        "seals",
        "Digests",
        "SHA-256 of the truth's file followed by its salt, written before the diagnosis; SHA-256 "
        "of the answer's file, written before the seal was opened. Rule score opens both and stops "
        "where one does not fit.",
        ("campaign", "truth and salt", "answer"),
        tuple(tuple(text(word) for word in row) for row in proof.seals),
        folded=True,
    )
    words = "To check a seal: SHA-256 of truth/CAMPAIGN.json followed by the salt's digits."
    return [Section("seals", "Seals", (Paragraph(words), table))]
