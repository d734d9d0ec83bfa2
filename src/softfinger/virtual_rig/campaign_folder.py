"""The campaign folder of a virtual rig."""

from collections.abc import Iterable
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import xarray as xr
from ruamel.yaml import YAML
from scipy.signal import lfilter

from softfinger.virtual_rig.config import RigConfig, read_rig_config
from softfinger.virtual_rig.scene import build_marker_places
from softfinger.virtual_rig.streams import Purpose, build_generator

FIRST_TRIAL_AT = datetime(2026, 3, 2, 9, 0, 0)  # an invented day
INTERVAL_SCATTER_S = 5.0
ROOM_TEMPERATURE_C = (23.0, 0.5)  # mean and sd; nothing in the finger depends on it
RECORDINGS = {"video": "video/{}.avi", "angles": "angles/{}.csv"}


def write_campaign_folder(truth: xr.Dataset, config: dict, folder: Path, seed: int) -> None:
    """Write a campaign folder, all but the videos.

    ``campaign.yaml``, ``trials.csv``, a load log per trial and, at the angles level, the angles
    with measurement noise. `film_trial` adds the videos that ``trials.csv`` names.

    Parameters
    ----------
    truth : Dataset
        As from `draw_motion`. Its true parameters and angles do not go into the folder.
    config
        The virtual rig's block of the configuration; what only pictures depend on may be absent.
    folder
        Made when absent.
    seed
        Root of the trials' streams.
    """
    rig, folder = read_rig_config(config), Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    names = [str(name) for name in truth.trial.values]
    with (folder / "campaign.yaml").open("w", encoding="utf-8", newline="\n") as file:
        YAML().dump(declare_campaign(rig), file)
    _write_csv(folder / "trials.csv", *_build_trial_table(names, rig, seed))
    load = np.stack([truth.load_time.values, truth.load_tension.values], axis=1)
    for index, name in enumerate(names):
        _write_csv(folder / "load" / f"{name}.csv", ["time_s", "tension_n"], _format(load))
        if rig.level == "angles":
            _write_angles(truth, rig, index, folder / RECORDINGS["angles"].format(name), seed)


def declare_campaign(config: RigConfig) -> dict:
    """Build the contents of ``campaign.yaml``."""
    camera = {
        "fps": config.fps,
        "metres_per_pixel": config.metres_per_pixel,
        "markers": build_marker_places(config),
        "marker_diameter_m": config.marker_diameter_m,
        "marker_colour": "dark",
    }
    return {
        "version": 1,
        "name": f"virtual rig, {config.n_trials} trials",
        "source": "synthetic",
        "finger": {
            "joints": len(config.link_length_m),
            "link_length_m": config.link_length_m,
            "link_mass_kg": config.link_mass_kg,
            "joint_length_m": config.joint_length_m,
            "wire_offset_m": config.wire_offset_m,
            "bends": "counter-clockwise",
        },
    } | ({"camera": camera} if config.level == "video" else {})


def draw_angle_noise_array(
    shape: tuple[int, int], noise_sd: float, autocorrelation: float, rng: np.random.Generator
) -> np.ndarray:
    """Draw measurement noise of relative joint angles.

    Each direction in the picture, the base's included, errs on its own by a stationary AR(1) of
    sd noise_sd / √2; a relative angle is the difference of two neighbours. So its sd is noise_sd,
    and neighbouring joints, which share a link, correlate by −0.5.

    Parameters
    ----------
    shape
        Numbers of joints and of frames.
    noise_sd
        [rad]
    autocorrelation
        Between successive frames, in (−1, 1).

    Returns
    -------
    (joint, frame) [rad]
    """
    joints, frames = shape
    shock = rng.standard_normal((joints + 1, frames))
    shock[:, 1:] *= np.sqrt(1 - autocorrelation**2)
    error = lfilter([1.0], [1.0, -autocorrelation], shock, axis=1) * noise_sd / np.sqrt(2)
    return np.diff(error, axis=0)


def draw_temperature(room: np.random.Generator) -> float:
    """Draw a trial's temperature [°C], to a tenth."""
    return round(room.normal(*ROOM_TEMPERATURE_C), 1)


def _build_trial_table(
    names: list[str], config: RigConfig, seed: int
) -> tuple[list[str], list[list[str]]]:
    rows, started_at = [], FIRST_TRIAL_AT
    for index, name in enumerate(names):
        room = build_generator(seed, index, Purpose.ROOM)
        temperature = draw_temperature(room)
        recording = RECORDINGS[config.level].format(name)
        moment = started_at.isoformat(timespec="seconds")
        rows.append([name, moment, recording, f"load/{name}.csv", f"{temperature:.1f}"])
        scatter = room.uniform(-INTERVAL_SCATTER_S, INTERVAL_SCATTER_S)
        started_at += timedelta(seconds=round(config.trial_interval_s + scatter))
    return ["trial", "started_at", config.level, "load", "temperature_c"], rows


def _write_angles(truth: xr.Dataset, config: RigConfig, index: int, path: Path, seed: int) -> None:
    angle = truth.joint_angle.isel(trial=index).transpose("joint", "frame").values
    noise = draw_angle_noise_array(
        angle.shape,
        config.angle_noise_sd_rad,
        config.angle_noise_autocorrelation,
        build_generator(seed, index, Purpose.ANGLE_NOISE),
    )
    header = ["time_s", *(f"q{joint}_rad" for joint in range(1, len(angle) + 1))]
    _write_csv(path, header, _format(np.column_stack([truth.time.values, (angle + noise).T])))


def _format(table: np.ndarray) -> list[list[str]]:
    return [[f"{value:.6f}" for value in row] for row in table]


def _write_csv(path: Path, header: list[str], rows: Iterable[list[str]]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = [",".join(row) for row in [header, *rows]]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")
