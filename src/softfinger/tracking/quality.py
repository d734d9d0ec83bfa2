"""How well trials were tracked; when too little."""

from collections.abc import Mapping
from itertools import combinations

import numpy as np
import xarray as xr

from softfinger.measurement.flags import JUMP, STALE

#: Limits beyond which a trial is set aside, where the configuration names no others.
LIMITS: Mapping[str, float] = {
    "smallest_share_seen": 0.5,
    "largest_rigid_residual_px": 2.0,
    "largest_sd_px": 1.0,
}

_CHECKS = (
    ("share_seen", "smallest_share_seen", "is seen in only {:.3g} of the frames"),
    ("rigid_residual", "largest_rigid_residual_px", "wanders on its link by {:.3g} px rms"),
    ("sd_median", "largest_sd_px", "is placed with a standard deviation of {:.3g} px"),
)


def compute_quality(markers: xr.Dataset) -> xr.Dataset:
    """Compute how well each trial was tracked.

    Returns
    -------
    Dataset
        ``share_seen (trial, marker)``, ``share_suspect (trial, marker)``, ``share_stale (trial)``,
        ``sd_median (trial, marker) [px]``: the claimed standard deviation;
        ``rigid_residual (trial, marker) [px]``: the rms deviation of a marker's distances on its
        link from their median, over √2 a marker's share of it; NaN where nothing is seen.
    """
    parts = [_compute_one(markers.isel(trial=k)) for k in range(markers.sizes["trial"])]
    return xr.concat(parts, dim=markers["trial"])


def _compute_one(one: xr.Dataset) -> xr.Dataset:
    used = np.isfinite(one["time"].to_numpy())
    position = one["marker_position"].transpose("frame", "marker", "axis").to_numpy()[used]
    sd = one["marker_position_sd"].transpose("frame", "marker").to_numpy()[used]
    flag = one["marker_flag"].transpose("frame", "marker").to_numpy()[used]
    seen = np.isfinite(position[..., 0])
    frames = max(len(position), 1)
    median = [np.median(s[ok]) if ok.any() else np.nan for s, ok in zip(sd.T, seen.T, strict=True)]
    return xr.Dataset(
        {
            "share_seen": ("marker", seen.sum(axis=0) / frames),
            "share_suspect": ("marker", ((flag & JUMP) > 0).sum(axis=0) / frames),
            "share_stale": ((), ((flag & STALE) > 0).any(axis=1).sum() / frames),
            "sd_median": ("marker", np.array(median)),
            "rigid_residual": ("marker", _measure_rigidity(position, one["marker"].to_numpy())),
        },
        coords={"marker": one["marker"].to_numpy()},
    )


def _measure_rigidity(position: np.ndarray, names: np.ndarray) -> np.ndarray:
    links = [str(name).rsplit("_", 1)[0] for name in names]
    worst = np.full(len(links), np.nan)
    for a, b in combinations(range(len(links)), 2):
        gap = np.hypot(*(position[:, a] - position[:, b]).T)
        gap = gap[np.isfinite(gap)]
        if links[a] == links[b] and gap.size:
            residual = np.sqrt(np.mean((gap - np.median(gap)) ** 2) / 2.0)
            worst[[a, b]] = np.fmax(worst[[a, b]], residual)
    return worst


def list_poor(quality: xr.Dataset, limits: Mapping[str, float]) -> dict[str, str]:
    """Trials tracked too poorly: name → reason.

    Parameters
    ----------
    quality : Dataset
        From :func:`compute_quality`.
    limits : mapping
        Keys of :data:`LIMITS`.
    """
    reasons: dict[str, str] = {}
    for trial in quality["trial"].to_numpy():
        for variable, key, said in _CHECKS:
            values = quality[variable].sel(trial=trial).to_numpy()
            least = key.startswith("smallest")
            worst = int(np.nanargmin(values) if least else np.nanargmax(np.nan_to_num(values)))
            beyond = values[worst] < limits[key] if least else values[worst] > limits[key]
            if beyond:
                reasons[str(trial)] = (
                    f"marker {quality['marker'].to_numpy()[worst]} {said.format(values[worst])}; "
                    f"tracking.{key} requires at {'least' if least else 'most'} {limits[key]:g}"
                )
                break
    return reasons
