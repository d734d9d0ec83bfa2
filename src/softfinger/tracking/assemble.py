"""Joint angles, loads and covariates of a whole campaign, from whatever level each trial has."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from softfinger.campaign import (
    Campaign,
    read_angle_table,
    read_load,
    read_marker_table,
)
from softfinger.campaign.folder import Trial
from softfinger.faults import CampaignFault, TrialFault
from softfinger.tracking.angles import compute_joint_angles
from softfinger.tracking.flags import JUMP, MISSING, STALE
from softfinger.tracking.outliers import find_jumps_array, find_stale_array


def assemble_angles(campaign: Campaign, markers: Sequence[xr.Dataset]) -> xr.Dataset:
    """Gather joint angles and loads of all trials into the one `angles` artifact.

    Parameters
    ----------
    campaign : Campaign
    markers : sequence of Dataset
        The `markers` artifacts of the filmed trials; empty where nothing was filmed.

    Returns
    -------
    Dataset
        The artifact `angles`; trials in the order of ``trials.csv``. A trial that cannot be used
        stands in ``set_aside_reason``.

    Raises
    ------
    CampaignFault
        No trial can be used, or most trials move against the load.
    """
    filmed = {
        str(name): batch.sel(trial=name) for batch in markers for name in batch["trial"].to_numpy()
    }
    reasons = dict(campaign.set_aside)
    used: list[tuple[Trial, xr.Dataset]] = []
    for trial in campaign.trials:
        try:
            used.append((trial, read_trial(campaign, trial, filmed)))
        except TrialFault as fault:
            reasons[trial.name] = str(fault)
    if not used:
        listed = [f"trial {name}: {reason}" for name, reason in reasons.items()]
        raise CampaignFault(campaign.name, ["no trial can be used", *listed])
    _refuse_wrong_sign(campaign, [dataset for _, dataset in used])
    return _gather(campaign, used, reasons)


def read_trial(campaign: Campaign, trial: Trial, filmed: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """Read one trial's joint angles with flags, and its load.

    Returns
    -------
    Dataset
        ``time (frame)``, ``joint_angle (joint, frame)``, ``joint_angle_covariance``,
        ``angle_flag``, ``load_time (knot)``, ``load_torque (knot)``; attribute ``load_kind``.

    Raises
    ------
    TrialFault
        The recording or its load log cannot be used.
    """
    angles = _read_level(campaign, trial, filmed)
    angles = angles.isel(frame=np.isfinite(angles["time"].to_numpy()))
    time = angles["time"].to_numpy()
    if time.size < 2 or not np.isfinite(angles["joint_angle"]).any():
        raise TrialFault(f"{trial.recording.name}: holds no usable frame")
    interval = float(np.median(np.diff(time)))
    load_time, load_torque, kind = read_load(campaign, trial, interval, float(time[0]))
    flagged = flag_frames(angles, load_time, load_torque)
    return flagged.assign(
        load_time=("knot", load_time), load_torque=("knot", load_torque)
    ).assign_attrs(load_kind=kind)


def flag_frames(angles: xr.Dataset, load_time: np.ndarray, load_torque: np.ndarray) -> xr.Dataset:
    """Flag missing angles, repeated frames and a tracker's jumps; values stay as they are."""
    angle = angles["joint_angle"].transpose("joint", "frame").to_numpy()
    time = angles["time"].to_numpy()
    flag = angles["angle_flag"].transpose("joint", "frame").to_numpy().copy()
    stepped = load_time[1:][(np.diff(load_time) == 0) & (np.diff(load_torque) != 0)]
    flag[:, find_stale_array(angle)] |= STALE
    for joint, values in enumerate(angle):
        flag[joint, find_jumps_array(time, values, np.unique(stepped))] |= JUMP
    return angles.assign(angle_flag=(("joint", "frame"), flag))


def _read_level(campaign: Campaign, trial: Trial, filmed: Mapping[str, xr.Dataset]) -> xr.Dataset:
    if trial.level == "angles":
        table = read_angle_table(campaign, trial)
        joints, frames = table["joint_angle"].shape
        unclaimed = np.full((frames, joints, joints), np.nan)
        flag = np.where(np.isfinite(table["joint_angle"]), 0, MISSING).astype(np.uint8)
        return table.assign(
            joint_angle_covariance=(("frame", "joint", "other_joint"), unclaimed),
            angle_flag=(("joint", "frame"), flag),
        )
    if trial.level == "markers":
        return compute_joint_angles(read_marker_table(campaign, trial), campaign)
    if trial.name not in filmed:
        raise TrialFault(f"trial {trial.name}: its video has not been tracked; run `track` first")
    one = filmed[trial.name]
    reason = str(one["set_aside_reason"].item())
    if reason:
        raise TrialFault(reason)
    return compute_joint_angles(one, campaign)


def _refuse_wrong_sign(campaign: Campaign, trials: Sequence[xr.Dataset]) -> None:
    senses = np.array([find_sense(trial) for trial in trials])
    against = int((senses < 0).sum())
    if against > int((senses > 0).sum()):
        raise CampaignFault(
            campaign.name,
            [
                f"{against} of {len(trials)} trials move against the load; a positive load must "
                "bend the finger positively: set finger.bends in campaign.yaml (videos and "
                "markers), or turn the sign of the angles or of the load"
            ],
        )


def find_sense(trial: xr.Dataset) -> int:
    """Whether a trial moves with its load (+1), against it (−1), or too little to say (0).

    Compares the summed joint angles of the tenth of frames under the strongest load, late ones
    before early ones, with those of the first frames.
    """
    time = trial["time"].to_numpy()
    good = (trial["angle_flag"] & (MISSING | JUMP)) == 0
    total = trial["joint_angle"].where(good).sum("joint", skipna=False).to_numpy()
    seen = np.isfinite(total)
    load = np.interp(time, trial["load_time"], trial["load_torque"], left=0.0)
    if seen.sum() < 4 or not np.any(load[seen]):
        return 0
    time, total, load = time[seen], total[seen], load[seen]
    count = max(1, seen.sum() // 10)
    strongest = np.lexsort((time, np.abs(load)))[-count:]
    first = np.flatnonzero(load == load[0])[: max(1, min(count, 3))]
    moved = np.median(total[strongest]) - np.median(total[first])
    noise = 1.4826 * np.median(np.abs(np.diff(total))) / np.sqrt(2.0)
    if abs(moved) <= 5.0 * noise:
        return 0
    return int(
        np.sign(
            moved
            * np.median(load[strongest] - load[first[0]] * (load[first[0]] != load[strongest[-1]]))
        )
    )


def _gather(
    campaign: Campaign, used: Sequence[tuple[Trial, xr.Dataset]], reasons: Mapping[str, str]
) -> xr.Dataset:
    names = [trial.name for trial, _ in used]
    frames = max(one.sizes["frame"] for _, one in used)
    knots = max(one.sizes["knot"] for _, one in used)
    joints = np.arange(1, campaign.finger.joints + 1)
    covariates = list(used[0][0].covariates)
    gathered = xr.concat(
        [
            _pad(one, frames, knots).assign_coords(joint=joints, other_joint=joints)
            for _, one in used
        ],
        dim=xr.DataArray(np.array(names, dtype=object), dims="trial", name="trial"),
        combine_attrs="drop",
    )
    return (
        gathered.assign(
            load_kind=(
                "trial",
                np.array([one.attrs["load_kind"] for _, one in used], dtype=object),
            ),
            started_at=("trial", _compute_starts([trial for trial, _ in used])),
            covariate_value=(
                ("trial", "covariate"),
                np.array([[t.covariates[c] for c in covariates] for t, _ in used]).reshape(
                    len(used), len(covariates)
                ),
            ),
            set_aside_reason=("set_aside_trial", np.array(list(reasons.values()), dtype=object)),
            **describe_finger(campaign),
        )
        .assign_coords(
            covariate=np.array(covariates, dtype=object),
            set_aside_trial=np.array(list(reasons), dtype=object),
        )
        .assign_attrs(
            campaign=campaign.name,
            source=campaign.source,
            noise_sd_rad=campaign.noise_sd_rad if campaign.noise_sd_rad is not None else np.nan,
        )
    )


def _pad(one: xr.Dataset, frames: int, knots: int) -> xr.Dataset:
    """Lengthen a trial: no more frames, and the last knot of the load again."""
    more = frames - one.sizes["frame"]
    longer = one.drop_vars(["load_time", "load_torque"]).pad(
        frame=(0, more), constant_values={"angle_flag": MISSING}
    )
    load = one[["load_time", "load_torque"]].pad(knot=(0, knots - one.sizes["knot"]), mode="edge")
    return longer.merge(load)


def _compute_starts(trials: Sequence[Trial]) -> np.ndarray:
    moments = [trial.started_at for trial in trials]
    known = [moment for moment in moments if moment is not None]
    first = min(known, default=None)
    return np.array([(m - first).total_seconds() if m is not None else np.nan for m in moments])


def describe_finger(campaign: Campaign) -> dict[str, tuple[tuple[str, ...], np.ndarray]]:
    """Build the finger's geometry as variables of the artifact; NaN where it is not declared."""
    finger = campaign.finger
    length = _per_joint(finger.link_length_m, finger.joints)
    mass = _per_joint(finger.link_mass_kg, finger.joints)
    centre = _per_joint(finger.link_centre_m, finger.joints)
    inertia = _per_joint(finger.link_inertia_kgm2, finger.joints)
    # ASSUME: links without a declared centre and inertia are uniform rods.
    centre = np.where(np.isnan(centre), 0.5 * length, centre)
    inertia = np.where(np.isnan(inertia), mass * length**2 / 12.0, inertia)
    scalars = {"joint_length": finger.joint_length_m, "wire_offset": finger.wire_offset_m}
    return {
        "link_length": (("joint",), length),
        "link_mass": (("joint",), mass),
        "link_centre": (("joint",), centre),
        "link_inertia": (("joint",), inertia),
    } | {name: ((), np.array(np.nan if v is None else v)) for name, v in scalars.items()}


def _per_joint(values: Sequence[float] | None, joints: int) -> np.ndarray:
    return np.full(joints, np.nan) if values is None else np.array(values, float)
