"""The proof's table: one row per campaign, with what was concealed and what was answered."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from softfinger.concealed.judge import judge


def tabulate_cases(
    names: Sequence[str], truths: Sequence[dict], answers: Sequence[dict]
) -> list[dict]:
    """Rows of plain words and numbers, in the order of the suite's names."""
    return [
        _tabulate(name, truth, answer)
        for name, truth, answer in zip(names, truths, answers, strict=True)
    ]


def _tabulate(name: str, truth: Mapping, answer: Mapping) -> dict:
    case, verdict = truth["case"], answer["verdict"]
    judged = judge(verdict, truth)
    gains = ", ".join(f"{e['gain_nats']:.0f}" for e in truth["effects"])
    return {
        "campaign": name,
        "truth": describe_truth(truth),
        "protocol": case["protocol"].replace("_", " "),
        "trials": case["trials"],
        "noise": "filmed" if case["filmed"] else case["noise"].replace("_", " "),
        "oracle_nats": round(truth["gain_nats"], 1),
        "nats_of_each": gains if len(truth["effects"]) > 1 else "",
        "masked": judged.masked,
        "answer": describe_answer(verdict),
        "reason": answer["reason"] or "",
        "right": judged.right,
        "contains": judged.contains,
        "seconds": answer["seconds"],
        "cpu_seconds": answer["cpu_seconds"],
    }


def tabulate_measured(name: str, known: str, answer: Mapping) -> dict:
    """Row of a real recording: right if exactly what is known is named, or so decided."""
    verdict = answer["verdict"]
    ids = {effect["id"] for effect in verdict["effects"]}
    expected = set(known.split(" + "))
    return {
        "campaign": name,
        "truth": f"{known} (known)",
        "answer": describe_answer(verdict),
        "reason": answer["reason"] or "",
        "right": verdict["decision"] == known
        or (verdict["decision"] == "named" and ids == expected),
        "seconds": answer["seconds"],
        "cpu_seconds": answer["cpu_seconds"],
    }


def describe_truth(truth: Mapping) -> str:
    """Name what was concealed, with its joints."""
    names = [
        e["id"] + (f" (joint {', '.join(map(str, e['joints']))})" if len(e["joints"]) == 1 else "")
        for e in truth["effects"]
    ]
    outside = any(not e["listed"] for e in truth["effects"])
    return (" + ".join(names) or "clean") + (" [not in the catalogue]" if outside else "")


def describe_answer(verdict: Mapping) -> str:
    """Give the decision, the names, and what was called equivalent.

    >>> describe_answer({"decision": "adequate", "effects": [], "equivalent": []})
    'adequate'
    """
    names = " + ".join(
        e["id"] + (f" (joint {e['joints'][0]})" if len(e["joints"]) == 1 else "")
        for e in verdict["effects"]
    )
    sets = "; ".join(" or ".join(group) for group in verdict["equivalent"])
    words = verdict["decision"]
    if verdict["decision"] != "ambiguous" and names:
        words += f": {names}"
    return f"{words}: {sets}" if sets else words
