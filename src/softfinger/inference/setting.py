"""What is known before an effect is fitted."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.decisions import DECISIONS
from softfinger.measurement.open_gaps import find_open_gaps_array
from softfinger.measurement.step_time import find_step_gaps_array
from softfinger.measurement.trials import Trials
from softfinger.mechanics.effects.effect import Setting
from softfinger.mechanics.geometry import FingerGeometry
from softfinger.mechanics.load import evaluate_load_array
from softfinger.mechanics.three_element import compute_elastic_basis_array


def build_setting(angles: xr.Dataset, trials: Trials, own: NDArray[np.float64]) -> Setting:
    """Describe a campaign at base parameters (trial, 4·joint)."""
    chosen = angles.sel(trial=trials.name)
    kinds = set(chosen["load_kind"].values.tolist())
    largest = np.abs(trials.load_torque).max(axis=1)
    torque = float(np.median(largest[largest > 0])) if (largest > 0).any() else 1.0
    own = own.reshape(len(trials.name), trials.joints, 4)
    stop = np.array([node[:b].max() for node, b in zip(trials.node, trials.bins, strict=True)])
    begin = trials.node[:, 0, 0]
    started = chosen["started_at"].values.astype(float)
    rest = np.full(len(started), np.inf)
    rest[1:] = np.diff(started) - (stop - begin)[:-1]
    memory = np.zeros(own.shape[:2])
    memory[1:] = _elastic_end(trials, own, stop)[:-1]
    geometry, masses = _find_declared(chosen)
    return Setting(
        trials=len(trials.name),
        joints=trials.joints,
        interval=trials.interval,
        duration=float((stop - begin).max()),
        torque=torque,
        reversals=bool(_falls(trials.load_torque, torque, 1 - DECISIONS.fallen)),
        levels=_has_levels(trials.load_torque, torque),
        rests=bool(_falls(trials.load_torque, torque, DECISIONS.resting)),
        load_known="assumed" not in kinds,
        tension=kinds == {"tension_n"},
        stiffness=np.exp(np.median(own[:, :, 0], axis=0)),
        reach=np.array([_largest(trials, j) for j in range(trials.joints)]),
        number=_number(angles, trials),
        memory=memory,
        largest_torque=largest,
        rest_time=np.maximum(rest, 0.0),
        covariates=_covariates(chosen),
        geometry=geometry,
        masses=masses,
        step_gap=find_step_gap(trials),
        camera=bool(angles.attrs.get("camera", 0)),
        drift=own[:, :, :3],
        specimen="motion_unit" in angles.attrs,
        own_time=np.exp(np.median(own[:, :, 1] - own[:, :, 0], axis=0)),
        first_seen=find_first_seen(chosen["time"].transpose("trial", "frame").values, trials),
    )


def _find_declared(chosen: xr.Dataset) -> tuple[bool, bool]:
    """Whether the wire's geometry is declared; whether the links' masses are as well."""
    geometry = bool(np.isfinite(chosen["joint_length"]) and np.isfinite(chosen["wire_offset"]))
    masses = all(np.isfinite(chosen[f"link_{k}"]).all() for k in ("length", "mass", "centre"))
    return geometry, geometry and masses


def read_geometry(angles: xr.Dataset) -> FingerGeometry | None:
    """Read the finger's geometry; None if not declared."""
    names = ("link_length", "link_mass", "link_centre", "link_inertia")
    values = [angles[name].values.astype(float) for name in names]
    scalars = [float(angles[name]) for name in ("joint_length", "wire_offset")]
    if not all(np.isfinite(value).all() for value in [*values, *scalars]):
        return None
    return FingerGeometry(*values, *scalars)


def _falls(load: NDArray, torque: float, share: float) -> bool:
    """Whether some trial's load falls below a share."""
    size = np.abs(load)
    reached = np.maximum.accumulate(size, axis=1)
    return bool(np.any((size < share * reached) & (reached > DECISIONS.resting * torque)))


def _has_levels(load: NDArray, torque: float) -> bool:
    """Whether a trial's load rests or turns between 0 and its largest."""
    size = np.abs(load)
    largest = size.max(axis=1, keepdims=True)
    between = (size > DECISIONS.resting * torque) & (size < (1 - DECISIONS.fallen) * largest)
    return bool(between.any()) or _falls(load, torque, 1 - DECISIONS.fallen)


def find_step_gap(trials: Trials) -> float:
    """Widest gap [s] in a step, or 0."""
    load = trials.load_time, trials.load_torque
    gaps = [find_step_gaps_array(*load, trials.interval).max(initial=0.0)]
    for time, torque in zip(*load, strict=True):
        gaps += np.diff(time)[find_open_gaps_array(time, torque, trials.interval)].tolist()
    return float(max(gaps))


def find_first_seen(time: NDArray, trials: Trials) -> float:
    """Median time [s] from a trial's first load to the second frame after it; 0 where none is."""
    found = []
    for frames, knots, load in zip(time, trials.load_time, trials.load_torque, strict=True):
        loaded = np.flatnonzero(load)
        after = np.sort(frames[frames > knots[loaded[0]]]) if loaded.size else loaded
        found += [float(after[1] - knots[loaded[0]])] if after.size > 1 else []
    return float(np.median(found)) if found else 0.0


def _elastic_end(trials: Trials, own: NDArray, stop: NDArray) -> NDArray:
    """Elastic angle (trial, joint) at the recording's end."""
    end = np.zeros(own.shape[:2])
    for i in range(len(own)):
        rate = np.exp(own[i, :, 0] - own[i, :, 1])
        load = trials.load_time[i], trials.load_torque[i]
        end[i] = compute_elastic_basis_array(rate, stop[i : i + 1], *load)[0][:, 0]
    return end / np.exp(own[:, :, 0])


def _largest(trials: Trials, joint: int) -> float:
    rows = [a[:b, joint] for a, b, p in
            zip(trials.angle, trials.bins, trials.present[:, joint], strict=True) if p]  # fmt: skip
    return float(np.abs(np.concatenate(rows)).max()) if rows else 1.0


def _number(angles: xr.Dataset, trials: Trials) -> NDArray:
    """Trials recorded before each, in order of start."""
    place = {str(name): i for i, name in enumerate(angles["trial"].values)}
    return np.array([place[name] for name in trials.name], float)


def _covariates(chosen: xr.Dataset) -> dict[str, NDArray]:
    if "covariate" not in chosen.dims:
        return {}
    values = chosen["covariate_value"].transpose("trial", "covariate").values
    names = [str(name) for name in chosen["covariate"].values]
    return {n: values[:, k] for k, n in enumerate(names) if np.isfinite(values[:, k]).all()}


def load_at(trials: Trials, trial: int) -> NDArray[np.float64]:
    """One trial's load (bin,) [N m] at mean times."""
    time = trials.node[trial, : trials.bins[trial]].mean(axis=1)
    return evaluate_load_array(time, trials.load_time[trial], trials.load_torque[trial])
