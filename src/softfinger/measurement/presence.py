"""Which components the noise and the frames of a campaign show."""

import numpy as np
import xarray as xr
from scipy.stats import t as student

from softfinger.measurement.decisions import DECISIONS
from softfinger.measurement.noise import NoiseFit
from softfinger.measurement.priors import PRIORS
from softfinger.measurement.reml import LEAST_SD, profile_windows
from softfinger.measurement.scales import Scales


def list_components(
    scales: Scales, fit: NoiseFit, frames: xr.Dataset
) -> dict[str, tuple[float, float]]:
    """Component → size and evidence [nats]."""
    found = {}
    if {"trial", "cell"} & set(scales.size):
        size = np.hypot(scales.size.get("trial", 0.0), scales.size.get("cell", 0.0))
        evidence = sum(scales.evidence.get(name, 0.0) for name in ("trial", "cell"))
        found["uneven_noise"] = float(size), evidence
    if "signal" in scales.size:
        found["signal_noise"] = scales.per_rad, scales.evidence["signal"]
    if "rate" in scales.size:
        found["rate_noise"] = scales.per_rate, scales.evidence["rate"]
    if "jitter" in scales.size:  # s seconds late, a joint of velocity v errs by s v
        late = scales.per_rate * float(np.nanmean(fit.noise["noise_sd"]))
        found["frame_jitter"] = late, scales.evidence["jitter"]
    found |= _add_jumps(_weigh_outliers(frames), frames) | _weigh_tails(fit)
    found |= _count_frames("repeated_frames", frames["repeated"].values.sum(), frames)
    found |= _count_frames("saturated_sensor", frames["saturated"].values.sum(), frames)
    found |= _count_frames("lost_frames", float(frames["lost"]), frames)
    return {name: pair for name, pair in found.items() if pair[1] >= DECISIONS.present_nats}


def _weigh_outliers(frames: xr.Dataset) -> dict[str, tuple[float, float]]:
    """Share of outliers, and evidence against wider noise."""
    distance = frames["outlier_distance"].values
    out, count = distance[distance > 0], frames["used"].values.sum()
    if not out.size:
        return {}
    share = out.size / (out.size + count)
    freedom = np.maximum(frames["present"].values.sum(axis=1), 1)
    freedom = np.broadcast_to(freedom[:, None], distance.shape)[distance > 0]
    wide = out.sum() / freedom.sum()
    evidence = 0.5 * np.sum(out * (1.0 - 1.0 / wide) - freedom * np.log(wide))
    evidence += out.size * np.log(share) + count * np.log1p(-share)
    return {"outliers": (float(share), float(evidence))}


def _add_jumps(
    found: dict[str, tuple[float, float]], frames: xr.Dataset
) -> dict[str, tuple[float, float]]:
    """Count jumps that were flagged before among the outliers."""
    jumps = _count_frames("outliers", float(frames["jumped"]), frames)
    parts = [some["outliers"] for some in (found, jumps) if some]
    share, evidence = np.sum(parts, axis=0) if parts else (0.0, 0.0)
    return {"outliers": (float(share), float(evidence))} if parts else {}


def _weigh_tails(fit: NoiseFit) -> dict[str, tuple[float, float]]:
    """Evidence for Student's t in quiet windows."""
    units = [np.empty(0)]
    for windows, memory in zip(fit.windows, fit.memories, strict=True):
        if windows.dof > 0 and np.isfinite(memory.autocorrelation):
            residual = np.empty(len(windows.angle))
            profile_windows(*memory, *windows[:4], residual)
            sizes = np.diff(windows.start)
            sd = np.sqrt(np.add.reduceat(residual**2, windows.start[:-1]) / sizes)
            units.append(residual / np.repeat(np.maximum(sd, LEAST_SD), sizes))
    unit = np.concatenate(units)
    unit = unit[np.abs(unit) < DECISIONS.gross_sd]
    if not unit.size:
        return {}
    normal = -0.5 * np.sum(unit**2 + np.log(2 * np.pi))
    gain = np.array(
        [student.logpdf(unit, f, scale=np.sqrt((f - 2.0) / f)).sum() for f in PRIORS.freedoms]
    )
    evidence = float(np.logaddexp.reduce(gain - normal) - np.log(len(gain)))
    return {"heavy_tails": (PRIORS.freedoms[gain.argmax()], evidence)}


def _count_frames(name: str, count: float, frames: xr.Dataset) -> dict[str, tuple[float, float]]:
    """Share of useless frames, and evidence against soundness."""
    used, usual = float(frames["used"].values.sum()), DECISIONS.usual_loss
    share = count / (count + used)
    if share <= usual:
        return {}
    evidence = count * np.log(share / usual) + used * (np.log1p(-share) - np.log1p(-usual))
    return {name: (share, float(evidence))}
