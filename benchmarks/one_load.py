"""Creep in time and a thinning damper, told apart or not, under one load and under several.

The proof's generator draws them. Under one load a law of rate has any course in time that creep
has, so creep must not be named a thinning damper there.
"""

from __future__ import annotations

import itertools
import json
import tempfile
from pathlib import Path

from softfinger.concealed.blind import diagnose_blind
from softfinger.concealed.generate import generate_campaign
from softfinger.concealed.protocols import Protocol
from softfinger.concealed.suite import CaseSpec

CREEP = (
    "fractional_creep",
    "second_retardation",
    "fractional_creep/logarithmic",
    "fractional_creep/two_powers",
    "second_retardation/log_normal",
)
THINNING = ("thinning_damper", "thinning_damper/carreau", "thinning_damper/cross")
ONE_LOAD, SEVERAL = ("single_step",), ("levels", "staircase")
PATIENCE_S = 1800.0


def measure_long() -> dict[str, float]:
    """Shares of creep misnamed under one load, and of thinning dampers named under several."""
    creep = [diagnose_one(spec) for spec in draw_specs(31, CREEP, ONE_LOAD, (1, 10))]
    thin = [diagnose_one(spec) for spec in draw_specs(32, THINNING, SEVERAL, (10,))]
    return {
        "creep_confidently_misnamed_share": share(map(is_wrong, creep)),
        "creep_in_answer_share": share(map(holds_truth, creep)),
        "thinning_named_share": share(map(is_right, thin)),
    }


def share(found: map[bool]) -> float:
    """Share of what is true."""
    each = list(found)
    return sum(each) / len(each)


def draw_specs(
    seed: int, names: tuple[str, ...], protocols: tuple[Protocol, ...], trials: tuple[int, ...]
) -> list[CaseSpec]:
    """Campaigns to draw: one effect of one joint each, plainly visible."""
    return [
        CaseSpec(
            seed=seed * 1000 + number,
            effects=(name,),
            joints=((0,),),
            quantiles=(0.9,),
            protocol=protocol,
            trials=count,
            noise="white",
            catalogue="second",
        )
        for number, (name, protocol, count) in enumerate(
            itertools.product(names, protocols, trials)
        )
    ]


def diagnose_one(spec: CaseSpec) -> tuple[str, dict]:
    """Draw a campaign and diagnose it: the true id and the verdict."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        truth = generate_campaign(spec, folder / "campaign", folder / "truth.json")
        found = diagnose_blind(folder / "campaign", folder / "diagnosis", PATIENCE_S)
    verdict, nats = found["verdict"], truth["effects"][0]["gain_nats"]
    print(
        f"  {spec.effects[0]}, {spec.protocol}, {spec.trials} trials, {nats:.0f} nats: "
        f"{describe(verdict)}, {found['cpu_seconds']:.0f} s",
        flush=True,
    )
    return spec.effects[0].split("/")[0], verdict


def describe(verdict: dict) -> str:
    """An answer in one line."""
    effects = ", ".join(f"{e['id']} {e['probability']:.3f}" for e in verdict["effects"])
    sets = json.dumps(verdict["equivalent"])
    return f"{verdict['decision']} [{effects}] {sets if verdict['decision'] == 'ambiguous' else ''}"


def is_wrong(answer: tuple[str, dict]) -> bool:
    """Whether something else is named."""
    return answer[1]["decision"] == "named" and not is_right(answer)


def is_right(answer: tuple[str, dict]) -> bool:
    """Whether the truth alone is named."""
    truth, verdict = answer
    return verdict["decision"] == "named" and [e["id"] for e in verdict["effects"]] == [truth]


def holds_truth(answer: tuple[str, dict]) -> bool:
    """Whether the truth is named, in a set that is as likely, or part of what is unlisted."""
    truth, verdict = answer
    sets = [*verdict["equivalent"], [e["id"] for e in verdict["effects"]]]
    return any(truth in ids for ids in sets)
