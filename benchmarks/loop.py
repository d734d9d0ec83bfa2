"""Concealed effects in the loop: python -m benchmarks.loop.

Planned by ours and by four others.

Round 0 is a plain campaign of 20 trials. Then at most two rounds of 10 trials are planned,
recorded by a process that alone knows the truth, joined with what there is, and diagnosed, until
the answer is sure. Each round is a folder; what is there is not done again.
"""

from __future__ import annotations

import argparse
import json
import shlex
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.__main__ import RESULTS, merge_figures
from softfinger.artifacts.verdict import read_verdict
from softfinger.cli.join import write_joined
from softfinger.concealed.blind import diagnose_blind
from softfinger.concealed.effects import CATALOGUES
from softfinger.concealed.generate import write_recordings
from softfinger.concealed.protocols import PROTOCOLS
from softfinger.concealed.setting import draw_setting
from softfinger.concealed.strength import expect_effect_gain
from softfinger.concealed.suite import CaseSpec, draw_joints, take_turns
from softfinger.provenance import PROJECT, derive_seed
from softfinger.stages.loop import is_settled, record
from softfinger.stages.next import Asked, next_experiment

OUT = PROJECT / "results/loop"
VISIBLE_NATS = 15.0
TRIALS, ROUNDS, FIRST = 10, 2, 20
PATIENCE_S = 1800.0
DURATION_S, REST_S = 40.0, 30.0

Planner = Callable[[Path, Path, Path, int], None]
"""Writes a plan: (results of the round before, round 0's campaign, plan.yaml, round)."""


def draw_cases(seed: int, n: int) -> list[CaseSpec]:
    """Draw plain campaigns with one effect of the catalogue each, in turn."""
    rng = np.random.default_rng([seed, n, 7])
    effects = take_turns(CATALOGUES["second"], n, rng)
    protocols = take_turns(("single_step", "levels"), n, rng)
    noises = take_turns(("white", "ar_0.9", "gappy", "heavy_tailed"), n, rng)
    return [
        CaseSpec(
            seed=int(rng.integers(2**63)),
            effects=(effect,),
            joints=(draw_joints(effect, rng),),
            quantiles=(float(rng.uniform(0.5, 1.0)),),
            protocol=protocol,
            trials=FIRST,
            noise=noise,
        )
        for effect, protocol, noise in zip(effects, protocols, noises, strict=True)
    ]


def find_visible(spec: CaseSpec, strength: float) -> float:
    """Evidence [nats] to expect under the best plain protocol."""
    others = (replace(spec, protocol=protocol) for protocol in PROTOCOLS)
    return max(expect_effect_gain(spec.effects[0], strength, draw_setting(s)) for s in others)


def plan_ours(results: Path, campaign: Path, plan: Path, number: int) -> None:
    """Plan by what tells the open models apart."""
    _plan(results, campaign, plan, number, ())


def plan_d_optimal(results: Path, campaign: Path, plan: Path, number: int) -> None:
    """Plan by what narrows the base model's parameters most.

    It is the mean fall of their log sds.
    """
    _plan(results, campaign, plan, number, ("k_v", "c_v", "c_p", "q_ini"))


def _plan(results: Path, campaign: Path, plan: Path, number: int, narrow: tuple[str, ...]) -> None:
    asked = Asked(trials=TRIALS, narrow=narrow)
    next_experiment(
        results=results, plan=plan, asked=asked, rig=None, campaign=campaign, seed=number
    )


def plan_again(results: Path, campaign: Path, plan: Path, number: int) -> None:
    """The protocol of round 0 again."""
    logs = sorted((campaign / "load").glob("*.csv"))[:TRIALS]
    rows = [np.loadtxt(log, delimiter=",", skiprows=1, ndmin=2).T for log in logs]
    _write_loads(plan, rows)


def plan_staircase(results: Path, campaign: Path, plan: Path, number: int) -> None:
    """A fixed protocol: levels up and down."""
    share = np.array([0.35, 0.75, 0.5, 1.0, 0.6, 0.25])
    orders = (share, share[[1, 0, 3, 2, 5, 4]], share[[0, 2, 1, 4, 3, 5]])
    peak = find_peak(campaign)
    _write_loads(plan, [_hold(1.0 + 6.5 * np.arange(6), peak * order) for order in orders])


def plan_random(results: Path, campaign: Path, plan: Path, number: int) -> None:
    """Random levels at random times."""
    rng = np.random.default_rng(derive_seed(number, campaign.parent.name))  # of each case
    peak, loads = find_peak(campaign), []
    for _ in range(TRIALS):
        when = np.cumsum(rng.exponential(4.0, 20))
        when = when[when < DURATION_S - 1.0]
        loads.append(_hold(when, peak * rng.uniform(0.0, 1.0, when.size)))
    _write_loads(plan, loads)


PLANNERS: dict[str, Planner] = {
    "ours": plan_ours,
    "again": plan_again,
    "staircase": plan_staircase,
    "random": plan_random,
    "d_optimal": plan_d_optimal,
}


def find_peak(campaign: Path) -> float:
    """Largest load [N] of a campaign's logs."""
    logs = (campaign / "load").glob("*.csv")
    return max(np.loadtxt(log, delimiter=",", skiprows=1, ndmin=2)[:, 1].max() for log in logs)


def _hold(when: np.ndarray, level: np.ndarray) -> np.ndarray:
    before = np.concatenate([[0.0], level[:-1]])
    time = np.append(0.0, np.repeat(when, 2))
    return np.stack([time, np.append(0.0, np.column_stack([before, level]).ravel())])


def _write_loads(plan: Path, loads: list[np.ndarray]) -> None:
    """Write a plan of the rig, as long as the others."""
    drawn = [loads[k % len(loads)].tolist() for k in range(TRIALS)]
    profiles = [{"time_s": _end(time), "tension_n": _end(load)} for time, load in drawn]
    for profile in profiles:
        profile["time_s"][-1] = DURATION_S
    content = {"profiles": profiles, "recording": {"repeats": 1, "rest_s": REST_S}}
    plan.write_text(json.dumps(content), encoding="utf-8")  # JSON is YAML


def _end(values: list[float]) -> list[float]:
    """Hold the last value."""
    return [*values, values[-1]]


def run_case(spec: CaseSpec, planners: list[str], out: Path) -> None:
    """Run one concealed campaign in the loop, by each planner."""
    truth, campaign = out / "truth.json", out / "campaign"
    if not truth.is_file():
        doses = write_recordings(spec, campaign).doses
        strengths = {name: dose.strength for name, dose in doses.items()}
        seen = find_visible(spec, strengths[spec.effects[0]])
        effects = [{"name": name, "strength": strength} for name, strength in strengths.items()]
        told = {"case": spec.to_json(), "effects": effects, "visible_nats": seen}
        truth.write_text(json.dumps(told), encoding="utf-8")
    if json.loads(truth.read_text())["visible_nats"] < VISIBLE_NATS:
        return
    first = _diagnose(campaign, out / "round_0")
    for name in planners:
        sources, results = [campaign], first
        for number in range(1, ROUNDS + 1):
            if is_settled(read_verdict(results / "verdict.json")):
                break
            here = out / name / f"round_{number}"
            sources, results = _run_round(PLANNERS[name], truth, here, sources, results, number)


def _run_round(
    planner: Planner, truth: Path, here: Path, sources: list[Path], results: Path, number: int
) -> tuple[list[Path], Path]:
    """Plan, record, join and diagnose once."""
    here.mkdir(parents=True, exist_ok=True)
    plan, recordings = here / "plan.yaml", here / "recordings"
    if not plan.is_file():
        begin = time.monotonic()
        planner(results, sources[0], plan, number)
        (here / "seconds.txt").write_text(f"{time.monotonic() - begin:.2f}\n")
    if not (recordings / "trials.csv").is_file():
        answer = shlex.join([sys.executable, "-m", "softfinger.concealed.answer", str(truth)])
        record(f"{answer} {{plan}} {{out}} {{round}}", plan, recordings, number)
    sources = [*sources, recordings]
    if not (here / "joined/campaign.yaml").is_file():
        write_joined(sources, here / "joined", None)
    return sources, _diagnose(here / "joined", here / "results")


def _diagnose(campaign: Path, results: Path) -> Path:
    if not (results / "verdict.json").is_file():
        diagnose_blind(campaign, results, PATIENCE_S)
    return results


def tell_case(out: Path, planner: str) -> dict[str, Any] | None:
    """How one case ended by one planner."""
    sealed = json.loads((out / "truth.json").read_text(encoding="utf-8"))
    if sealed["visible_nats"] < VISIBLE_NATS or not (out / "round_0/verdict.json").is_file():
        return None
    true = set(sealed["case"]["effects"])
    rounds = [out / "round_0", *sorted((out / planner).glob("round_*/results"))]
    verdicts = [read_verdict(one / "verdict.json") for one in rounds]
    if not is_settled(verdicts[-1]) and len(verdicts) <= ROUNDS:
        return None  # it has not ended yet
    last = verdicts[-1]
    named = {effect.id for effect in last.effects}
    foreseen = []
    for before, verdict in zip(rounds[1:], verdicts[1:], strict=True):
        said = before.parent / "plan.json"
        asked = json.loads(said.read_text(encoding="utf-8")) if said.is_file() else {}
        if asked.get("probability_sure") is not None:
            foreseen.append((asked["probability_sure"], verdict.decision == "named"))
    seconds = [float(one.read_text()) for one in (out / planner).glob("round_*/seconds.txt")]
    return {
        "effects": sorted(true), "protocol": sealed["case"]["protocol"],
        "rounds": [f"{v.decision} {'+'.join(e.id for e in v.effects)}" for v in verdicts],
        "named": last.decision == "named" and named == true,
        "false": last.decision == "named" and named != true,
        "sure": last.decision == "named",
        "trials": TRIALS * (len(verdicts) - 1),
        "foreseen": foreseen, "plan_seconds": seconds,
    }  # fmt: skip


def summarise(out: Path, planners: list[str]) -> dict[str, float]:
    """Figures of all cases that have ended by every planner."""
    cases = sorted(place.parent for place in out.glob("case_*/truth.json"))
    told = {name: [tell_case(case, name) for case in cases] for name in planners}
    ended = [k for k in range(len(cases)) if all(told[name][k] for name in planners)]
    figures: dict[str, float] = {"loop_cases": len(ended)}
    if not ended:
        return figures
    for name in planners:
        found = [told[name][k] for k in ended]
        suffix = "" if name == "ours" else f"_{name}"
        figures[f"loop_named_share{suffix}"] = float(np.mean([one["named"] for one in found]))
        figures[f"loop_false_share{suffix}"] = float(np.mean([one["false"] for one in found]))
        figures[f"loop_trials{suffix}"] = float(np.mean([_count(one) for one in found]))
    figures |= _calibrate([one for k in ended for one in told["ours"][k]["foreseen"]])
    seconds = [s for k in ended for s in told["ours"][k]["plan_seconds"]]
    if seconds:
        figures["loop_plan_seconds_most"] = max(seconds)
    for name in planners[1:]:
        more = [_count(told[name][k]) - _count(told["ours"][k]) for k in ended]
        low, high = _bound_mean(np.array(more, float))
        figures |= {f"loop_more_trials_{name}_low": low, f"loop_more_trials_{name}_high": high}
    for k in ended:
        lines = (f"{name}: {' → '.join(told[name][k]['rounds'])}" for name in planners)
        print(f"{cases[k].name} {told['ours'][k]['effects']}", *lines, sep="\n  ", flush=True)
    return figures


def _count(one: dict[str, Any]) -> int:
    """Trials to a sure answer.

    They are of one round more than allowed where there was none.
    """
    return one["trials"] if one["sure"] else TRIALS * (ROUNDS + 1)


def _calibrate(foreseen: list[tuple[float, bool]]) -> dict[str, float]:
    """Brier score of the foreseen probabilities, and that of their mean."""
    if not foreseen:
        return {}
    stated, came = np.array(foreseen, float).T
    return {
        "loop_brier": float(np.mean((stated - came) ** 2)),
        "loop_brier_of_the_mean": float(np.mean((came.mean() - came) ** 2)),
        "loop_plans": len(foreseen),
    }


def _bound_mean(values: np.ndarray) -> tuple[float, float]:
    """90 % interval of a mean, by bootstrap."""
    rng = np.random.default_rng(9)
    means = rng.choice(values, (2000, values.size)).mean(axis=1)
    low, high = np.quantile(means, (0.05, 0.95))
    return float(low), float(high)


def list_waiting(options: argparse.Namespace) -> Iterator[tuple[CaseSpec, Path]]:
    """Cases of this process: every `of`-th from `part`."""
    for k, spec in enumerate(draw_cases(options.seed, options.cases)):
        if k % options.of == options.part:
            yield spec, options.out / f"seed_{options.seed}/case_{k:03d}"


def main() -> None:
    """Run what has not ended, and write the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=OUT)
    parser.add_argument("--planners", nargs="+", default=list(PLANNERS), choices=PLANNERS)
    parser.add_argument("--part", type=int, default=0, help="number of this process")
    parser.add_argument("--of", type=int, default=1, help="processes")
    options = parser.parse_args()
    planners = list(dict.fromkeys(["ours", *options.planners]))  # others are compared with it
    for spec, place in list_waiting(options):
        place.mkdir(parents=True, exist_ok=True)
        run_case(spec, planners, place)
    figures = summarise(options.out / f"seed_{options.seed}", planners)
    for key, value in figures.items():
        print(f"  {key}: {value:.6g}")
    merge_figures(figures, without=("loop_",))
    print(f"the figures are in {RESULTS}")


if __name__ == "__main__":
    main()
