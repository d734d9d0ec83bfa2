"""The proof's table: one row per campaign."""

from collections.abc import Mapping, Sequence

from softfinger.concealed.judge import judge
from softfinger.concealed.measurement import describe_condition, is_alarm


def tabulate_cases(
    names: Sequence[str],
    truths: Sequence[dict],
    answers: Sequence[dict],
    limits: Sequence[dict],
) -> list[dict]:
    """Rows of plain words, in the suite's order."""
    rows = zip(names, truths, answers, limits, strict=True)
    return [_tabulate(name, truth, answer, weighed) for name, truth, answer, weighed in rows]


def _tabulate(name: str, truth: Mapping, answer: Mapping, weighed: Mapping) -> dict:
    case, verdict = truth["case"], answer["verdict"]
    judged = judge(verdict, truth)
    gains = ", ".join(f"{e['gain_nats']:.0f}" for e in truth["effects"])
    return {
        "campaign": name,
        "truth": describe_truth(truth),
        "kind": judged.truth.replace("_", " "),
        "visible": judged.visible,
        "protocol": case["protocol"].replace("_", " "),
        "trials": case["trials"],
        "condition": describe_condition(truth),
        "alarm": is_alarm(verdict) if not truth["effects"] else "",
        "noise": "filmed" if case["filmed"] else case["noise"].replace("_", " "),
        "oracle_nats": round(truth["gain_nats"], 1),
        "nats_of_each": gains if len(truth["effects"]) > 1 else "",
        "stand_in": describe_stand_in(weighed),
        "masked": judged.masked,
        "answer": describe_answer(verdict),
        "reason": answer["reason"] or "",
        "right": judged.right,
        "contains": judged.contains,
        "seconds": answer["seconds"],
        "cpu_seconds": answer["cpu_seconds"],
    }


def tabulate_measured(name: str, known: str, answer: Mapping) -> dict:
    """Row of a real recording.

    It is right if exactly what is known is named, or so decided.
    """
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
        e.get("name", e["id"])
        + (f" (joint {', '.join(map(str, e['joints']))})" if len(e["joints"]) == 1 else "")
        for e in truth["effects"]
    ]
    outside = any(not e["listed"] for e in truth["effects"])
    return (" + ".join(names) or "clean") + (" [not in the catalogue]" if outside else "")


def describe_stand_in(weighed: Mapping[str, Mapping[str, float]]) -> str:
    """Name the closest stand-in of each effect.

    Its number is how many nats it is behind.

    >>> describe_stand_in({"camera_delay": {"inertia": 17.0, "actuator_lag": 0.6}})
    'actuator_lag 0.6'
    """
    closest = [
        min(others.items(), key=lambda pair: pair[1]) for others in weighed.values() if others
    ]
    return ", ".join(f"{name} {nats:.{1 if abs(nats) < 10 else 0}f}" for name, nats in closest)


def describe_answer(verdict: Mapping) -> str:
    """Decision, names, and equivalents of a verdict.

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
