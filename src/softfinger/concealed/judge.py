"""One verdict against one truth."""

from dataclasses import dataclass
from itertools import product

import numpy as np

VISIBLE_NATS = 15.0
SIGNIFICANT = 0.05
COVARIATE_NAMES = {
    "trial": "trial_number",
    "trial_number": "trial_number",
    "temperature_c": "temperature_c",
}
# Effect parameters that mean the same in every form of the effect.
SAME_IN_EVERY_FORM = frozenset({"arm_scale", "inertia_scale", "tilt_rad", "delay_s", "lag_s"})


@dataclass(frozen=True)
class Judgement:
    """What one campaign's verdict got right.

    Attributes
    ----------
    truth, answer
        Labels for the confusion matrix.
    gain
        The oracle's evidence [nats].
    visible
        The oracle gains at least 15 nats.
    masked
        Visible, although the base model's residual is at the noise.
    right
        A clean campaign called adequate; every listed effect that is visible named and nothing that
        is not there; an effect from outside the catalogue called unlisted.
    contains
        The truth is what was named, or one of the sets called equivalent.
    confident
        Something was named.
    joints, level, window, covariate
        Location right; None where it does not apply.
    covered
        Whether each effect parameter lies in its stated 90 % interval, by key.
    stated
        (probability, whether true) of each effect in the verdict.
    gap_closed
        Share of the oracle's elpd difference; None where it does not apply.
    """

    truth: str
    answer: str
    gain: float
    visible: bool
    masked: bool
    right: bool
    contains: bool
    confident: bool
    joints: bool | None
    level: bool | None
    window: bool | None
    covariate: bool | None
    covered: dict[str, bool]
    stated: list[tuple[float, bool]]
    gap_closed: float | None


def judge(verdict: dict, truth: dict) -> Judgement:
    """Judge ``verdict.json`` by its truth file."""
    effects = truth["effects"]
    listed = {e["id"] for e in effects if e["listed"]}
    outside = any(not e["listed"] for e in effects)
    required = {e["id"] for e in effects if e["listed"] and e["gain_nats"] >= VISIBLE_NATS}
    named = {e["id"] for e in verdict["effects"]}
    decision = verdict["decision"]
    visible = bool(effects) and truth["gain_nats"] >= VISIBLE_NATS

    def fits(answer: set[str]) -> bool:
        return required <= answer <= listed and bool(answer or not visible)

    if not effects:
        right = decision == "adequate"
    elif outside:
        right = decision == "unlisted"
    else:
        right = decision == "named" and fits(named)
    shared = {e["id"]: e for e in verdict["effects"] if e["id"] in listed}
    return Judgement(
        truth=_label_truth(effects),
        answer=_label_answer(decision, named),
        gain=truth["gain_nats"],
        visible=visible,
        masked=visible and not outside and _at_noise(truth),
        right=right,
        contains=any(fits(answer) for answer in _list_answers(verdict)) and not outside,
        confident=decision == "named",
        covered=_check_parameters(shared, effects) if right else {},
        stated=[(float(e["probability"]), e["id"] in listed) for e in verdict["effects"]],
        gap_closed=_close_gap(verdict, truth) if visible and not outside else None,
        **_check_location(verdict, truth, right=right and visible),
    )


def _label_truth(effects: list[dict]) -> str:
    if not effects:
        return "clean"
    if not all(e["listed"] for e in effects):
        return "outside"
    return effects[0]["id"] if len(effects) == 1 else "two effects"


def _label_answer(decision: str, named: set[str]) -> str:
    if decision != "named":
        return decision
    return next(iter(named)) if len(named) == 1 else "two effects"


def _at_noise(truth: dict) -> bool:
    """Whether the base's residual is at the noise."""
    excess = truth["misfit"]["base"] - truth["misfit"]["true"]
    return excess < 3.0 * np.sqrt(2.0 / truth["values"])


def _list_answers(verdict: dict) -> list[set[str]]:
    """Sets of effects that the verdict leaves possible.

    A member ``none`` leaves the base model possible.
    """
    groups = [
        [set(member.split("+")) - {"none"} for member in group] for group in verdict["equivalent"]
    ]
    open_ids = set().union(*(member for group in groups for member in group))
    named = {e["id"] for e in verdict["effects"]}
    if verdict["decision"] == "adequate":
        return [set()]
    answers = [named] if verdict["decision"] == "named" else []
    if groups:
        sure = named - open_ids
        answers += [sure.union(*choice) for choice in product(*groups)]
    return answers


def _check_parameters(shared: dict[str, dict], effects: list[dict]) -> dict[str, bool]:
    covered = {}
    for effect in effects:
        stated = shared.get(effect["id"], {}).get("parameters", {})
        for key, value in effect["parameters"].items():
            if key in stated:
                covered[key] = bool(stated[key]["q05"] <= value <= stated[key]["q95"])
    return covered


def _close_gap(verdict: dict, truth: dict) -> float | None:
    gap, elpd = truth["elpd_difference"], verdict.get("elpd")
    if gap is None or gap <= 0.0 or not elpd or elpd["difference"] is None:
        return None
    return float(elpd["difference"] / gap)


def _check_location(verdict: dict, truth: dict, *, right: bool) -> dict[str, bool | None]:
    """Check the strongest effect's location, if right."""
    unknown = {"joints": None, "level": None, "window": None, "covariate": None}
    location = verdict.get("location")
    if not right or not location or not truth["effects"]:
        return unknown
    strongest = max(truth["effects"], key=lambda e: e["gain_nats"])
    stated = next((e for e in verdict["effects"] if e["id"] == strongest["id"]), None)
    joints = len(truth["population"]["mean"][0])
    if stated is not None:
        location = stated.get("location") or location
        found = set(stated["joints"])
    else:
        found = {int(j) for j, p in location["joints"].items() if p < SIGNIFICANT}
    everywhere = set(range(1, joints + 1))
    window, times = truth["window_s"], location["times_s"]
    return {
        "joints": (found or everywhere) == (set(strongest["joints"]) or everywhere),
        "level": location["level"] == strongest["level"],
        "window": _overlap(window, times) if times and window else None,
        "covariate": COVARIATE_NAMES.get(location["covariate"]) == strongest["covariate"]
        if strongest["covariate"]
        else None,
    }


def _overlap(window: list[float], other: list[float]) -> bool:
    """Whether half the shorter window is shared."""
    shared = min(window[1], other[1]) - max(window[0], other[0])
    return shared >= 0.5 * min(window[1] - window[0], other[1] - other[0])
