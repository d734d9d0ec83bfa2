"""The verdict in words.

What is probable is so among the effects of the catalogue, and the words name how many those are.
"""

from collections.abc import Callable, Mapping
from typing import Any

from softfinger.report.formatting import (
    count_things,
    fix,
    format_percent,
    join_words,
)
from softfinger.report.material import Material

Verdict = Mapping[str, Any]
NOT_RUN = (
    "The mismatch diagnosis was not run: this report shows whether the model departs from the "
    "recordings, but not which physics was left out."
)
IN_A_WORD = {
    "adequate": "none seen",
    "named": "found",
    "ambiguous": "found, ambiguous",
    "unlisted": "found, not explained",
}
NEARLY_SURE = 0.999


def state_verdict(material: Material) -> str:
    """State what the diagnosis found, in one sentence."""
    verdict = material.artifacts["verdict"]
    return STATED[verdict["decision"]](material, verdict)


def _state_adequate(material: Material, verdict: Verdict) -> str:
    power = state_power(material, verdict)
    return f"Nothing is missing that these recordings could show{power and f': {power}'}."


def _state_named(material: Material, verdict: Verdict) -> str:
    names = name_effects(verdict)
    least = min(effect["probability"] for effect in verdict["effects"])
    among = len(list_catalogue(material))
    given = f" among {among} effects" if among else ""
    left = state_left(verdict)
    return (
        f"The base model leaves out {join_words(names)} (probability "
        f"{format_probability(least)}{given}){left and f'; with {it(names)}, {left}'}."
    )


def _state_ambiguous(material: Material, verdict: Verdict) -> str:
    del material
    sets = [name for names in verdict["equivalent"] for name in names]
    unclear = {part for name in sets for part in name.split("+")}
    sure = [spell(e["id"]) for e in verdict["effects"] if e["id"] not in unclear]
    lead = f"{join_words(sure)} and more" if sure else "Physics"
    verb = "are" if sure else "is"
    return (
        f"{lead[:1].upper()}{lead[1:]} {verb} missing, but these recordings cannot tell "
        f"{join_words([spell(name) for name in sets])} apart."
    )


def _state_unlisted(material: Material, verdict: Verdict) -> str:
    del material
    names, rest = name_effects(verdict), verdict.get("remaining")
    left = state_left(verdict) if rest and rest["rms_over_noise"] > 1.0 else ""
    if names:
        after = left and f"; with {it(names)}, {left}"
        return f"Something is missing, of which {join_words(names)} is only a part{after}."
    return f"Something is missing, and no listed effect explains it{left and f': {left}'}."


STATED: dict[str, Callable[[Material, Verdict], str]] = {
    "adequate": _state_adequate,
    "named": _state_named,
    "ambiguous": _state_ambiguous,
    "unlisted": _state_unlisted,
}


def it(names: list[str]) -> str:
    """The pronoun of one thing or several."""
    return "it" if len(names) == 1 else "them"


def name_effects(verdict: Verdict) -> list[str]:
    """Name the effects of a verdict."""
    return [spell(effect["id"]) for effect in verdict["effects"]]


def state_left(verdict: Verdict) -> str:
    """State how large the residuals are that remain."""
    left = verdict.get("remaining")
    size = fix(left["rms_over_noise"], 2) if left else ""
    return size and f"what remains is {size} times what the measurement allows"


def state_explained(verdict: Verdict) -> list[str]:
    """State what the best listed set explains, where that is not all."""
    explained = verdict.get("explained")
    if verdict["decision"] != "unlisted" or not explained:
        return []
    best = explained[0]
    names, share = join_words([spell(n) for n in best["effects"]]), format_percent(best["share"])
    zero = ", but none of its sizes is clearly off zero" if best["amplitudes_cover_zero"] else ""
    turned = [
        f"But its {spell(name)} falls and rises again, which is none: rest or the direction of "
        "motion may be what changes the joint."
        for name in best.get("turned_back", [])
    ]
    return [
        f"The best listed set, {names}, explains {share} of the missing evidence{zero}.",
        *turned,
    ]


def spell(effect: object) -> str:
    """Write an effect's id as words.

    >>> spell("wire_friction"), spell("gravity+actuator_lag")
    ('wire friction', 'gravity with actuator lag')
    """
    return str(effect).replace("_", " ").replace("+", " with ")


def format_probability(value: float) -> str:
    """Write a probability, never as certainty.

    >>> format_probability(0.9999), format_probability(0.973)
    ('above 99.9 %', '97 %')
    """
    return "above 99.9 %" if value > NEARLY_SURE else format_percent(value)


def list_catalogue(material: Material) -> list[str]:
    """List the effects of the catalogue."""
    found = material.find("evidence")
    kinds = ("effect", "unfitted_effect", "refused_effect")
    return [] if found is None else [str(name) for kind in kinds for name in found[kind].values]


def state_power(material: Material, verdict: Verdict) -> str:
    """State how many effects could have shown here."""
    catalogue, found = list_catalogue(material), material.find("evidence")
    if found is None:
        return ""
    blind = {*found["refused_effect"].values.tolist(), *verdict["not_testable"]}
    seen = len({*catalogue} - blind)
    return f"{seen} of {count_things(len(catalogue), 'effect')} could have been seen"


def describe_next(verdict: Verdict) -> list[str]:
    """State what to record next, if anything."""
    proposal = verdict.get("next_experiment")
    if not proposal:
        return []
    statement = str(proposal["statement"])
    for name in proposal["expected_gain_nats"]:
        statement = statement.replace(name, spell(name))
    if not proposal["loads"]:
        return [statement]
    return [f"{statement} Its load logs lie in the folder next_experiment beside this report."]
