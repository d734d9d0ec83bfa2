"""Writes a concealed campaign's folder."""

from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path

import pandas as pd

from softfinger.concealed.arrays import Array
from softfinger.concealed.oracle import Recording
from softfinger.concealed.rig import Rig
from softfinger.concealed.setting import Setting

# Films a motion (frame, joint) [rad] at the rig's frame rate: (angle, rig, path, seed).
Film = Callable[[Array, Rig, Path, int], None]

REFERENCE_C = 22.0
START = datetime(2024, 3, 4, 9, 0, 0)


def write_campaign(
    folder: Path,
    setting: Setting,
    recordings: list[Recording],
    logs: list[Array],
    *,
    declares_noise: bool,
    film: Film | None = None,
    seed: int = 0,
) -> None:
    """Write all files of a campaign folder.

    Parameters
    ----------
    logs
        (row, 2) of every trial: time [s], tension [N].
    declares_noise
        Whether campaign.yaml states the noise's standard deviation.
    film
        Makes a trial's video; without it angles are written.
    seed
        Root of the films' camera noise.
    """
    folder.mkdir(parents=True)
    (folder / "campaign.yaml").write_text(
        describe(folder.name, setting, declares_noise=declares_noise and film is None),
        encoding="utf-8",
    )
    kind, suffix = ("video", "avi") if film else ("angles", "csv")
    (folder / kind).mkdir()
    (folder / "load").mkdir()
    rows, clock = [], START
    for k, recording in enumerate(recordings):
        name, trial = f"trial_{k + 1:03d}", recording.trial
        clock += timedelta(seconds=trial.rest if k else 0.0)
        seen = f"{kind}/{name}.{suffix}"
        if film:
            film(recording.angle, setting.rig, folder / seen, seed + k)
        else:
            _write_angles(folder / seen, recording)
        load = pd.DataFrame(logs[k], columns=["time_s", "tension_n"])
        load.to_csv(folder / f"load/{name}.csv", index=False, float_format="%.6f")
        row = {
            "trial": name,
            "started_at": clock.isoformat(),
            kind: seen,
            "load": f"load/{name}.csv",
        }
        row["temperature_c"] = round(REFERENCE_C + trial.warmth, 2)
        row["humidity_pct"] = setting.humidity[k]
        rows.append(row)
        clock += timedelta(seconds=trial.duration)
    pd.DataFrame(rows).to_csv(folder / "trials.csv", index=False)


def _write_angles(path: Path, recording: Recording) -> None:
    columns = {"time_s": recording.time}
    columns |= {f"q{j + 1}_rad": recording.angle[:, j] for j in range(recording.angle.shape[1])}
    pd.DataFrame(columns).to_csv(path, index=False, float_format="%.6f")


def describe(name: str, setting: Setting, *, declares_noise: bool) -> str:
    """Text of campaign.yaml."""
    rig = setting.rig

    def listed(values: Array) -> str:
        return "[" + ", ".join(f"{value:.6g}" for value in values) + "]"

    lines = [
        "version: 1",
        f'name: "{name}"',  # ten digits, or digits and an e, would be a number
        "source: synthetic",
        "finger:",
        f"  joints: {rig.joints}",
        f"  link_length_m: {listed(rig.link_length)}",
        f"  link_mass_kg: {listed(rig.link_mass)}",
        f"  joint_length_m: {rig.joint_length:.6g}",
        f"  wire_offset_m: {rig.wire_offset:.6g}",
        "  bends: counter-clockwise",
        "camera:",
        f"  fps: {rig.fps:g}",
        f"  metres_per_pixel: {rig.metres_per_pixel:.6g}",
        "  markers:",
        f"    base: {listed(rig.base_marker)}",
        *(f"    link_{i + 1}: {listed(rig.link_marker)}" for i in range(rig.joints)),
        f"  marker_diameter_m: {rig.marker_diameter:.6g}",
        "  marker_colour: dark",
    ]
    if declares_noise:
        lines.append(f"noise_sd_rad: {setting.noise.sd:.3g}")
    return "\n".join(lines) + "\n"
