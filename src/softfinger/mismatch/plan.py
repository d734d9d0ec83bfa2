"""Which experiment would show it: masking tables of protocols before, and proposals after, data."""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.mismatch.columns import collect_columns
from softfinger.mismatch.masking import tabulate_masking
from softfinger.mismatch.problem import Problem
from softfinger.mismatch.rank import Candidate, list_pieces
from softfinger.mismatch.setting import build_setting
from softfinger.mismatch.trials import prepare_trials
from softfinger.population.mixed_effects_laplace import Fit
from softfinger.population.simulate import build_recording

DESIGN_TRIALS = 12


class Protocol(NamedTuple):
    """Load histories that trials go through in turn: knots (history, knot) [s], [N m]."""

    load_time: NDArray[np.float64]
    load_torque: NDArray[np.float64]


def list_protocols(largest: float, duration: float) -> dict[str, Protocol]:
    """Protocols within a rig's limits: largest load [N m] and length of a trial [s].

    >>> list(list_protocols(0.04, 40.0))
    ['step', 'levels', 'staircase', 'triangle']
    """
    whole = np.array([[0.0, duration]])
    levels = largest * np.array([0.4, 0.6, 0.8, 1.0])
    release = 0.6 * duration
    stairs = largest * np.array([0.35, 0.7, 1.0, 0.6, 0.3, 0.9])
    edges = np.repeat(np.linspace(0.0, duration, len(stairs) + 1), 2)[1:-1]
    corners = np.linspace(0.0, duration, 5)
    return {
        "step": Protocol(whole, np.full((1, 2), largest)),
        "levels": Protocol(
            np.tile([0.0, release, release, duration], (4, 1)),
            np.stack([[level, level, 0.0, 0.0] for level in levels]),
        ),
        "staircase": Protocol(edges[None], np.repeat(stairs, 2)[None]),
        "triangle": Protocol(corners[None], largest * np.array([[0.0, 1.0, 0.0, 1.0, 0.0]])),
    }


def build_design(
    problem: Problem, base: Candidate, protocol: Protocol, trials: int = DESIGN_TRIALS
) -> tuple[Problem, Candidate]:
    """Build a campaign without data: the base model's motion under another protocol.

    The finger, the noise, the frame interval and the population are those of `problem`.
    """
    history = np.arange(trials) % len(protocol.load_time)
    duration = protocol.load_time.max()
    time = np.arange(0.0, duration, problem.trials.interval)
    names = [f"planned_{i + 1}" for i in range(trials)]
    joints = problem.trials.joints
    knots = protocol.load_time[history], protocol.load_torque[history]
    angles = build_recording(time, *knots, joints, names)
    own = np.tile(base.fit.mean, (trials, 1))
    angles = angles.assign(
        joint_angle=(angles["joint_angle"].dims, np.zeros((trials, joints, len(time))))
    )
    planned, _ = prepare_trials(angles, problem.noise)
    design = replace(problem, trials=planned, repaired=None)
    setting = _describe(design, problem, own, angles)
    design = replace(design, setting=setting)
    angle, _ = design.simulate(design.base, own, np.zeros(0))
    planned = planned._replace(
        angle=angle.reshape(trials, joints, -1, 2).mean(3).transpose(0, 2, 1)
    )
    design = replace(design, trials=planned)
    gram = design.linearise(design.base, own, np.zeros(0))
    empty = np.zeros((0, 0))
    fit = Fit(
        own, np.zeros((trials, 1, 1)), base.fit.mean, base.fit.mean_covariance, np.zeros(0), empty,
        base.fit.omega, 0.0, gram, True,
    )  # fmt: skip
    return design, Candidate(design.base, fit, 0.0)


def _describe(design: Problem, problem: Problem, own: NDArray, angles: xr.Dataset) -> Any:  # noqa: ANN401
    trials = len(design.trials.name)
    plain = angles.assign(
        started_at=("trial", np.full(trials, np.nan)),
        joint_length=np.nan,
        wire_offset=np.nan,
        **{f"link_{k}": ("joint", np.full(design.trials.joints, np.nan))
           for k in ("length", "mass", "centre")},
    )  # fmt: skip
    known = problem.setting
    described = build_setting(plain, design.trials, own)
    return replace(
        described,
        tension=known.tension,
        geometry=known.geometry,
        masses=known.masses,
        load_known=known.load_known,
        reach=known.reach,
    )


def plan_experiment(
    problem: Problem, base: Candidate, protocols: dict[str, Protocol]
) -> dict[str, xr.Dataset]:
    """Masking table of every protocol: what each could show of each effect."""
    tables = {}
    for name, protocol in protocols.items():
        design, start = build_design(problem, base, protocol)
        pieces, _ = list_pieces(design.setting)
        tables[name] = tabulate_masking(collect_columns(design, start, pieces), design, start)
    return tables


def propose_experiment(
    tables: dict[str, xr.Dataset], protocols: dict[str, Protocol], wanted: list[str]
) -> dict[str, Any] | None:
    """Choose the protocol that separates the wanted effects best.

    Separation is the expected gain [nats] of the least visible of them, after what looks like the
    others has been taken out of it.
    """
    best = None
    for name, table in tables.items():
        known = [effect for effect in wanted if effect in table["effect"].values]
        if not known:
            continue
        part = table.sel(effect=known, other_effect=known)
        size = np.sqrt(2.0 * np.maximum(part["expected_gain"].values, 0.0))
        likeness = np.abs(part["likeness"].values - np.eye(len(known)))
        alone = size**2 * (1.0 - likeness.max(axis=1) ** 2)
        gain = float(0.5 * (alone - np.log1p(alone)).min()) * (len(known) == len(wanted))
        if best is None or gain > best["expected_gain_nats"]:
            best = {"protocol": name, "expected_gain_nats": gain, "effects": known}
    if best is None:
        return None
    protocol = protocols[best["protocol"]]
    histories = zip(protocol.load_time, protocol.load_torque, strict=True)
    best["load"] = [
        {"time_s": time.tolist(), "torque_nm": torque.tolist()} for time, torque in histories
    ]
    return best
