"""Load logs: CSV rows to a piecewise-linear load."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from softfinger.campaign.tables import check_columns, check_times, read_text_table, to_numbers
from softfinger.faults import CampaignFault, TrialFault, list_briefly

if TYPE_CHECKING:
    from pathlib import Path

    import pandas as pd

    from softfinger.campaign.folder import Campaign
    from softfinger.campaign.trials import Trial

LOAD_COLUMNS = ("tension_n", "torque_nm", "command")
STEP_WITHIN_FRAME_INTERVALS = 1.5
LARGEST_TENSION_N = 5000.0
LARGEST_TORQUE_NM = 500.0
ZERO_SHARE = 0.05  # of the largest tension, by which a load cell's zero may be off
SMALLEST_LOAD, LARGEST_LOAD = 1e-12, 1e12  # of any kind, a command's in its own unit


def read_load(
    campaign: Campaign, trial: Trial, frame_interval: float, first_frame: float
) -> tuple[np.ndarray, np.ndarray, str]:
    """Read a trial's generalised torque on every joint.

    A ``tension_n`` becomes the torque tension × wire offset; ``torque_nm`` and ``command`` act as
    they are, and so does a specimen's ``load``, in its own unit. Without a log a unit command
    from the first frame is assumed.

    Parameters
    ----------
    frame_interval : float [s]
        Median frame interval of the recording: rows of different value closer than 1.5 of these
        are a step at the later row.
    first_frame : float [s]
        Time of the first frame, from which an assumed command acts.

    Returns
    -------
    load_time : numpy.ndarray (knot,) [s]
        Nondecreasing; a jump is a repeated time.
    load_torque : numpy.ndarray (knot,) [N m, or units of the command]
        Zero before the first knot, the last value after the last one.
    kind : str
        ``tension_n``, ``torque_nm``, ``command`` or ``assumed``.

    Raises
    ------
    TrialFault
        The log cannot be read, times run backwards, or a tension cannot be turned into a torque.
    """
    if trial.load is None:
        return np.full(2, first_frame), np.array([0.0, 1.0]), "assumed"
    path = trial.load
    table = read_text_table(path)
    column = "load" if campaign.specimen else _find_load_column(path, table)
    kind = "command" if campaign.specimen else column
    check_columns(path, table, ["time_s", column])
    time, value = to_numbers(path, table, "time_s"), to_numbers(path, table, column)
    check_times(path, time)
    _refuse_odd_size(path.name, kind, value)
    load_time, load = build_load_array(time, value, STEP_WITHIN_FRAME_INTERVALS * frame_interval)
    if kind == "tension_n":
        load = load * _find_moment_arm(campaign, path.name, value)
    elif kind == "torque_nm" and np.abs(value).max() > LARGEST_TORQUE_NM:
        raise TrialFault(
            f"{path.name}, column 'torque_nm': reaches {np.abs(value).max():g} N m; expected at "
            f"most {LARGEST_TORQUE_NM:g} N m on a soft finger; is it in N mm?"
        )
    return load_time, load, kind


def _find_load_column(path: Path, table: pd.DataFrame) -> str:
    kinds = [column for column in LOAD_COLUMNS if column in table.columns]
    if len(kinds) != 1:
        found = f"{' and '.join(kinds)} are" if kinds else "none is"
        raise TrialFault(
            f"{path.name}: expected time_s and one of {', '.join(LOAD_COLUMNS)}; {found} there"
        )
    return kinds[0]


def refuse_mixed_loads(name: str, kinds: Mapping[str, str]) -> None:
    """Refuse a campaign whose trials log different quantities.

    Stiffness per newton metre and stiffness per unit of command are no common population.

    Parameters
    ----------
    kinds : mapping
        Trial → kind of its load, as from :func:`read_load`.

    Raises
    ------
    CampaignFault
        More than one kind; the message lists the trials of each.

    Examples
    --------
    >>> refuse_mixed_loads("a campaign", {"one": "command", "two": "command"})
    """
    groups: dict[str, list[str]] = {}
    for trial, kind in kinds.items():
        groups.setdefault(kind, []).append(trial)
    if len(groups) > 1:
        listed = "; ".join(f"{kind} in {list_briefly(trials)}" for kind, trials in groups.items())
        raise CampaignFault(
            name,
            [
                (
                    f"its load logs have different quantities: {listed}; expected one of "
                    f"{', '.join(LOAD_COLUMNS)} in all trials: convert the logs, or make a "
                    "campaign of each"
                )
            ],
        )


def build_load_array(
    time: np.ndarray, value: np.ndarray, step_within: float
) -> tuple[np.ndarray, np.ndarray]:
    """Knots of a log's piecewise-linear load.

    Straight lines between rows, but rows of different value at most ``step_within`` seconds apart
    are a jump at the later one: a straight line there would fake a delay of the response. Before
    the first row the load is zero, so a first row with load is a jump at its time.

    Examples
    --------
    >>> build_load_array(np.array([0.0, 0.02, 2.0]), np.array([0.0, 5.0, 6.0]), 0.05)
    (array([0.  , 0.02, 0.02, 2.  ]), array([0., 0., 5., 6.]))
    """
    knots_t, knots_v = [time[0]], [value[0]]
    if value[0] != 0.0:
        knots_t, knots_v = [time[0], time[0]], [0.0, value[0]]
    for t, v in zip(time[1:], value[1:], strict=True):
        if v != knots_v[-1] and t - knots_t[-1] <= step_within:
            if t != knots_t[-1]:
                knots_t.append(t)
                knots_v.append(knots_v[-1])
            knots_t.append(t)
            knots_v.append(v)
        elif t != knots_t[-1] or v != knots_v[-1]:
            knots_t.append(t)
            knots_v.append(v)
    return np.array(knots_t, float), np.array(knots_v, float)


def _refuse_odd_size(file_name: str, kind: str, value: np.ndarray) -> None:
    largest = float(np.abs(value).max())
    if largest == 0.0:
        raise TrialFault(
            f"{file_name}, column '{kind}': is 0 in every row; a trial without load shows no "
            "stiffness; check that the sensor was on"
        )
    if not SMALLEST_LOAD <= largest <= LARGEST_LOAD:
        raise TrialFault(
            f"{file_name}, column '{kind}': reaches {largest:g}; expected between "
            f"{SMALLEST_LOAD:g} and {LARGEST_LOAD:g}; choose a unit in which it is near 1"
        )


def _find_moment_arm(campaign: Campaign, file_name: str, tension: np.ndarray) -> float:
    pushes = tension.min() < -ZERO_SHARE * tension.max()
    if pushes or tension.max() > LARGEST_TENSION_N:
        worst = tension.min() if pushes else tension.max()
        raise TrialFault(
            f"{file_name}, column 'tension_n': is {worst:g} N; a wire pulls with 0 to "
            f"{LARGEST_TENSION_N:g} N"
        )
    if campaign.finger.wire_offset_m is None:
        raise TrialFault(
            f"{file_name}: a tension needs finger.wire_offset_m in campaign.yaml to become a "
            "torque; declare it, or log torque_nm or command instead"
        )
    return campaign.finger.wire_offset_m
