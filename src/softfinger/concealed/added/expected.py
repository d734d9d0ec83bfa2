"""Judge verdicts on recordings whose truth is an expert's."""

from collections.abc import Mapping, Sequence

CONFIDENT = ("named", "adequate")
DECISIONS = ("adequate", "named", "ambiguous", "unlisted")


def accepts(accepted: Sequence[str], verdict: Mapping) -> bool:
    """Whether a fair expert could have given this verdict.

    Parameters
    ----------
    accepted
        Answers as ``expected.yaml`` has them: ``decision[:effects that must be in the set or in
        the explained part]``, or bare effects, which must be named, exactly these.

    >>> said = {"decision": "named", "effects": [{"id": "inertia"}], "equivalent": []}
    >>> accepts(["unlisted", "inertia"], said), accepts(["actuator_lag+inertia"], said)
    (True, False)
    """
    return any(_fits(answer, verdict) for answer in accepted)


def _fits(answer: str, verdict: Mapping) -> bool:
    word, _, rest = answer.partition(":")
    if word not in DECISIONS:
        named = {effect["id"] for effect in verdict["effects"]}
        return verdict["decision"] == "named" and named == set(word.split("+"))
    wanted = set(rest.split("+")) - {""}
    return verdict["decision"] == word and wanted <= claims(verdict)


def claims(verdict: Mapping) -> set[str]:
    """Ids that a verdict has anywhere in its answer.

    They are the effects that it states, those in the sets that it cannot tell apart, and, under
    ``unlisted``, the best set among what is explained.
    """
    found = {effect["id"] for effect in verdict["effects"]}
    for group in verdict["equivalent"]:
        for member in group:
            found |= set(member.split("+")) - {"none"}
    explained = verdict.get("explained") or []
    if verdict["decision"] == "unlisted" and explained:
        found |= set(explained[0]["effects"])
    return found


def is_confident(verdict: Mapping) -> bool:
    """Whether a verdict leaves no doubt."""
    return verdict["decision"] in CONFIDENT
