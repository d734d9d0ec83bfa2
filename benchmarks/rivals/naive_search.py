"""Two ways to name left-out physics that one would otherwise write: least squares, then a score.

They are the best of their kind: nobody ships a tool for the task, and this is what a careful
colleague would write in a week, with our compiled forward model, its derivatives and start values.

Every effect of the catalogue, alone, on all joints, in its own form, is fitted to the frames of a
few trials by least squares: each trial with parameters of its own, which no population holds
together, under white noise. Then either the frame-wise leave-one-out score decides (an effect is
named if it gains more than two standard errors), or the Bayesian information criterion (BIC).

    python -m benchmarks.rivals.naive_search ANGLES.nc ANSWER.json
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.artifacts import open_artifact
from softfinger.artifacts.specs.angles import SPEC
from softfinger.concealed.blind import CRASHED
from softfinger.faults import Fault
from softfinger.inference.problem import Problem, pose_problem
from softfinger.mechanics.effects.model import EffectModel
from softfinger.mechanics.forward.simulate import simulate_joint_angle_array
from softfinger.mechanics.forward.slots import SlotArrays
from softfinger.mismatch.candidates.rank import list_pieces

Array = NDArray[np.float64]
MOST_TRIALS = 5  # a campaign's first and last and some between: a fit must not take hours
STEPS = 12  # of Levenberg and Marquardt
ENOUGH = 1e-4  # relative fall of the squares at which a fit rests
SURE_SE = 2.0  # standard errors by which the score must rise


class LeastSquares(NamedTuple):
    """A fit: residual (row,), leverage of each row, and how many numbers were fitted."""

    residual: Array
    leverage: Array
    size: int

    @property
    def bic(self) -> float:
        """−2 log likelihood at the best variance, plus log n for every number."""
        n = self.residual.size
        return n * np.log(np.mean(self.residual**2)) + self.size * np.log(n)

    @property
    def left_out(self) -> Array:
        """Log density (row,) of each value given all the others, linearised."""
        n = self.residual.size
        variance = np.sum(self.residual**2) / (n - self.size) / (1.0 - self.leverage)
        error = self.residual / (1.0 - self.leverage)
        return -0.5 * (np.log(2.0 * np.pi * variance) + error**2 / variance)


def answer(angles: xr.Dataset) -> dict[str, dict]:
    """What the two rivals say of a campaign, in the words of a verdict."""
    names = angles["trial"].values
    places = np.linspace(0, names.size - 1, min(names.size, MOST_TRIALS))
    few = np.unique(places.round().astype(int))
    problem, fit = pose_problem(angles.isel(trial=few))
    chosen = angles.sel(trial=problem.trials.name)
    base = fit_squares(problem, problem.base, fit.own, chosen)
    if base is None:
        return {name: _say(None) for name in ("loo", "bic")}
    found: dict[str, LeastSquares] = {}
    for piece in list_pieces(problem.setting)[0]:
        if piece.places and len(piece.places) == 1 < problem.trials.joints:
            continue  # on all joints, or on the chain
        model = problem.base.extend(piece)
        tried = fit_squares(problem, model, fit.own, chosen)
        rival = found.get(piece.effect.id)
        if tried is not None and (rival is None or tried.bic < rival.bic):
            found[piece.effect.id] = tried
    by_score = max(found, key=lambda e: found[e].left_out.sum(), default=None)
    by_bic = min(found, key=lambda e: found[e].bic, default=None)
    if by_score is not None:
        gain = found[by_score].left_out - base.left_out
        if gain.sum() <= SURE_SE * np.sqrt(gain.size) * gain.std():
            by_score = None
    if by_bic is not None and found[by_bic].bic >= base.bic:
        by_bic = None
    return {"loo": _say(by_score), "bic": _say(by_bic)}


def _say(effect: str | None) -> dict:
    effects = [] if effect is None else [{"id": effect, "joints": [], "parameters": {}}]
    for said in effects:
        said["probability"] = 1.0
    return {
        "decision": "named" if effects else "adequate",
        "effects": effects,
        "equivalent": [],
        "location": None,
        "elpd": None,
    }


def fit_squares(
    problem: Problem, model: EffectModel, own: Array, angles: xr.Dataset
) -> LeastSquares | None:
    """Fit η of every trial and φ to the frames; None where no motion can be computed."""
    shared = np.clip(model.shared_prior[0], model.low, model.high)
    for number in range(len(model.pieces)):
        start = model.place_start(number, model.list_starts(number)[0])
        shared[[k for k, e in enumerate(model.entries) if e.piece == number]] = start
    damping, now = 1e-3, _look(problem, model, own, shared, angles)
    if now is None:
        return None
    for _ in range(STEPS):
        step_own, step_shared = _solve(*now, own.shape[1], damping)
        there = own + np.clip(step_own, -1.0, 1.0)
        shared_there = np.clip(shared + step_shared, model.low, model.high)
        tried = _look(problem, model, there, shared_there, angles)
        before = sum(r @ r for r in now[0])
        after = np.inf if tried is None else sum(r @ r for r in tried[0])
        if after < before:
            own, shared, now, damping = there, shared_there, tried, 0.2 * damping
            if after > (1.0 - ENOUGH) * before:
                break
        else:
            damping *= 10.0
    return LeastSquares(
        np.concatenate(now[0]), _leverage(*now, own.shape[1]), own.size + shared.size
    )


Rows = list[Array]


def _look(
    problem: Problem, model: EffectModel, own: Array, shared: Array, angles: xr.Dataset
) -> tuple[Rows, Rows] | None:
    """Residuals (row,) and slopes (row, own + shared) of every trial, where it was seen."""
    trials = problem.trials
    time = angles["time"].transpose("trial", "frame").values
    forward = np.maximum.accumulate(np.where(np.isfinite(time), time, -np.inf), axis=1)
    try:
        angle, slope = simulate_joint_angle_array(
            own.reshape(len(own), trials.joints, -1),
            SlotArrays(*model.fill_slots(shared)),
            model.fill_tangents(shared),
            problem.finger,
            np.where(np.isfinite(time), forward, np.nan),
            trials.load_time,
            trials.load_torque,
            tolerance=1e-5,
        )
    except (ArithmeticError, Fault):
        return None
    seen = angles["joint_angle"].transpose("trial", "joint", "frame").values
    flag = angles["angle_flag"].transpose("trial", "joint", "frame").values
    residual, slopes = [], []
    for k in range(len(own)):
        there = np.isfinite(seen[k]) & (flag[k] == 0) & np.isfinite(time[k])
        residual.append((seen[k] - angle[k])[there])
        slopes.append(slope[k][there])
    whole = all(np.isfinite(r).all() for r in residual) and all(
        np.isfinite(s).all() for s in slopes
    )
    return (residual, slopes) if whole else None


def _blocks(residual: Rows, slopes: Rows, d: int, damping: float) -> tuple[Array, ...]:
    """Normal equations with each trial's own part eliminated: (C⁻¹B, C⁻¹g, Schur, its force)."""
    gram = np.stack([s.T @ s for s in slopes])
    force = np.stack([s.T @ r for s, r in zip(slopes, residual, strict=True)])
    scale = np.einsum("tii->ti", gram) * damping + 1e-12
    gram = gram + np.einsum("ti,ij->tij", scale, np.eye(gram.shape[1]))
    inner = np.linalg.pinv(gram[:, :d, :d], hermitian=True)
    cross = inner @ gram[:, :d, d:]
    pull = np.einsum("tij,tj->ti", inner, force[:, :d])
    schur = (gram[:, d:, d:] - gram[:, d:, :d] @ cross).sum(0)
    rest = (force[:, d:] - np.einsum("tij,tj->ti", gram[:, d:, :d], pull)).sum(0)
    return inner, cross, pull, schur, rest


def _solve(residual: Rows, slopes: Rows, d: int, damping: float) -> tuple[Array, Array]:
    _, cross, pull, schur, rest = _blocks(residual, slopes, d, damping)
    shared = np.linalg.lstsq(schur, rest, rcond=None)[0]
    return pull - cross @ shared, shared


def _leverage(residual: Rows, slopes: Rows, d: int) -> Array:
    inner, cross, _, schur, _ = _blocks(residual, slopes, d, 0.0)
    outer = np.linalg.pinv(schur, hermitian=True)
    parts = []
    for k, slope in enumerate(slopes):
        left = slope[:, d:] - slope[:, :d] @ cross[k]
        own = np.einsum("ni,ij,nj->n", slope[:, :d], inner[k], slope[:, :d])
        parts.append(own + np.einsum("ni,ij,nj->n", left, outer, left))
    return np.clip(np.concatenate(parts), 0.0, 0.999)


if __name__ == "__main__":
    try:
        said = answer(open_artifact(Path(sys.argv[1]), SPEC))
    except Fault as fault:  # nothing to fit: they have no answer either
        print(fault, file=sys.stderr)
        said = dict.fromkeys(("loo", "bic"), CRASHED)
    Path(sys.argv[2]).write_text(json.dumps(said, indent=1, sort_keys=True) + "\n")
