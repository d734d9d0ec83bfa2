"""Which experiment would show an effect."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.mixed_effects_laplace import Fit
from softfinger.inference.problem import Problem
from softfinger.inference.setting import build_setting
from softfinger.inference.simulate import build_recording
from softfinger.measurement.planned import assume_noise
from softfinger.measurement.trials import prepare_trials
from softfinger.mismatch.candidates.columns import collect_columns
from softfinger.mismatch.candidates.rank import Candidate, list_pieces
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.experiment.masking import tabulate_masking


class PlannedProtocol(NamedTuple):
    """Load knots (history, knot) [s], [N m], in turn."""

    load_time: NDArray[np.float64]
    load_torque: NDArray[np.float64]


def list_protocols(largest: float, duration: float) -> dict[str, PlannedProtocol]:
    """Protocols within a rig's limits.

    They are the largest load [N m] and the length of a trial [s].

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
        "step": PlannedProtocol(whole, np.full((1, 2), largest)),
        "levels": PlannedProtocol(
            np.tile([0.0, release, release, duration], (4, 1)),
            np.stack([[level, level, 0.0, 0.0] for level in levels]),
        ),
        "staircase": PlannedProtocol(edges[None], np.repeat(stairs, 2)[None]),
        "triangle": PlannedProtocol(corners[None], largest * np.array([[0.0, 1.0, 0.0, 1.0, 0.0]])),
    }


def build_design(
    problem: Problem,
    base: Candidate,
    protocol: PlannedProtocol,
    trials: int = DECISIONS.design_trials,
) -> tuple[Problem, Candidate]:
    """Build a campaign without data.

    It has the base model's motion under another protocol.

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
    planned = prepare_trials(angles, assume_noise(angles, problem.noise))
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
    problem: Problem, base: Candidate, protocols: dict[str, PlannedProtocol]
) -> dict[str, xr.Dataset]:
    """Table of what each protocol could show."""
    tables = {}
    for name, protocol in protocols.items():
        design, start = build_design(problem, base, protocol)
        pieces, _ = list_pieces(design.setting)
        tables[name] = tabulate_masking(collect_columns(design, start, pieces), design, start)
    return tables


def measure_separation(table: xr.Dataset, wanted: Sequence[str]) -> xr.DataArray:
    """Expected gain [nats] of each wanted effect.

    What looks like one of the others has been taken out of it; 0 where the protocol cannot have it.

    Examples
    --------
    Half of what friction shows looks like gravity:

    >>> names = ["wire_friction", "gravity"]
    >>> table = xr.Dataset(
    ...     {"expected_gain": ("effect", [50.0, 2.0]),
    ...      "likeness": (("effect", "other_effect"), [[1.0, 0.5**0.5], [0.5**0.5, 1.0]])},
    ...     coords={"effect": names, "other_effect": names})
    >>> measure_separation(table, ["wire_friction", "yield_threshold"]).round(1).values
    array([47.7,  0. ])
    >>> measure_separation(table, names).round(1).values
    array([23. ,  0.5])
    """
    known = [name for name in wanted if name in table["effect"].values]
    part = table.sel(effect=known, other_effect=known)
    size = 2.0 * np.maximum(part["expected_gain"].values, 0.0)
    likeness = np.abs(part["likeness"].values - np.eye(len(known)))
    alone = size * (1.0 - likeness.max(axis=1, initial=0.0) ** 2)
    gain = dict(zip(known, 0.5 * (alone - np.log1p(alone)), strict=True))
    return xr.DataArray([gain.get(n, 0.0) for n in wanted], {"effect": list(wanted)}, "effect")


def choose_protocol(
    tables: Mapping[str, xr.Dataset], wanted: Sequence[str], needed: float
) -> tuple[str, xr.DataArray] | None:
    """Choose the protocol that shows most wanted effects.

    Parameters
    ----------
    tables
        Of `plan_experiment`.
    needed
        Gain [nats] from which on an effect is seen.

    Returns
    -------
    name, gain (effect) [nats]
        None where no protocol would show any of them.
    """
    gains = {name: measure_separation(table, wanted) for name, table in tables.items()}

    def judge(name: str) -> tuple[int, float]:
        seen = gains[name].values[gains[name].values >= needed]
        return len(seen), float(seen.min(initial=np.inf)) if len(seen) else 0.0

    best = max(gains, key=judge, default=None)
    return None if best is None or judge(best)[0] == 0 else (best, gains[best])
