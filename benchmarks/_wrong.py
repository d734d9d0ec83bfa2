"""Kinds of plausible mistakes: what each does to the tables of a campaign.

A mistake is a function of a `Sheets` and the trials that it concerns; it changes them in place.
The lists name every mistake with the forms in which it is tried: all trials, half of them, one.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from ruamel.yaml import YAML


@dataclass
class Sheets:
    """A campaign of angles as tables in memory."""

    description: dict
    trials: pd.DataFrame
    angles: list[pd.DataFrame]
    loads: list[pd.DataFrame]

    @property
    def joints(self) -> list[str]:
        """Columns of the joints."""
        return [column for column in self.angles[0] if column.startswith("q")]


Change = Callable[[Sheets, Sequence[int]], None]


def read_tables(folder: Path) -> Sheets:
    """Read a campaign folder whose trials all have angles and a log."""
    trials = pd.read_csv(folder / "trials.csv", dtype=str)
    return Sheets(
        YAML(typ="safe").load(folder / "campaign.yaml"),
        trials,
        [pd.read_csv(folder / name) for name in trials["angles"]],
        [pd.read_csv(folder / name) for name in trials["load"]],
    )


def write_tables(tables: Sheets, folder: Path) -> None:
    """Write a campaign folder."""
    shutil.rmtree(folder, ignore_errors=True)
    for name in ("angles", "load"):
        (folder / name).mkdir(parents=True)
    with (folder / "campaign.yaml").open("w") as stream:
        YAML().dump(tables.description, stream)
    tables.trials.to_csv(folder / "trials.csv", index=False)
    for k, row in enumerate(tables.trials.itertuples()):
        tables.angles[k].to_csv(folder / str(row.angles), index=False, float_format="%.7g")
        if row.load:
            tables.loads[k].to_csv(folder / str(row.load), index=False, float_format="%.9g")


def scale_column(kind: str, column: str, factor: float) -> Change:
    """Multiply a column; `q` stands for every joint."""

    def change(tables: Sheets, chosen: Sequence[int]) -> None:
        for k in chosen:
            table = getattr(tables, kind)[k]
            for name in table.columns:
                if name == column or (column == "q" and name.startswith("q")):
                    table[name] *= factor

    return change


def scale_key(section: str | None, key: str, factor: float) -> Change:
    """Multiply a number of campaign.yaml."""

    def change(tables: Sheets, chosen: Sequence[int]) -> None:
        del chosen
        part = tables.description if section is None else tables.description[section]
        value = part.get(key, 0.003)
        part[key] = [v * factor for v in value] if isinstance(value, list) else value * factor

    return change


def edit_angles(edit: Callable[[pd.DataFrame, list[str]], pd.DataFrame]) -> Change:
    """Replace the table of angles by what a function makes of it."""

    def change(tables: Sheets, chosen: Sequence[int]) -> None:
        for k in chosen:
            tables.angles[k] = edit(tables.angles[k].copy(), tables.joints)

    return change


def edit_load(edit: Callable[[pd.DataFrame], pd.DataFrame]) -> Change:
    """Replace the load log by what a function makes of it."""

    def change(tables: Sheets, chosen: Sequence[int]) -> None:
        for k in chosen:
            tables.loads[k] = edit(tables.loads[k].copy())

    return change


def _take(order: Sequence[int]) -> Change:
    def edit(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
        table[joints] = table[joints].to_numpy()[:, list(order)]
        return table

    return edit_angles(edit)


def _absolute(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    table[joints] = np.cumsum(table[joints].to_numpy(), axis=1)
    return table


def _flip_joint(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    table[joints[1]] *= -1.0
    return table


def _freeze(table: pd.DataFrame, joints: list[str], start: float) -> pd.DataFrame:
    first = int(start * len(table))
    table.loc[first:, joints[0]] = table[joints[0]].iloc[first]
    return table


def _freeze_all(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    first = len(table) // 3
    table.loc[first:, joints] = table[joints].iloc[first].to_numpy()
    return table


def _dead(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    rng = np.random.default_rng(1)
    table[joints[1]] = 0.01 + rng.normal(0.0, 0.002, len(table))
    return table


def _constant(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    table[joints[1]] = 0.01
    return table


def _clip(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    widest = max(joints, key=lambda joint: np.ptp(table[joint]))
    limit = 0.7 * table[widest].max()
    table[joints] = table[joints].clip(upper=limit)
    return table


def _hold(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    held = table[joints].iloc[(np.arange(len(table)) // 4) * 4].to_numpy()
    table[joints] = held
    return table


def _wrap(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    total = table[joints[0]].to_numpy()
    middle = 0.5 * (total.max() + total.min())
    table[joints[0]] = np.where(total > middle, total - 2 * np.pi, total)
    return table


def _reverse(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    table[joints] = table[joints].to_numpy()[::-1]
    return table


def _smooth(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    time = table["time_s"].to_numpy() - table["time_s"].iloc[0]
    for k, joint in enumerate(joints):
        table[joint] = 0.1 * (k + 1) * (1 - np.exp(-time / (1 + k)))
    return table


def _cut_last_row(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    table.loc[len(table) - 1, joints[-1]] = 0.0
    return table


def _stop_moving(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    rng = np.random.default_rng(2)
    table[joints] = rng.normal(0.0, 0.002, (len(table), len(joints)))
    return table


def _offset(table: pd.DataFrame, joints: list[str], by: float) -> pd.DataFrame:
    table[joints[0]] += by
    return table


def _copy_joint(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    table[joints[1]] = table[joints[0]]
    return table


def _bridge(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    for start in (0.2, 0.55, 0.7):
        first = int(start * len(table))
        table.loc[first : first + max(8, len(table) // 40), joints] = np.nan
    table[joints] = table[joints].interpolate()
    return table


def _bridge_joint(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    first = int(0.6 * len(table))
    table.loc[first : first + 12, joints[1]] = np.nan
    table[joints] = table[joints].interpolate()
    return table


def _zero_first(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    table[joints] -= table[joints].iloc[0]
    return table


def _zero_mean(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    table[joints] -= table[joints].iloc[:10].mean()
    return table


def _repeat_block(table: pd.DataFrame, joints: list[str]) -> pd.DataFrame:
    count, first = len(table) // 8, int(0.3 * len(table))
    table.loc[first + 2 * count : first + 3 * count - 1, joints] = (
        table[joints].iloc[first : first + count].to_numpy()
    )
    return table


def _paste_block(tables: Sheets, chosen: Sequence[int]) -> None:
    for k in chosen:
        own, joints = tables.angles[k], tables.joints
        other = tables.angles[(k + 1) % len(tables.angles)]
        count, first = len(own) // 8, int(0.4 * len(own))
        own.loc[first : first + count - 1, joints] = other[joints].iloc[:count].to_numpy()


def _cut_log(table: pd.DataFrame) -> pd.DataFrame:
    """Keep a log's samples until seven tenths of it."""
    time = table["time_s"].to_numpy()
    sampled = np.arange(time[0], time[0] + 0.7 * np.ptp(time), 0.05)
    column = table.columns[1]
    return pd.DataFrame({"time_s": sampled, column: np.interp(sampled, time, table[column])})


def _shift(table: pd.DataFrame, by: float) -> pd.DataFrame:
    table["time_s"] += by
    return table


def _copy_trial(shift: float, offset: float = 0.0, part: float = 1.0) -> Change:
    def change(tables: Sheets, chosen: Sequence[int]) -> None:
        for k in chosen:
            source = (k + 1) % len(tables.angles)
            table = tables.angles[source].iloc[: int(part * len(tables.angles[source]))].copy()
            table["time_s"] += shift
            table[tables.joints] += offset
            tables.angles[k] = table

    return change


def _copy_path(tables: Sheets, chosen: Sequence[int]) -> None:
    for k in chosen:
        other = tables.trials.loc[(k + 1) % len(tables.trials), "angles"]
        tables.trials.loc[k, "angles"] = other
        tables.angles[k] = tables.angles[(k + 1) % len(tables.angles)]


def _turn_kind(factor: float, column: str) -> Change:
    def edit(table: pd.DataFrame) -> pd.DataFrame:
        old = next(name for name in table if name != "time_s")
        return table.assign(**{old: table[old] * factor}).rename(columns={old: column})

    return edit_load(edit)


def _forget_log(tables: Sheets, chosen: Sequence[int]) -> None:
    tables.trials.loc[list(chosen), "load"] = ""


def _set_cells(column: str, value: Callable[[str], str]) -> Change:
    def change(tables: Sheets, chosen: Sequence[int]) -> None:
        for k in chosen:
            tables.trials.loc[k, column] = value(tables.trials.loc[k, column])

    return change


def _equal_starts(tables: Sheets, chosen: Sequence[int]) -> None:
    tables.trials.loc[list(chosen), "started_at"] = tables.trials.loc[0, "started_at"]
    tables.trials.loc[0, "started_at"] = tables.trials.loc[list(chosen)[-1], "started_at"]


def _zero_load(table: pd.DataFrame) -> pd.DataFrame:
    table[table.columns[1]] = 0.0
    return table


ALL, HALF, ONE = "all", "half", "one"
G = 1e3 / 9.80665

MISTAKES: dict[str, tuple[Change, tuple[str, ...]]] = {
    "angle_time_ms": (scale_column("angles", "time_s", 1e3), (ALL, HALF, ONE)),
    "both_times_ms": (
        lambda t, c: (
            scale_column("angles", "time_s", 1e3)(t, c),
            scale_column("loads", "time_s", 1e3)(t, c),
        )[0],
        (ALL, HALF, ONE),
    ),
    "both_times_minutes": (
        lambda t, c: (
            scale_column("angles", "time_s", 1 / 60)(t, c),
            scale_column("loads", "time_s", 1 / 60)(t, c),
        )[0],
        (HALF, ONE),
    ),
    "load_time_ms": (scale_column("loads", "time_s", 1e3), (ALL, HALF, ONE)),
    "time_stretched_double": (scale_column("angles", "time_s", 2.0), (HALF, ONE)),
    "time_stretched_fps": (scale_column("angles", "time_s", 30.0 / 25.0), (HALF, ONE)),
    "load_in_grams": (scale_column("loads", "load", G), (ALL, HALF, ONE)),
    "load_in_kilograms": (scale_column("loads", "load", 1 / 9.80665), (HALF, ONE)),
    "load_in_kilonewtons": (scale_column("loads", "load", 1e-3), (ALL, HALF, ONE)),
    "load_in_millinewtons": (scale_column("loads", "load", 1e3), (HALF, ONE)),
    "load_in_pounds": (scale_column("loads", "load", 1 / 4.448), (ONE,)),
    "load_tenfold": (scale_column("loads", "load", 10.0), (HALF, ONE)),
    "angles_in_degrees": (scale_column("angles", "q", 180 / np.pi), (ALL, HALF, ONE)),
    "angles_in_turns": (scale_column("angles", "q", 1 / (2 * np.pi)), (HALF, ONE)),
    "angles_in_mrad": (scale_column("angles", "q", 1e3), (ALL, ONE)),
    "radians_as_degrees": (scale_column("angles", "q", np.pi / 180), (ALL, HALF, ONE)),
    "one_joint_in_turns": (scale_column("angles", "q1_rad", 1 / (2 * np.pi)), (HALF, ONE)),
    "one_joint_in_degrees": (scale_column("angles", "q2_rad", 180 / np.pi), (ALL, HALF, ONE)),
    "last_joint_in_degrees": (scale_column("angles", "q3_rad", 180 / np.pi), (ALL, ONE)),
    "one_joint_in_mrad": (scale_column("angles", "q1_rad", 1e3), (ALL, HALF, ONE)),
    "one_joint_tenth": (scale_column("angles", "q2_rad", 0.1), (HALF, ONE)),
    "sign_flipped": (scale_column("angles", "q", -1.0), (ALL, HALF, ONE)),
    "sign_of_a_joint": (edit_angles(_flip_joint), (ALL, HALF, ONE)),
    "sign_of_the_load": (scale_column("loads", "load", -1.0), (ALL, ONE)),
    "absolute_angles": (edit_angles(_absolute), (ALL, HALF, ONE)),
    "joints_1_2_exchanged": (_take([1, 0, 2]), (ALL, HALF, ONE)),
    "joints_2_3_exchanged": (_take([0, 2, 1]), (ALL, ONE)),
    "joints_1_3_exchanged": (_take([2, 1, 0]), (ONE,)),
    "joints_turned_round": (_take([1, 2, 0]), (ALL, ONE)),
    "a_joint_copied": (edit_angles(_copy_joint), (ALL, ONE)),
    "dead_joint": (edit_angles(_dead), (ALL, HALF, ONE)),
    "constant_joint": (edit_angles(_constant), (ALL, HALF, ONE)),
    "frozen_joint": (edit_angles(lambda t, j: _freeze(t, j, 0.4)), (ALL, HALF, ONE)),
    "frozen_late": (edit_angles(lambda t, j: _freeze(t, j, 0.75)), (ONE,)),
    "frozen_recording": (edit_angles(_freeze_all), (HALF, ONE)),
    "clipped": (edit_angles(_clip), (ALL, HALF, ONE)),
    "repeated_frames": (edit_angles(_hold), (ALL, HALF, ONE)),
    "quantised": (
        edit_angles(lambda t, j: t.assign(**{k: (t[k] / 0.1).round() * 0.1 for k in j})),
        (ALL, HALF, ONE),
    ),
    "bridged": (edit_angles(_bridge), (ALL, HALF, ONE)),
    "bridged_joint": (edit_angles(_bridge_joint), (HALF, ONE)),
    "zeroed_at_first": (edit_angles(_zero_first), (HALF, ONE)),
    "zeroed_by_mean": (edit_angles(_zero_mean), (HALF, ONE)),
    "block_repeated": (edit_angles(_repeat_block), (ALL, ONE)),
    "block_of_another": (_paste_block, (ONE,)),
    "log_cut": (edit_load(_cut_log), (ALL, HALF, ONE)),
    "wrapped": (edit_angles(_wrap), (ALL, ONE)),
    "reversed": (edit_angles(_reverse), (ALL, HALF, ONE)),
    "without_noise": (edit_angles(_smooth), (ALL,)),
    "last_row_cut": (edit_angles(_cut_last_row), (ALL, ONE)),
    "no_motion": (edit_angles(_stop_moving), (ALL, HALF, ONE)),
    "offset": (edit_angles(lambda t, j: _offset(t, j, 0.5)), (ONE,)),
    "quarter_turn_offset": (edit_angles(lambda t, j: _offset(t, j, np.pi / 2)), (ALL, ONE)),
    "recording_2_s_late": (edit_angles(lambda t, j: _shift(t, 2.0)), (ALL, HALF, ONE)),
    "recording_2_s_early": (edit_angles(lambda t, j: _shift(t, -2.0)), (ALL, ONE)),
    "log_1_s_late": (edit_load(lambda t: _shift(t, 1.0)), (ALL, HALF, ONE)),
    "log_an_hour_late": (edit_load(lambda t: _shift(t, 3600.0)), (ALL, HALF, ONE)),
    "unix_stamps": (edit_angles(lambda t, j: _shift(t, 1.77e9)), (ALL, ONE)),
    "no_log": (_forget_log, (HALF, ONE)),
    "log_of_zeros": (edit_load(_zero_load), (ALL, HALF, ONE)),
    "log_as_command": (_turn_kind(1.0, "command"), (HALF, ONE)),
    "log_as_torque": (_turn_kind(0.005, "torque_nm"), (HALF, ONE)),
    "file_copied": (_copy_trial(0.0), (ALL, ONE)),
    "file_copied_later": (_copy_trial(0.0005), (ONE,)),
    "file_copied_offset": (_copy_trial(0.0, 0.01), (ONE,)),
    "file_copied_in_part": (_copy_trial(0.0, 0.0, 0.6), (ONE,)),
    "two_names_one_file": (_copy_path, (ONE,)),
    "equal_starts": (_equal_starts, (ALL, ONE)),
    "temperature_hundredfold": (
        _set_cells("temperature_c", lambda text: f"{float(text) * 100:g}"),
        (ALL, ONE),
    ),
    "temperature_fahrenheit": (
        _set_cells("temperature_c", lambda text: f"{1.8 * float(text) + 32:g}"),
        (ONE,),
    ),
    "temperature_kelvin": (
        _set_cells("temperature_c", lambda text: f"{float(text) + 273.15:g}"),
        (ALL, ONE),
    ),
    "masses_in_grams": (scale_key("finger", "link_mass_kg", 1e3), (ALL,)),
    "masses_in_tonnes": (scale_key("finger", "link_mass_kg", 1e-3), (ALL,)),
    "lengths_in_decimetres": (scale_key("finger", "link_length_m", 10.0), (ALL,)),
    "lengths_a_tenth": (scale_key("finger", "link_length_m", 0.1), (ALL,)),
    "lengths_in_mm": (scale_key("finger", "link_length_m", 1e3), (ALL,)),
    "wire_offset_in_cm": (scale_key("finger", "wire_offset_m", 100.0), (ALL,)),
    "wire_offset_a_hundredth": (scale_key("finger", "wire_offset_m", 0.01), (ALL,)),
    "joint_length_in_cm": (scale_key("finger", "joint_length_m", 100.0), (ALL,)),
    "noise_in_degrees": (scale_key(None, "noise_sd_rad", 180 / np.pi), (ALL,)),
    "noise_in_mrad": (scale_key(None, "noise_sd_rad", 1e3), (ALL,)),
}


def choose(form: str, count: int) -> list[int]:
    """Trials that a form concerns."""
    return {ALL: range(count), HALF: range(1, count, 2), ONE: range(2, 3)}[form]  # type: ignore[return-value]


def make_mistake(tables: Sheets, name: str, form: str) -> Sheets:
    """A copy of a campaign with one mistake in it."""
    spoiled = Sheets(
        YAML(typ="safe").load(_dump(tables.description)),
        tables.trials.copy(),
        [table.copy() for table in tables.angles],
        [table.rename(columns={"tension_n": "load"}) for table in tables.loads],
    )
    change, _ = MISTAKES[name]
    change(spoiled, choose(form, len(tables.angles)))
    spoiled.loads = [table.rename(columns={"load": "tension_n"}) for table in spoiled.loads]
    return spoiled


def _dump(description: dict) -> str:
    from io import StringIO

    stream = StringIO()
    YAML().dump(description, stream)
    return stream.getvalue()
