"""What unkind measurement costs: evidence in first frames, and coverage of intervals.

Effects that act in the first milliseconds after a step resemble gross errors. Their evidence is
measured twice in the same campaign of the proof's generator, without and with 1 to 2 % outliers,
each time on the frames that count beside the effect itself.

The coverage is that of 90 % intervals of μ and σ, for clean campaigns of every condition. A
campaign is diagnosed, and fitted with the model file that the diagnosis writes.
"""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from softfinger.artifacts import open_artifact, open_tree
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.specs import posterior as posterior_spec
from softfinger.concealed.blind import diagnose_blind
from softfinger.concealed.generate import generate_campaign
from softfinger.concealed.nuisances import NUISANCES
from softfinger.concealed.suite import CaseSpec
from softfinger.config import read_config
from softfinger.inference.problem import Candidate, Problem, pose_problem
from softfinger.mismatch.candidates.columns import collect_columns
from softfinger.mismatch.candidates.rank import list_pieces, rank_pieces
from softfinger.mismatch.search.judge import measure_again
from softfinger.stages.fit import fit
from softfinger.stages.keys import choose_settings
from softfinger.stages.prepare import prepare_angles

FIRST_FRAMES = ("camera_delay", "actuator_lag", "inertia")
EACH = 4  # campaigns of an effect
COVERED = 3  # clean campaigns of a condition: 72 intervals
TRIALS, DURATION_S, PLACE = 12, 20.0, 0.75
PATIENCE_S = 3600.0


def measure_long() -> dict[str, float]:
    """Evidence that outliers leave, and the coverage farthest from 90 %."""
    kept = {name: float(np.mean([compare(name, k) for k in range(EACH)])) for name in FIRST_FRAMES}
    print(f"  evidence kept: {kept}", flush=True)
    covered = {name: cover(name) for name in NUISANCES}
    print(f"  coverage: {covered}", flush=True)
    return {
        "first_frames_evidence_kept": min(kept.values()),
        "condition_coverage_90_worst": max(covered.values(), key=lambda share: abs(share - 0.9)),
        "condition_coverage_90": float(np.mean(list(covered.values()))),
    }


def compare(effect: str, number: int) -> float:
    """Evidence with outliers over that without."""
    spec = draw_spec(number, effects=(effect,))
    with tempfile.TemporaryDirectory() as name:
        kind, strengths = weigh_effect(spec, Path(name) / "kind")
        spec = replace(spec, nuisances=("outliers",), strengths=strengths)
        unkind, _ = weigh_effect(spec, Path(name) / "unkind")
    print(f"  {effect} {number}: {kind:.1f} nats, {unkind:.1f} with outliers", flush=True)
    return unkind / kind


def draw_spec(
    number: int, effects: tuple[str, ...] = (), nuisances: tuple[str, ...] = ()
) -> CaseSpec:
    """A short campaign under a staircase with white noise."""
    return CaseSpec(
        seed=4_000 + number,
        effects=effects,
        joints=((),) * len(effects),
        quantiles=(PLACE,) * len(effects),
        protocol="staircase",
        trials=TRIALS,
        noise="white",
        nuisances=nuisances,
        duration_s=DURATION_S,
    )


def weigh_effect(spec: CaseSpec, place: Path) -> tuple[float, tuple[float, ...]]:
    """Evidence [nats] for a campaign's own effect, and its strength."""
    truth = generate_campaign(spec, place / "campaign", place / "truth.json")
    recorded = prepare_angles(place / "campaign", place, read_config())
    angles = open_artifact(recorded, angles_spec.SPEC)
    problem, fitted = pose_problem(angles)
    base = Candidate(problem.base, fitted, fitted.log_evidence)
    pieces = [one for one in list_pieces(problem.setting)[0] if one.effect.id == spec.effects[0]]
    columns = collect_columns(problem, base, pieces)
    best = rank_pieces(problem, base, columns, lambda items, _: items)[0][0]
    again = measure_again(problem, best, angles)
    gain = fit_again(again, best) - fit_again(again, base)
    return gain, tuple(effect["strength"] for effect in truth["effects"])


def fit_again(problem: Problem, candidate: Candidate) -> float:
    """Log evidence [nats] of a model on these frames."""
    known = candidate.fit
    return problem.fit(candidate.model, (known.own, known.shared, known.omega)).log_evidence


def cover(condition: str) -> float:
    """Share of 90 % intervals that contain the truth, under one condition."""
    inside = [contain(draw_spec(k, nuisances=(condition,))) for k in range(COVERED)]
    print(f"  {condition}: {np.mean(inside):.3f} of {np.size(inside)} intervals", flush=True)
    return float(np.mean(inside))


def contain(spec: CaseSpec) -> NDArray[np.bool_]:
    """Whether each interval contains the truth: μ and σ, parameter, joint."""
    with tempfile.TemporaryDirectory() as name:
        place, config = Path(name), read_config()
        truth = generate_campaign(spec, place / "campaign", place / "truth.json")["population"]
        diagnose_blind(place / "campaign", place / "out", PATIENCE_S)
        fit(
            angles=place / "out/angles.nc",
            posterior=place / "posterior.nc",
            model=place / "out/model.yaml",
            config=choose_settings(config, "fit"),
            cores=config["estimation"]["cores"],
            seed=1,
        )
        draws = open_tree(place / "posterior.nc", posterior_spec.SPEC)["posterior"].to_dataset()
        found = []
        for level, true in (("mu", truth["mean"]), ("sigma", truth["sd"])):
            names = [f"{level}_{name}" for name in ("log_k_v", "log_c_v", "log_c_p", "q_ini")]
            drawn = np.stack([draws[name].transpose("chain", "draw", "joint") for name in names], 2)
            rank = (drawn < np.array(true)).mean(axis=(0, 1))
            found.append(np.abs(rank - 0.5) < 0.45)
    return np.array(found)
