"""The campaign folder that is being recorded.

A finished trial is whole and stays; nothing else remains.

A trial exists from the moment that ``trials.csv`` names it, which is the last thing written. Every
file is written under another name, flushed to the disk, and then given its own.
"""

import csv
import io
import json
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path

import numpy as np
from ruamel.yaml import YAML

from softfinger.faults import Fault
from softfinger.rig.plan import Plan, PlannedTrial
from softfinger.rig.trial import TrialRecording
from softfinger.rig.video import write_video

TABLE = "trials.csv"
PREVIEW = "preview.jpg"
_PLAN, _DESCRIPTION = "recording/plan.yaml", "campaign.yaml"
_FIXED_COLUMNS = ("trial", "started_at", "video", "load")
_UNFINISHED = ".unfinished-"
_SPARE_BYTES = 50_000_000


class RecordingFolder:
    """A folder that `open_folder` makes or resumes."""

    def __init__(self, path: Path, rows: list[dict[str, str]]) -> None:
        self.path = path
        self._rows = rows

    @property
    def finished(self) -> list[str]:
        """The trials that are recorded."""
        return [row["trial"] for row in self._rows]

    def require_space(self, n_bytes: int) -> None:
        """Refuse a trial that the disk cannot store.

        Raises
        ------
        Fault
            Less than the trial's bytes and some to spare are free.
        """
        free = shutil.disk_usage(self.path).free
        if free < n_bytes + _SPARE_BYTES:
            raise Fault(
                f"{self.path}: {free / 1e6:.0f} MB are free on this disk, but the next trial needs "
                f"{(n_bytes + _SPARE_BYTES) / 1e6:.0f} MB; make room and run the same command again"
            )

    def add(
        self,
        planned: PlannedTrial,
        recording: TrialRecording,
        started_at: datetime,
        environment: Mapping[str, float],
    ) -> None:
        """Write a trial, its row of the table last.

        Raises
        ------
        Fault
            Something cannot be written; the folder is then as it was, but for files that no row
            names.
        """
        name = planned.name
        video, load = f"video/{name}.avi", f"load/{name}.csv"
        with _write_whole(self.path / video) as path:
            write_video(path, recording.pictures, recording.rate)
        _write_text(self.path / load, _format_load(recording))
        _write_text(self.path / f"recording/{name}_samples.csv", _format_samples(recording))
        _write_text(self.path / f"recording/{name}_frames.csv", _format_frames(recording))
        notes = describe_recording(planned, recording)
        _write_text(self.path / f"recording/{name}.json", json.dumps(notes, indent=2) + "\n")
        moment = started_at.isoformat(timespec="milliseconds")
        row = {"trial": name, "started_at": moment, "video": video, "load": load}
        row |= {key: f"{value:g}" for key, value in environment.items()}
        _write_text(self.path / TABLE, _format_table([*self._rows, row]))
        self._rows.append(row)


def open_folder(path: Path, plan: Plan, plan_text: str, simulated: bool) -> RecordingFolder:
    """Begin a campaign folder, or resume it.

    It is resumed only with the plan that began it.

    Raises
    ------
    Fault
        The folder was begun by another plan, on another kind of rig, or by something else.
    """
    described = plan.describe_campaign("synthetic" if simulated else "measured")
    _require_same(path, plan_text, described)
    for left_over in path.rglob(f"{_UNFINISHED}*"):
        left_over.unlink()
    if not (path / _PLAN).is_file():
        _write_text(path / _PLAN, plan_text)
    if not (path / _DESCRIPTION).is_file():
        stream = io.StringIO()
        YAML().dump(described, stream)
        _write_text(path / _DESCRIPTION, stream.getvalue())
    return RecordingFolder(path, _read_table(path / TABLE))


def describe_recording(planned: PlannedTrial, recording: TrialRecording) -> dict[str, object]:
    """Describe how well a trial was recorded."""
    return {
        "trial": planned.name,
        "profile": planned.profile.name,
        "peak_tension_n": float(recording.tension.max()),
        "frames": int(recording.stamp.size),
        "frames_lost": recording.n_dropped,
        "frame_rate_hz": recording.rate,
        "frame_jitter_s": recording.jitter,
        "camera_minus_controller_s": recording.before.offset,
        "camera_minus_controller_uncertainty_s": recording.before.uncertainty,
        "clock_drift_s": recording.after.offset - recording.before.offset,
        "clock_drift_uncertainty_s": recording.before.uncertainty + recording.after.uncertainty,
    }


def _require_same(path: Path, plan_text: str, described: dict[str, object]) -> None:
    begun_by = path / _PLAN
    if not begun_by.is_file():
        if any(p.is_file() and not p.name.startswith(_UNFINISHED) for p in path.rglob("*")):
            raise Fault(
                f"{path}: the folder contains files, but no recording of this program; name "
                "another folder"
            )
        return
    if begun_by.read_text(encoding="utf-8") != plan_text:
        raise Fault(
            f"{path}: the folder was begun with another plan, kept in {begun_by}; continue with "
            "that one, or name another folder"
        )
    if not (path / _DESCRIPTION).is_file():
        return
    source = YAML(typ="safe").load(path / _DESCRIPTION)["source"]
    if source != described["source"]:
        raise Fault(
            f"{path}: the folder's source is '{source}', this rig's '{described['source']}': never "
            "mix them; name another folder"
        )


def _read_table(path: Path) -> list[dict[str, str]]:
    if not path.is_file():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _format_table(rows: list[dict[str, str]]) -> str:
    noted = sorted({key for row in rows for key in row} - set(_FIXED_COLUMNS))
    stream = io.StringIO()
    writer = csv.DictWriter(stream, [*_FIXED_COLUMNS, *noted], restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue()


def _format_load(recording: TrialRecording) -> str:
    """Measured tension, cut at 0: wires cannot push."""
    time, hair = recording.sample_time, 1e-7
    pulled = (time >= recording.load_start - hair) & (time <= recording.load_end + hair)
    columns = [time[pulled], np.maximum(recording.tension[pulled], 0.0)]
    return _format_columns("time_s,tension_n", columns)


def _format_samples(recording: TrialRecording) -> str:
    columns = [recording.sample_time, recording.tension, recording.current]
    return _format_columns("time_s,tension_n,current_a", columns)


def _format_frames(recording: TrialRecording) -> str:
    time = np.arange(recording.stamp.size) / recording.rate
    return _format_columns("time_s,camera_stamp_s", [time, recording.stamp])


def _format_columns(header: str, columns: list[np.ndarray]) -> str:
    rows = (",".join(f"{value:.6f}" for value in row) for row in zip(*columns, strict=True))
    return "\n".join([header, *rows]) + "\n"


def _write_text(path: Path, text: str) -> None:
    with _write_whole(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8", newline="\n")


@contextmanager
def _write_whole(path: Path) -> Iterator[Path]:
    """Yield a temporary name that success makes `path`."""
    unfinished = path.with_name(_UNFINISHED + path.name)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield unfinished
        with unfinished.open("rb") as file:
            os.fsync(file.fileno())
        unfinished.replace(path)
    except OSError as error:
        raise Fault(
            f"{path}: it cannot be written ({error}); this trial is not kept; make room on the "
            "disk or change its permissions, and run the same command again"
        ) from None
    finally:
        unfinished.unlink(missing_ok=True)
