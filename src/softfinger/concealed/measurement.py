"""What unkind recordings do to the answers."""

from collections.abc import Mapping, Sequence

import numpy as np

from softfinger.concealed.judge import VISIBLE_NATS, judge

Case = tuple[Mapping, Mapping]  # verdict, truth


def describe_condition(truth: Mapping) -> str:
    """Name the nuisance that acts; ``none`` or ``several``.

    >>> describe_condition({"faults": [{"id": "hum"}]}), describe_condition({})
    ('hum', 'none')
    """
    names = [fault["id"] for fault in truth.get("faults", ())]
    return names[0] if len(names) == 1 else "several" if names else "none"


def is_alarm(verdict: Mapping) -> bool:
    """Whether an answer claims missing physics.

    An ambiguous one does not, where the base model is among what it leaves possible.

    >>> is_alarm({"decision": "ambiguous", "equivalent": [["none", "gravity"]]})
    False
    """
    if verdict["decision"] == "ambiguous":
        return not any("none" in group for group in verdict["equivalent"])
    return verdict["decision"] != "adequate"


def list_alarms(cases: Sequence[Case]) -> list[tuple[str, bool]]:
    """Condition and alarm of each clean campaign."""
    return [(describe_condition(t), is_alarm(v)) for v, t in cases if not t["effects"]]


def pair_twins(cases: Sequence[Case]) -> list[tuple[bool, bool]]:
    """Right answers without and with nuisances, by pair.

    Only pairs whose effect is visible in both count.
    """
    kind: dict[int, Case] = {}
    unkind: dict[int, Case] = {}
    for verdict, truth in cases:
        if "nuisances" in truth["case"]:
            side = unkind if truth["case"]["nuisances"] else kind
            side[truth["case"]["seed"]] = verdict, truth
    pairs = []
    for seed in kind.keys() & unkind.keys():
        judged = [judge(*side[seed]) for side in (kind, unkind)]
        if all(j.visible and j.truth not in ("clean", "outside") for j in judged):
            pairs.append((judged[0].right, judged[1].right))
    return pairs


def check_findings(cases: Sequence[Case]) -> tuple[list[bool], list[bool]]:
    """Whether faults were found, and findings are false.

    Only verdicts that have findings at all take part. A finding is false where neither a nuisance
    nor the kind of noise gives rise to it.
    """
    found, false = [], []
    for verdict, truth in cases:
        if "measurement" not in verdict:
            continue
        stated = {finding["id"] for finding in verdict["measurement"]}
        faults = truth.get("faults", ())
        found += [
            fault["finding"] in stated
            for fault in faults
            if fault["finding"] and (fault["nats"] or 0.0) >= VISIBLE_NATS
        ]
        allowed = set(truth.get("noise", {}).get("findings", ()))
        allowed |= {name for f in faults for name in (f["finding"], *f["also"])}
        false += [name not in allowed for name in sorted(stated)]
    return found, false


def collect_measurement(cases: Sequence[Case]) -> dict[str, float]:
    """Keys of ``results/benchmarks.json`` about the measurement.

    A key is absent where it was not measured.

    Alarms are given where there is more than one condition.
    """
    figures: dict[str, float] = {}
    alarms = list_alarms(cases)
    groups: dict[str, list[bool]] = {}
    for condition, alarm in alarms:
        groups.setdefault(condition, []).append(alarm)
    if len(groups) > 1:
        worst = max(np.mean(group) for group in groups.values())
        figures["clean_campaigns"] = len(alarms)
        figures["clean_conditions"] = len(groups)
        figures["clean_false_alarm_share"] = np.mean([alarm for _, alarm in alarms])
        figures["clean_false_alarm_share_worst_condition"] = worst
    if pairs := pair_twins(cases):
        without, with_nuisances = np.mean(pairs, axis=0)
        figures["nuisance_named_share_loss"] = without - with_nuisances
    found, false = check_findings(cases)
    figures |= {"measurement_named_share": np.mean(found)} if found else {}
    figures |= {"measurement_false_share": np.mean(false)} if false else {}
    return {key: float(value) for key, value in figures.items()}
