"""Angles, loads and covariates of a campaign."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from softfinger.campaign import (
    Campaign,
    read_angle_table,
    read_load,
    read_marker_table,
)
from softfinger.campaign.load_log import refuse_mixed_loads
from softfinger.campaign.trials import Trial
from softfinger.faults import CampaignFault, TrialFault
from softfinger.measurement.flags import JUMP, MISSING, STALE
from softfinger.tracking.angles import compute_joint_angles
from softfinger.tracking.dots import measure_motion
from softfinger.tracking.outliers import find_jumps_array, find_stale_array
from softfinger.tracking.plausibility import flag_markers
from softfinger.tracking.quality import LIMITS, compute_quality, list_poor
from softfinger.tracking.sense import refuse_wrong_sign
from softfinger.tracking.specimen import refuse_relaxation, scale_motion


def assemble_angles(
    campaign: Campaign,
    markers: Sequence[xr.Dataset],
    limits: Mapping[str, float] = LIMITS,
    *,
    covariance: bool = True,
) -> xr.Dataset:
    """Gather all trials into the one `angles` artifact.

    Parameters
    ----------
    campaign : Campaign
    markers : sequence of Dataset
        The `markers` artifacts of the filmed trials; empty where nothing was filmed.
    limits : mapping
        What tracking must reach for a trial to be used; see
        :data:`softfinger.tracking.quality.LIMITS`.
    covariance : bool
        Whether the result has the angles' claimed covariance, which is most of its memory.

    Returns
    -------
    Dataset
        The artifact `angles`; trials in the order of ``trials.csv``. A trial that cannot be used
        is in ``set_aside_reason``. The motion of a specimen is an angle there, see
        :func:`softfinger.tracking.specimen.scale_motion`.

    Raises
    ------
    CampaignFault
        No trial can be used, loads are of different kinds, or most trials move against the load.
    """
    filmed = {
        str(name): batch.sel(trial=name) for batch in markers for name in batch["trial"].to_numpy()
    }
    reasons = dict(campaign.set_aside)
    used: list[tuple[Trial, xr.Dataset]] = []
    for trial in campaign.trials:
        try:
            used.append((trial, read_trial(campaign, trial, filmed, limits)))
        except TrialFault as fault:
            reasons[trial.name] = str(fault)
    if not used:
        listed = [f"trial {name}: {reason}" for name, reason in reasons.items()]
        raise CampaignFault(campaign.name, ["no trial can be used", *listed])
    refuse_mixed_loads(campaign.name, {t.name: one.attrs["load_kind"] for t, one in used})
    refuse_wrong_sign(campaign.name, [dataset for _, dataset in used])
    trials, recordings, attrs = [t for t, _ in used], [one for _, one in used], {}
    if campaign.specimen is not None:
        recordings, attrs = scale_motion(campaign.specimen, recordings)
    if not covariance:
        recordings = [one.drop_vars("joint_angle_covariance") for one in recordings]
    return _gather(campaign, list(zip(trials, recordings, strict=True)), reasons).assign_attrs(
        attrs
    )


def read_trial(
    campaign: Campaign,
    trial: Trial,
    filmed: Mapping[str, xr.Dataset],
    limits: Mapping[str, float],
) -> xr.Dataset:
    """Joint angles with flags of a trial, and load.

    Returns
    -------
    Dataset
        ``time (frame)``, ``joint_angle (joint, frame)``, ``joint_angle_covariance``,
        ``angle_flag``, ``load_time (knot)``, ``load_torque (knot)``; attribute ``load_kind``.

    Raises
    ------
    TrialFault
        The recording or its load log cannot be used, or it was tracked too poorly.
    """
    recording = _read_level(campaign, trial, filmed)
    timed = np.isfinite(recording["time"].to_numpy())
    recording = recording if timed.all() else recording.isel(frame=timed)
    time = recording["time"].to_numpy()
    if time.size < 2:
        raise TrialFault(f"{trial.recording.name}: has {time.size} frames; expected at least 2")
    interval = float(np.median(np.diff(time)))
    load_time, load_torque, kind = read_load(campaign, trial, interval, float(time[0]))
    jumps = find_load_jumps_array(load_time, load_torque)
    if "marker" in recording.dims:
        recording = flag_markers(recording, jumps)
        poor = list_poor(compute_quality(recording.expand_dims(trial=[trial.name])), limits)
        if poor:
            raise TrialFault(f"{trial.recording.name}: {poor[trial.name]}")
        measure = measure_motion if campaign.specimen else compute_joint_angles
        recording = measure(recording, campaign)
    if not np.isfinite(recording["joint_angle"]).any("frame").all():
        raise TrialFault(
            f"{trial.recording.name}: has no usable frame of at least one joint; check that every "
            "link shows two markers"
        )
    flagged = flag_frames(recording, jumps).assign(
        load_time=("knot", load_time), load_torque=("knot", load_torque)
    )
    if campaign.specimen is not None:
        refuse_relaxation(trial.recording.name, flagged)
    return flagged.assign_attrs(load_kind=kind)


def find_load_jumps_array(load_time: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Times at which a piecewise-linear load jumps.

    They are repeated knots with different values.

    >>> find_load_jumps_array(np.array([0.0, 1.0, 1.0, 4.0]), np.array([0.0, 0.0, 2.0, 2.0]))
    array([1.])
    """
    return np.unique(load_time[1:][(np.diff(load_time) == 0) & (np.diff(load) != 0)])


def flag_frames(angles: xr.Dataset, load_jumps: np.ndarray) -> xr.Dataset:
    """Flag repeats and jumps; values stay."""
    angle = angles["joint_angle"].transpose("joint", "frame").to_numpy()
    time = angles["time"].to_numpy()
    flag = angles["angle_flag"].transpose("joint", "frame").to_numpy().copy()
    flag[:, find_stale_array(angle)] |= STALE
    for joint, values in enumerate(angle):
        flag[joint, find_jumps_array(time, values, load_jumps)] |= JUMP
    return angles.assign(angle_flag=(("joint", "frame"), flag))


def _read_level(campaign: Campaign, trial: Trial, filmed: Mapping[str, xr.Dataset]) -> xr.Dataset:
    if trial.level == "angles":
        table = read_angle_table(campaign, trial)
        joints, frames = table["joint_angle"].shape
        unclaimed = np.broadcast_to(np.nan, (frames, joints, joints))
        flag = np.where(np.isfinite(table["joint_angle"]), 0, MISSING).astype(np.uint8)
        return table.assign(
            joint_angle_covariance=(("frame", "joint", "other_joint"), unclaimed),
            angle_flag=(("joint", "frame"), flag),
        )
    if trial.level == "markers":
        return read_marker_table(campaign, trial)
    if trial.name not in filmed:
        raise TrialFault(f"trial {trial.name}: its video has not been tracked; run `track` first")
    one = filmed[trial.name]
    reason = str(one["set_aside_reason"].item())
    if reason:
        raise TrialFault(reason)
    return one


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
            **describe_geometry(campaign),
        )
        .assign_coords(
            covariate=np.array(covariates, dtype=object),
            set_aside_trial=np.array(list(reasons), dtype=object),
        )
        .assign_attrs(
            campaign=campaign.name,
            source=campaign.source,
            camera=int(campaign.camera is not None),
            noise_sd_rad=campaign.noise_sd_rad if campaign.noise_sd_rad is not None else np.nan,
        )
    )


def _pad(one: xr.Dataset, frames: int, knots: int) -> xr.Dataset:
    """Lengthen a trial: NaN frames, last knot repeated."""
    more = {"frame": (0, frames - one.sizes["frame"])}
    # In one call xarray would pad the variables that are not named with 0.
    longer = one.drop_vars(["load_time", "load_torque", "angle_flag"]).pad(more)
    flag = one["angle_flag"].pad(more, constant_values=MISSING)
    load = one[["load_time", "load_torque"]].pad(knot=(0, knots - one.sizes["knot"]), mode="edge")
    return longer.assign(angle_flag=flag).merge(load)


def _compute_starts(trials: Sequence[Trial]) -> np.ndarray:
    moments = [trial.started_at for trial in trials]
    known = [moment for moment in moments if moment is not None]
    first = min(known, default=None)
    return np.array([(m - first).total_seconds() if m is not None else np.nan for m in moments])


def describe_geometry(campaign: Campaign) -> dict[str, tuple[tuple[str, ...], np.ndarray]]:
    """The geometry as variables, NaN if undeclared."""
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
