"""Real trials in the units of the paper's finger.

The proof's effects have sizes that suit that finger. So time, motion and load of a campaign are
measured in units in which its longest trial takes 30 s, and in which the motion of its median trial
reaches 0.5 rad under 0.05 N m. Angles count from the median trial's rest.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.optimize import least_squares

from softfinger.campaign import read_campaign
from softfinger.campaign.folder import Campaign
from softfinger.campaign.load_log import read_load
from softfinger.campaign.recordings import read_angle_table
from softfinger.campaign.trials import Trial
from softfinger.concealed.added.ladder import Ladder, fit_ladder
from softfinger.concealed.arrays import Array
from softfinger.concealed.effects import Circumstances
from softfinger.concealed.forward import compute_plain_angles
from softfinger.concealed.protocols import Load
from softfinger.concealed.rig import Rig

LONGEST_S, LARGEST_RAD, LARGEST_N = 30.0, 0.5, 10.0
RIG = Rig(
    link_length=np.array([0.075]),
    link_mass=np.array([0.005]),
    wire_offset=0.005,
    joint_length=0.008,
    base_marker=np.array([-0.018, -0.006]),
    link_marker=np.array([0.006, 0.019]),
    marker_diameter=0.004,
    metres_per_pixel=0.000235,
    fps=30.0,
)
FITTED_FRAMES = 300
CLOSE = 0.02  # residual, as a share of the largest motion, from which a frame counts less


class Scale(NamedTuple):
    """Units of a campaign per unit of the finger.

    `rest` is the motion, in the campaign's unit, that counts as 0.
    """

    time: float
    motion: float
    load: float
    rest: float


@dataclass(frozen=True)
class Body:
    """One real trial.

    Attributes
    ----------
    path, column
        Its table, relative to the campaign, and the table's column of motion.
    time, motion : array (row,)
        As the table has them, in the finger's units; NaN where a cell is empty.
    load
        In the finger's units.
    individual : array (4, 1)
        log k_v, log c_v, log c_p and q_ini of its three elements.
    ladder
        What it creeps by beside them.
    """

    name: str
    path: Path
    column: str
    time: Array
    motion: Array
    load: Load
    individual: Array
    ladder: Ladder


def read_bodies(folder: Path) -> tuple[list[Body], Scale]:
    """Read a campaign of one joint or a specimen.

    Raises
    ------
    ValueError
        It has several joints, or a trial is no table of angles.
    """
    campaign = read_campaign(folder)
    if campaign.finger.joints > 1 or any(t.level != "angles" for t in campaign.trials):
        raise ValueError(
            f"{folder}: effects are added to tables of one joint's angles; leave this campaign out"
        )
    raw = [_read(campaign, trial) for trial in campaign.trials]
    scale = Scale(
        max(np.nanmax(time) - np.nanmin(time) for _, time, *_ in raw) / LONGEST_S,
        float(np.median([_reach(motion) for *_, motion, _ in raw])) / LARGEST_RAD,
        float(np.median([np.abs(load.tension).max() for *_, load in raw])) / LARGEST_N,
        float(np.median([_rest(motion) for *_, motion, _ in raw])),
    )
    bodies = []
    for trial, (column, time, motion, load) in zip(campaign.trials, raw, strict=True):
        time, motion = time / scale.time, (motion - scale.rest) / scale.motion
        load = Load(load.time / scale.time, load.tension / scale.load)
        path = trial.recording.relative_to(campaign.folder)
        own, ladder = fit_body(time, motion, load)
        bodies.append(Body(trial.name, path, column, time, motion, load, own, ladder))
    return bodies, scale


def _read(campaign: Campaign, trial: Trial) -> tuple[str, Array, Array, Load]:
    frames = read_angle_table(campaign, trial)
    table = pd.read_csv(trial.recording, skipinitialspace=True)
    column = "q1_rad" if campaign.specimen is None else "motion"
    clock = frames["time"].values
    knots, torque, _ = read_load(campaign, trial, float(np.median(np.diff(clock))), clock[0])
    time, motion = (table[name].to_numpy(float) for name in ("time_s", column))
    return column, time, motion, simplify(Load(knots, torque))


def simplify(load: Load) -> Load:
    """Leave out knots between two of the same load.

    >>> simplify(Load(np.arange(5.0), np.array([0.0, 2.0, 2.0, 2.0, 0.0]))).time
    array([0., 1., 3., 4.])
    """
    value = load.tension
    kept = np.ones(value.size, bool)
    kept[1:-1] = (value[1:-1] != value[:-2]) | (value[1:-1] != value[2:])
    return Load(load.time[kept], value[kept])


def _rest(motion: Array) -> float:
    """Motion with which a trial begins."""
    return float(np.median(motion[np.isfinite(motion)][:3]))


def _reach(motion: Array) -> float:
    """Largest motion from the first, without gross errors."""
    seen = motion[np.isfinite(motion)]
    return float(np.quantile(np.abs(seen - _rest(motion)), 0.99))


def fit_body(time: Array, motion: Array, load: Load) -> tuple[Array, Ladder]:
    """Fit three elements to one trial, then a ladder beside them."""
    own = fit_plain(time, motion, load)
    chosen = choose_frames(time, motion, load)
    trial = describe(0, 1, load, time[chosen][-1])
    close = CLOSE * LARGEST_RAD
    return fit_ladder(own, trial, RIG.wire_offset, time[chosen], motion[chosen], close)


def fit_plain(time: Array, motion: Array, load: Load) -> Array:
    """Fit the paper's three elements to one trial.

    The fit is by least squares that a gross error hardly moves.

    Returns
    -------
    array (4, 1)
        log k_v, log c_v, log c_p, q_ini; k_v in N m/rad, the others to match.
    """
    chosen = choose_frames(time, motion, load)
    seen_at, seen = time[chosen], motion[chosen]
    trial = describe(0, 1, load, seen_at[-1])
    first = float(np.median(seen[:3]))

    def leave(own: Array) -> Array:
        return compute_plain_angles(own[:, None], trial, RIG.wire_offset, seen_at)[:, 0] - seen

    starts = [
        np.array([np.log(0.1), np.log(0.1 * delay), np.log(0.1 * LONGEST_S), first])
        for delay in (0.03, 0.3, 3.0)
    ]
    low = np.array([np.log(1e-3), np.log(1e-6), np.log(1e-2), -np.inf])
    high = np.array([np.log(1e2), np.log(1e4), np.log(1e7), np.inf])
    fits = [
        least_squares(leave, start, bounds=(low, high), loss="soft_l1", f_scale=CLOSE * LARGEST_RAD)
        for start in starts
    ]
    return min(fits, key=lambda fit: fit.cost).x[:, None]


def choose_frames(time: Array, motion: Array, load: Load) -> Array:
    """Choose frames evenly in time and in its logarithm.

    The logarithm is of the time since the load last changed.
    """
    seen = np.flatnonzero(np.isfinite(motion))
    if seen.size <= FITTED_FRAMES:
        return seen
    changes = load.time[np.append(True, np.diff(load.tension) != 0.0)]
    since = (
        time[seen] - changes[np.clip(np.searchsorted(changes, time[seen], "right") - 1, 0, None)]
    )
    late = np.argsort(np.maximum(since, 1e-3), kind="stable")
    part = FITTED_FRAMES // 2
    even = np.linspace(0, seen.size - 1, part).round().astype(int)
    early = late[np.unique(np.geomspace(1, seen.size, part).round().astype(int)) - 1]
    return seen[np.union1d(even, early)]


def describe(number: int, count: int, load: Load, duration: float) -> Circumstances:
    """What is special about a trial, without chance."""
    return Circumstances(
        number=number,
        count=count,
        load=load,
        duration=float(duration),
        warmth=0.0,
        rest=LONGEST_S,
        luck=(0.5, 0.5, 0.5),
    )
