"""Marker positions → relative joint angles, with their covariance."""

import numpy as np
import xarray as xr
from scipy.ndimage import median_filter

from softfinger.campaign import Campaign
from softfinger.measurement.flags import JUMP, MISSING, STALE
from softfinger.tracking.camera import undistort_array

_MOVING_BASE = 1.5  # scatter of the base's direction, in its frame-to-frame scatter
# ASSUME: a marker that does not move keeps an error of a tenth of its standard deviation, that of
# its place between pixels, which no average takes away.
_STANDING_ERROR = 0.1
_UNWRAP_WINDOW = 11  # frames


def compute_joint_angles(markers: xr.Dataset, campaign: Campaign) -> xr.Dataset:
    r"""Relative joint angles from the rigid links' directions.

    A link's direction is that of the line :math:`p_k = a + s_k (\cos φ, -\sin φ)` fitted to its
    seen markers with weights 1/sd²; :math:`s_k` are the markers' own distances along the link.
    Then :math:`q_i = ±(φ_i - φ_{i-1})`, + where the finger bends counter-clockwise, with φ_0 the
    base's. The base does not move, so its direction is averaged over frames, unless it is seen to
    move. With :math:`v_i` the variances of the directions,

    .. math:: C_{ii} = v_i + v_{i-1}, \qquad C_{i,i+1} = -v_i .

    Parameters
    ----------
    markers : Dataset
        ``marker_position (trial, frame, marker, axis) [px]``, ``marker_position_sd``, ``time`` and
        perhaps ``marker_flag``. The dim ``trial`` may be absent.
    campaign : Campaign
        Number of joints, the direction of bending, the lens.

    Returns
    -------
    Dataset
        ``time``, ``joint_angle (…, joint, frame) [rad]``, NaN where a link of the joint shows
        fewer than two markers; ``joint_angle_covariance (…, frame, joint, other_joint) [rad2]``,
        NaN where no standard deviation is claimed; ``angle_flag (…, joint, frame)``.
    """
    if "trial" in markers.dims:
        trials = range(markers.sizes["trial"])
        parts = [compute_joint_angles(markers.isel(trial=k), campaign) for k in trials]
        return xr.concat(parts, dim=markers["trial"])
    position = markers["marker_position"].transpose("frame", "marker", "axis").to_numpy()
    position = undistort_array(position, campaign.camera)
    sd = markers["marker_position_sd"].transpose("frame", "marker").to_numpy()
    links = [str(name).rsplit("_", 1)[0] for name in markers["marker"].to_numpy()]
    rows = [np.flatnonzero(np.array(links) == link) for link in dict.fromkeys(links)]
    directions = [compute_direction_array(position[:, row], sd[:, row]) for row in rows]
    angle = np.stack([d[0] for d in directions], axis=1)
    variance = np.stack([d[1] for d in directions], axis=1)
    angle[:, 0], variance[:, 0] = steady_base_array(angle[:, 0], variance[:, 0])
    relative = campaign.finger.bends_sign * np.diff(angle, axis=1)
    for joint in range(relative.shape[1]):
        relative[:, joint] = unwrap_array(relative[:, joint])
    flag = _build_flags(markers, rows, relative)
    joints = np.arange(1, len(rows))
    return xr.Dataset(
        {
            "time": ("frame", markers["time"].to_numpy()),
            "joint_angle": (("joint", "frame"), relative.T),
            "joint_angle_covariance": (
                ("frame", "joint", "other_joint"),
                build_covariance_array(variance),
            ),
            "angle_flag": (("joint", "frame"), flag.T),
        },
        coords={"joint": joints, "other_joint": joints},
    )


def compute_direction_array(position: np.ndarray, sd: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Direction of a link in the picture, with variance.

    It counts counter-clockwise from x to the right.

    Parameters
    ----------
    position : (frame, marker, 2) [px]
        y down; NaN = not seen.
    sd : (frame, marker) [px]
        Standard deviation of either coordinate; NaN = not claimed.

    Returns
    -------
    direction (frame,) [rad], variance (frame,) [rad2]
        NaN where fewer than two markers are seen; the variance also where no sd is claimed.

    Examples
    --------
    Two markers 10 px apart, one straight above the other, 0.1 px each:

    >>> d, v = compute_direction_array(np.array([[[5.0, 20.0], [5.0, 10.0]]]), np.full((1, 2), 0.1))
    >>> float(d[0] / np.pi), round(float(v[0]), 12)
    (0.5, 0.0002)
    """
    seen = np.isfinite(position[..., 0])
    claimed = np.isfinite(sd).any()
    weight = np.where(seen, 1.0 / np.where(seen & claimed, sd, 1.0) ** 2, 0.0)
    weight = np.nan_to_num(weight)
    known = np.where(seen[..., None], position, 0.0)
    offset = measure_offsets_array(position)
    total = np.maximum(weight.sum(axis=1), 1e-300)
    mean_offset = (weight * offset).sum(axis=1) / total
    lever = weight * (offset - mean_offset[:, None])
    vector = (lever[..., None] * known).sum(axis=1)
    enough = (weight > 0).sum(axis=1) >= 2
    information = (lever * (offset - mean_offset[:, None])).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        direction = np.where(enough, np.arctan2(-vector[:, 1], vector[:, 0]), np.nan)
        variance = np.where(enough & claimed, 1.0 / information, np.nan)
    return direction, variance


def measure_offsets_array(position: np.ndarray) -> np.ndarray:
    """Distances of a link's markers from its first [px].

    Each is the median over frames.

    >>> measure_offsets_array(np.array([[[0.0, 0.0], [3.0, 4.0]], [[1.0, 0.0], [1.0, 5.0]]]))
    array([0., 5.])
    """
    gap = np.hypot(*np.moveaxis(position - position[:, :1], -1, 0))
    seen = np.isfinite(gap)
    offset = np.zeros(gap.shape[1])
    for k in range(1, gap.shape[1]):
        if seen[:, k].any():
            offset[k] = np.median(gap[seen[:, k], k])
    return offset


def steady_base_array(angle: np.ndarray, variance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean direction of the base, with its variance.

    Parameters
    ----------
    angle, variance : (frame,) [rad], [rad2]
        As seen in each frame; NaN = not seen.

    Returns
    -------
    angle, variance : (frame,)
        The average and its variance in every frame.

    Notes
    -----
    The base is taken to move, and left as seen, where its directions scatter by more than 1.5
    times what neighbouring frames do.
    """
    seen = np.isfinite(angle)
    if seen.sum() < 3:
        return angle, variance
    reference = np.angle(np.mean(np.exp(1j * angle[seen])))
    deviation = np.angle(np.exp(1j * (angle[seen] - reference)))
    typical = np.median(np.abs(deviation - np.median(deviation)))
    step = np.median(np.abs(np.diff(deviation))) / np.sqrt(2.0)
    if typical > _MOVING_BASE * step and step > 0.0:
        return angle, variance
    near = np.abs(deviation - np.median(deviation)) <= 5.0 * 1.4826 * typical
    steady = np.full_like(angle, reference + deviation[near].mean())
    if not np.isfinite(variance[seen]).any():
        return steady, variance
    share = 1.0 / near.sum() + _STANDING_ERROR**2
    return steady, np.full_like(variance, share * np.nanmean(variance[seen]))


def build_covariance_array(variance: np.ndarray) -> np.ndarray:
    """Covariance of neighbouring differences of independent directions.

    Parameters
    ----------
    variance : (frame, link) [rad2]
        Base first.

    Returns
    -------
    (frame, joint, joint) [rad2]

    Examples
    --------
    >>> build_covariance_array(np.array([[1.0, 2.0, 3.0]]))[0]
    array([[ 3., -2.],
           [-2.,  5.]])
    """
    joints = variance.shape[1] - 1
    covariance = np.zeros((len(variance), joints, joints))
    for j in range(joints):
        covariance[:, j, j] = variance[:, j] + variance[:, j + 1]
        if j + 1 < joints:
            covariance[:, j, j + 1] = covariance[:, j + 1, j] = -variance[:, j + 1]
    return covariance


def unwrap_array(angle: np.ndarray) -> np.ndarray:
    """A continuous angle that starts within ±π.

    False samples and gaps do not shift what follows.

    >>> unwrap_array(np.array([3.0, np.nan, 3.2 - 2 * np.pi])).round(9)
    array([3. , nan, 3.2])
    """
    seen = np.isfinite(angle)
    if not seen.any():
        return angle
    turn = np.exp(1j * angle[seen])
    size = min(_UNWRAP_WINDOW, 2 * ((seen.sum() - 1) // 2) + 1)
    smooth = median_filter(turn.real, size, mode="nearest") + 1j * median_filter(
        turn.imag, size, mode="nearest"
    )
    reference = np.unwrap(np.angle(smooth))
    whole = angle.copy()
    whole[seen] = reference + np.angle(turn * np.exp(-1j * reference))
    return whole


def _build_flags(markers: xr.Dataset, rows: list[np.ndarray], relative: np.ndarray) -> np.ndarray:
    flag = np.where(np.isfinite(relative), 0, MISSING).astype(np.uint8)
    if "marker_flag" not in markers:
        return flag
    own = markers["marker_flag"].transpose("frame", "marker").to_numpy()
    for bit in (STALE, JUMP):
        on_link = np.stack([(own[:, row] & bit).any(axis=1) for row in rows], axis=1)
        either = on_link[:, 1:] | on_link[:, :-1]
        flag |= (either * bit).astype(np.uint8)
    return flag
