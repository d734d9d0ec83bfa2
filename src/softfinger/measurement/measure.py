"""What the recordings of a campaign suffer from.

It finds which frames inform, and the size of their noise.
Everything is learnt from what a model leaves, in ways that its own misfit hardly affects.
Outliers are compared with frames as long after a change of load. Sizes come from quiet windows,
in which a quartic follows whatever moves slowly.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.measurement.budget import BUDGET
from softfinger.measurement.decisions import DECISIONS
from softfinger.measurement.flags import JUMP, STALE
from softfinger.measurement.frames import select_frames
from softfinger.measurement.jitter import is_jitter
from softfinger.measurement.noise import NoiseFit, complete_noise, fit_noise
from softfinger.measurement.outliers import find_outliers, find_time_error, list_passed_array
from softfinger.measurement.presence import list_components
from softfinger.measurement.priors import PRIORS
from softfinger.measurement.reml import LEAST_SD, profile_windows
from softfinger.measurement.repeats import compute_step, find_repeated_frames, find_rounding
from softfinger.measurement.saturation import find_saturated_frames
from softfinger.measurement.scales import Scales, WindowVariances, fit_scales

LAYOUT = ("trial", "joint", "frame")
FRAMES = ("trial", "frame")

Array = NDArray[np.float64]


def measure(angles: xr.Dataset, motion: Array | None = None) -> xr.Dataset:
    """Measure which frames inform, and their noise.

    Parameters
    ----------
    angles
        The `angles` artifact.
    motion
        (trial, joint, frame) [rad] of a fitted model; without it, only gross errors are sought and
        all trials share one noise.

    Returns
    -------
    Dataset
        used, repeated (trial, frame); outlier_distance (trial, frame), t² of a frame that was left
        out as an outlier, else 0; present, trial_factor (trial, joint); frame_scale (trial,
        frame); noise_factor (trial, joint, frame); frame_interval [s]; noise_sd [rad],
        recorded_noise_sd [rad], which differs where an sd is declared, noise_autocorrelation,
        noise_white, window_count (joint), noise_correlation (joint, other_joint);
        noise_per_rad, noise_per_rate; component_size, component_evidence [nats] (component), of
        what is present.

    Raises
    ------
    Fault
        If no trial has enough frames.
    """
    frames = _prepare_frames(angles)
    if motion is None:
        frames = _leave_out(frames, _find_outliers(angles, frames, None))
        return _complete(angles, frames, fit_noise(angles, frames), {})
    angles = angles.assign(joint_angle=angles["joint_angle"].transpose(*LAYOUT) - motion)
    passed = list_passed_array(motion)
    seen = frames["used"].values
    passed *= find_time_error(angles["joint_angle"].values, passed, seen)
    every = frames[["used", "present"]]
    frames = _leave_out(frames, _find_outliers(angles, frames, None, passed))
    # a gross error is no reason to forget how the finger moved there: it is judged again
    moved = _measure_deflection(motion, every), _measure_velocity(motion, angles, every)
    scales, frames = _scale_noise(angles, frames, *moved)
    known = complete_noise(fit_noise(angles, frames).noise, angles, frames)
    frames = frames.assign(every)
    frames = _leave_out(frames, _find_outliers(angles, frames, known, passed))
    fit = fit_noise(angles, frames)
    found = list_components(scales, fit, frames)
    return _complete(angles, frames, fit, found).assign(
        noise_per_rad=scales.per_rad,
        noise_per_rate=scales.per_rate,
        recorded_noise_sd=("joint", _measure_sd(angles, frames, fit)),
    )


def _scale_noise(
    angles: xr.Dataset, frames: xr.Dataset, moved: Array, velocity: Array
) -> tuple[Scales, xr.Dataset]:
    """Scale every noise by what quiet windows show.

    It goes in rounds: windows that are too lively for a campaign of one noise are calm in units
    of their own. A declared sd is only where the noise of a trial is expected.
    """
    free, speed = angles.assign_attrs(noise_sd_rad=np.nan), np.abs(velocity)
    declared = float(angles.attrs.get("noise_sd_rad", np.nan))
    for _ in range(BUDGET.scale_rounds):
        fit = fit_noise(free, frames)
        scales = fit_scales(_list_variances(fit, (moved, speed), frames, declared))
        parts = scales.per_rad * moved, scales.per_rate * np.minimum(speed, scales.fastest)
        grown = np.sqrt(1.0 + sum(np.nan_to_num(part) ** 2 for part in parts))
        frames = frames.assign(
            trial_factor=(LAYOUT[:2], scales.factor),
            noise_factor=(LAYOUT, scales.factor[:, :, None] * grown),
        )
        if not scales.size:
            break
    growth = scales.per_rate * np.clip(velocity, -scales.fastest, scales.fastest)
    late = scales.per_rate * float(fit.noise["noise_sd"].mean())
    if 0.0 < late < frames["frame_interval"] and is_jitter(fit, np.nan_to_num(growth)):
        scales = scales.rename_rate("jitter")
    return scales, frames


def add_components(
    measurement: xr.Dataset, size: dict[str, float], evidence: dict[str, float]
) -> xr.Dataset:
    """Add further components: size, and evidence [nats].

    Both are dictionaries by component.

    A component that is present already grows.
    """
    known = measurement[["component_size", "component_evidence"]]
    size, evidence = dict(size), dict(evidence)
    for name in set(known["component"].values.tolist()) & set(size):
        here = known.sel(component=name)
        size[name] = float(np.hypot(size[name], here["component_size"]))
        evidence[name] += float(here["component_evidence"])
        known = known.drop_sel(component=name)
    more = xr.Dataset(
        {
            "component_size": ("component", list(size.values())),
            "component_evidence": ("component", [evidence[name] for name in size]),
        },
        {"component": list(size)},
    )
    both = xr.concat([known, more], "component")
    return measurement.drop_dims("component").merge(both)


def _prepare_frames(angles: xr.Dataset) -> xr.Dataset:
    """Frames of one noise, before outliers are sought."""
    saturated = find_saturated_frames(angles)
    seen = angles["joint_angle"].transpose(*LAYOUT).where(~saturated)
    angles = angles.assign(joint_angle=seen)
    frames = select_frames(angles)
    stale, suspect = _read_flags(angles)
    repeated = find_repeated_frames(angles, frames) | stale
    there = frames["used"].values | stale | suspect | saturated.any(axis=1)
    shape = tuple(angles.sizes[dim] for dim in LAYOUT)
    return frames.assign(
        used=(FRAMES, frames["used"].values & ~repeated),
        repeated=(FRAMES, repeated),
        outlier_distance=(FRAMES, np.zeros(repeated.shape)),
        trial_factor=(LAYOUT[:2], np.ones(shape[:2])),
        noise_factor=(LAYOUT, np.ones(shape)),
        rounding_sd=("joint", find_rounding(angles, frames)),
        lost=((), _count_lost(angles, there)),
        jumped=((), float((suspect & ~frames["used"].values & ~stale).sum())),
        saturated=(FRAMES, saturated.any(axis=1)),
    )


def _measure_sd(angles: xr.Dataset, frames: xr.Dataset, fit: NoiseFit) -> Array:
    """Sd (joint,) [rad] shown, whatever is declared."""
    if not np.isfinite(angles.attrs.get("noise_sd_rad", np.nan)):
        return fit.noise["noise_sd"].values
    shown = fit_noise(angles.assign_attrs(noise_sd_rad=np.nan), frames).noise["noise_sd"].values
    return shown * np.exp(np.log(frames["trial_factor"].values).mean(axis=0))


def _read_flags(angles: xr.Dataset) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Frames (trial, frame) flagged as repeats, and as jumps."""
    flag = angles["angle_flag"].transpose(*LAYOUT).values
    seen = np.isfinite(angles["joint_angle"].transpose(*LAYOUT).values)
    return tuple(((flag & bit > 0) & seen).any(axis=1) for bit in (STALE, JUMP))


def _count_lost(angles: xr.Dataset, seen: NDArray[np.bool_]) -> float:
    """Number of frames missing between those seen."""
    time = angles["time"].transpose(*FRAMES).values
    gaps = np.concatenate([np.diff(t[s]) for t, s in zip(time, seen, strict=True)])
    gap = np.round(gaps / np.median(gaps))
    return float(np.maximum(gap - 1.0, 0.0).sum())


def _find_outliers(
    angles: xr.Dataset, frames: xr.Dataset, noise: xr.Dataset | None, passed: Array | None = None
) -> Array:
    scale = frames["frame_scale"].values[:, None] * frames["noise_factor"].values
    step = compute_step(frames["rounding_sd"].values[:, None])  # what rounding does is not gross
    passed = (np.stack([-step, step])[:, None] + (0.0 if passed is None else passed)) / scale
    return find_outliers(angles["joint_angle"].values / scale, angles, frames, noise, passed)


def _leave_out(frames: xr.Dataset, distance: Array) -> xr.Dataset:
    used = frames["used"].values & (distance == 0.0)
    enough = (used.sum(axis=1) >= DECISIONS.least_frames)[:, None]
    if not enough.any():
        raise Fault(
            f"no trial has {DECISIONS.least_frames} frames that inform: all others repeat the one "
            "before or are gross errors; check the recordings' numbers"
        )
    return frames.assign(
        used=(FRAMES, used & enough),
        present=(LAYOUT[:2], frames["present"].values & enough),
        outlier_distance=(FRAMES, distance),
    )


def _measure_deflection(motion: Array, frames: xr.Dataset) -> Array:
    """Deflection (trial, joint, frame) [rad] from the start."""
    first = frames["used"].values.argmax(axis=1)
    return np.abs(motion - np.take_along_axis(motion, first[:, None, None], axis=2))


def _measure_velocity(motion: Array, angles: xr.Dataset, frames: xr.Dataset) -> Array:
    """Velocity (trial, joint, frame) [rad/s]; 0 at frames that do not inform."""
    time = angles["time"].transpose("trial", "frame").values
    velocity = np.zeros(motion.shape)
    for trial, used in enumerate(frames["used"].values):
        if used.sum() > 1:
            slope = np.gradient(motion[trial][:, used], time[trial, used], axis=1)
            velocity[trial][:, used] = slope
    return velocity


def _list_variances(
    fit: NoiseFit, moved: tuple[Array, Array], frames: xr.Dataset, declared: float
) -> WindowVariances:
    """Quiet windows' variances, over their joint's or declared."""
    factor = frames["noise_factor"].values
    trials, joints, count = factor.shape
    parts = [np.empty((0, 6))]
    for joint, (windows, memory) in enumerate(zip(fit.windows, fit.memories, strict=True)):
        if windows.dof <= 0 or not np.isfinite(memory.autocorrelation):
            continue
        residual = np.empty(len(windows.angle))
        rss, _ = profile_windows(*memory, *windows[:4], residual)
        freedom = np.diff(windows.start) - PRIORS.degree - 1.0
        usual = declared**2 if np.isfinite(declared) else rss.sum() / freedom.sum()
        begin = windows.start[:-1]
        trial, frame = windows.place // count, windows.place % count
        away, fast, own = (
            np.add.reduceat(part[trial, joint, frame], begin) / np.diff(windows.start)
            for part in (*moved, factor**2)
        )
        least = max(LEAST_SD, float(frames["rounding_sd"][joint])) ** 2
        value = np.maximum(own * rss / freedom, least) / max(usual, least)
        freedom = freedom / (1.0 + 0.5 * _measure_tail(residual, windows.start))
        place = trial[begin], 0 * value + joint
        parts.append(np.column_stack([value, freedom, *place, away, fast]))
    value, freedom, trial, joint, away, fast = np.concatenate(parts).T
    places = trial.astype(int), joint.astype(int)
    expected = bool(np.isfinite(declared))
    return WindowVariances(value, freedom, *places, away, fast, trials, joints, expected)


def _measure_tail(residual: Array, start: NDArray) -> Array:
    """Excess kurtosis (window,) of what each window leaves.

    It is at least 0.

    The variance of a window with a slip, or noise with heavy tails, is known less well.
    """
    sizes = np.diff(start)
    square, fourth = (np.add.reduceat(residual**k, start[:-1]) / sizes for k in (2, 4))
    return np.maximum(fourth / np.maximum(square, LEAST_SD**2) ** 2 - 3.0, 0.0)


def _complete(
    angles: xr.Dataset, frames: xr.Dataset, fit: NoiseFit, found: dict[str, tuple[float, float]]
) -> xr.Dataset:
    noise = complete_noise(fit.noise, angles, frames)
    least = (frames["rounding_sd"] / noise["noise_sd"]).values[:, None]
    factor = np.maximum(frames["noise_factor"].transpose(*LAYOUT).values, least)
    size, evidence = np.array(list(found.values()), float).reshape(-1, 2).T
    return frames.assign(
        {name: noise[name] for name in noise.data_vars}
        | {
            "noise_factor": (LAYOUT, factor),
            "noise_per_rad": ((), 0.0),
            "noise_per_rate": ((), 0.0),
            "component_size": ("component", size),
            "component_evidence": ("component", evidence),
        }
    ).assign_coords(component=np.array(list(found), str))
