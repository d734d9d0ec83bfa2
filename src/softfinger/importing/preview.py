"""What was understood, as rows and curves."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from softfinger.importing.build import ImportedTrial
from softfinger.importing.description import ImportDescription

ROWS, WIDTH, HEIGHT, SHOWN = 5, 72, 8, 3
LEVELS = " ▁▂▃▄▅▆▇█"


def format_preview(description: ImportDescription, trials: Sequence[ImportedTrial]) -> str:
    """First rows and curves of the first three trials."""
    parts = [f"{len(trials)} trials"]
    for trial in trials[:SHOWN]:
        parts += ["", f"trial {trial.name}: {_summarise(trial)}", *_list_rows(description, trial)]
        parts += _draw(description, trial)
    return "\n".join(parts)


def _summarise(trial: ImportedTrial) -> str:
    seen = np.isfinite(trial.motion).any(axis=1)
    said = (
        f"{seen.sum()} of {len(seen)} rows with a motion, {trial.time[0]:g} to {trial.time[-1]:g} s"
    )
    noted = [f"{name} = {value:g}" for name, value in trial.covariates.items()]
    started = [f"started {trial.started_at:%Y-%m-%d %H:%M:%S}"] if trial.started_at else []
    return ", ".join([said, *started, *noted, *trial.notes])


def name_motion(description: ImportDescription, trial: ImportedTrial) -> list[str]:
    """Names of a trial's motion columns, with units."""
    if trial.points:
        return [f"{point} {axis} [px]" for point in trial.points for axis in "xy"]
    count = trial.motion.shape[1]
    if description.motion.quantity == "angle":
        return [f"angle {k + 1} [rad]" for k in range(count)]
    return [f"{description.motion.quantity} [{description.motion.unit}]"]


def _list_rows(description: ImportDescription, trial: ImportedTrial) -> list[str]:
    names = name_motion(description, trial)[:6]
    load = name_load(description) if trial.load.size else "load (none)"
    head = ["row", "time [s]", *names, load]
    rows = [head]
    for k in range(min(ROWS, len(trial.time))):
        value = "-"
        if trial.load.size:
            at = np.searchsorted(trial.load_time, trial.time[k], side="right") - 1
            value = f"{trial.load[at]:.6g}" if at >= 0 else "0"
        row = str(trial.row[k]) if trial.row.size else ""
        rows.append([row, f"{trial.time[k]:.6g}",
                     *(f"{v:.6g}" for v in trial.motion[k, : len(names)]), value])  # fmt: skip
    widths = [max(len(row[i]) for row in rows) for i in range(len(head))]
    return [
        "  " + "  ".join(cell.rjust(w) for cell, w in zip(row, widths, strict=True)) for row in rows
    ]


def name_load(description: ImportDescription) -> str:
    """Name of the load, with its unit."""
    return f"{description.load.quantity} [{description.load.unit}]"


def sum_motion(trial: ImportedTrial) -> np.ndarray:
    """Sum of angles (frame,), or the tip's height."""
    return -trial.motion[:, -1] if trial.points else trial.motion.sum(axis=1)


def _draw(description: ImportDescription, trial: ImportedTrial) -> list[str]:
    lines = [f"  {'motion':<8}{sketch_curve(trial.time, sum_motion(trial))}"]
    if trial.load.size:
        load = sample_load(trial)
        lines.append(f"  {'load':<8}{sketch_curve(trial.time, load)}")
    return lines


def sample_load(trial: ImportedTrial) -> np.ndarray:
    """Load (frame,) at the motion's times."""
    return np.interp(trial.time, trial.load_time, trial.load, left=0.0)


def sketch_curve(time: np.ndarray, value: np.ndarray) -> str:
    """Curve as a line of blocks.

    Its smallest and largest value follow.

    >>> sketch_curve(np.arange(72.0), np.arange(72.0))[-12:]
    '████ 0 to 71'
    """
    edges = np.linspace(time[0], time[-1], WIDTH + 1)
    place = np.clip(np.searchsorted(edges, time, side="right") - 1, 0, WIDTH - 1)
    seen = np.isfinite(value)
    if not seen.any():
        return "(nothing)"
    total = np.bincount(place[seen], value[seen], WIDTH)
    count = np.bincount(place[seen], minlength=WIDTH)
    low, high = float(value[seen].min()), float(value[seen].max())
    mean = total / np.maximum(count, 1)
    scale = (mean - low) / (high - low) if high > low else np.full(WIDTH, 0.5)
    level = 1 + np.clip((scale * 8).astype(int), 0, 7)
    blocks = "".join(LEVELS[k] if n else " " for k, n in zip(level, count, strict=True))
    return f"{blocks} {low:.4g} to {high:.4g}"


def gather_curves(description: ImportDescription, trials: Sequence[ImportedTrial]) -> xr.Dataset:
    """Motion and load of the first three trials.

    Returns
    -------
    Dataset
        ``time``, ``motion`` and ``load`` (trial, frame), NaN after the last frame; attributes
        ``source`` and the labels ``motion``, ``load``.
    """
    shown = trials[:SHOWN]
    frames = max(len(trial.time) for trial in shown)
    curves = {name: np.full((len(shown), frames), np.nan) for name in ("time", "motion", "load")}
    for k, trial in enumerate(shown):
        size = len(trial.time)
        curves["time"][k, :size], curves["motion"][k, :size] = trial.time, sum_motion(trial)
        if trial.load.size:
            curves["load"][k, :size] = sample_load(trial)
    first = shown[0]
    motion = "last point, up [px]" if first.points else name_motion(description, first)[0]
    return xr.Dataset(
        {name: (("trial", "frame"), values) for name, values in curves.items()},
        coords={"trial": [trial.name for trial in shown]},
        attrs={
            "source": description.source,
            "motion": "sum of angles [rad]"
            if first.motion.shape[1] > 1 and not first.points
            else motion,
            "load": "no load is known" if not first.load.size else name_load(description),
        },
    )
